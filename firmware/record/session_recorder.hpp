// SPDX-License-Identifier: MIT
#pragma once
/// \file One live scan into a session folder or an MCAP file, off the hot path.

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/session/recording_facts.hpp"
#include "common/wire/messages.hpp"
#include "firmware/pipeline/record_tap.hpp"
#include "firmware/record/picture_pace.hpp"
#include "firmware/record/record_store.hpp"
#include "firmware/record/room.hpp"
#include "firmware/runtime/realtime.hpp"

namespace biteline::record {

/// Writes what a replay needs to find the same bits: pictures, poses, settings (docs/recording.md), and the
/// scan's own messages.  Poses and messages go first; pictures for which the disk is too slow are
/// left out and counted.  A full disk ends the recording, not the scan; what was written stays readable.
///
/// Thread: keep_message from the stream thread; request_finish() from any, once nothing more comes; a thread
/// of its own
/// (`bl-record`) writes.
class SessionRecorder {
 public:
  struct Config {
    /// Made here; nothing of that name may exist.  NAME.mcap: one file, else a session folder.
    std::filesystem::path path;
    geometry::SensorModel model;
    session::RecordingFacts facts;   ///< the settings in it
    std::string settings{};          ///< the set in use, as a settings file; empty: none is kept
    std::filesystem::path series{};  ///< whose oldest recordings make room (make_room())
    std::uint64_t keep_bytes{0};     ///< of all of them; 0: all stay
    /// `path` waits (waiting_name()) until somebody asks for it; the one before goes.
    bool waits{false};
    /// Of the scan before, whose end is on its way: it settles first, or the newer one would go for it.
    std::weak_ptr<const SessionRecorder> before{};
    runtime::RealtimeDemand realtime{runtime::RealtimeDemand::Required};
  };
  [[nodiscard]] static Result<std::unique_ptr<SessionRecorder>> begin(Config config);
  /// Writes what is still waiting; not complete unless request_finish() was called.
  ~SessionRecorder();
  SessionRecorder(const SessionRecorder&) = delete;
  SessionRecorder& operator=(const SessionRecorder&) = delete;

  /// Where frames and poses go.
  [[nodiscard]] const std::shared_ptr<pipeline::RecordTap>& tap() const { return tap_; }
  /// Never waits for the disk.
  void keep_message(std::span<const std::uint8_t> message);
  /// The scan has ended and everything of it was handed over.  Does not wait for the disk; see done().
  /// `unrepeatable`: profiles that the pictures' replay makes otherwise.
  void request_finish(std::uint64_t unrepeatable);
  /// No scan came of it: the recording goes.
  void discard();
  /// All is on the disk that will be.
  [[nodiscard]] bool done() const { return done_.load(); }
  /// What ended the recording before the scan; empty: nothing did.  Pre: done().
  [[nodiscard]] const std::string& fault() const { return config_.facts.fault; }

 private:
  /// Messages that wait for the disk; 20 s of full profiles at 100 Hz.
  static constexpr std::size_t k_most_waiting_bytes = 64U << 20U;

  explicit SessionRecorder(Config config);
  [[nodiscard]] Result<void> open_store();
  void run();
  /// False: nothing was there to be written.
  bool write_waiting();
  [[nodiscard]] Result<bool> write_poses();
  [[nodiscard]] Result<bool> write_messages();
  [[nodiscard]] Result<bool> write_picture();
  void settle();
  /// Pre: it is held, and nothing more is written.
  void settle_wishes();
  void end_for(const Error& fault);
  void drop_waiting();
  void end(bool whole);
  void wait();

  Config config_;
  std::shared_ptr<pipeline::RecordTap> tap_;
  std::thread thread_;
  std::uint64_t unrepeatable_{0};  ///< set before finishing_
  std::atomic<bool> finishing_{false}, whole_{false}, done_{false};

  std::vector<wire::Bytes> handing_over_;  ///< stream thread's own, until the lock is free
  std::mutex mutex_;                       ///< of the two below
  std::vector<wire::Bytes> waiting_;
  std::size_t waiting_bytes_{0};
  std::atomic<std::uint64_t> messages_left_out_{0};

  // The writing thread's own.
  std::unique_ptr<RecordStore> store_;
  std::vector<pipeline::RecordedPose> poses_;  ///< the ones being written
  std::uint64_t pictures_left_out_{0}, poses_left_out_{0};
  PicturePace pace_;
  SensorClock::time_point last_picture_{SensorClock::time_point::min()};
  std::chrono::steady_clock::time_point settle_at_{};
  bool failed_{false};
};

}  // namespace biteline::record
