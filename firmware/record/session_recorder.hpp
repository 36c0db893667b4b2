// SPDX-License-Identifier: MIT
#pragma once
/// \file One live scan into a session folder, off the hot path.

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/image/grey_image.hpp"
#include "common/session/recording_facts.hpp"
#include "common/wire/messages.hpp"
#include "firmware/pipeline/record_tap.hpp"
#include "firmware/record/append_file.hpp"
#include "firmware/record/room.hpp"
#include "firmware/runtime/realtime.hpp"

namespace biteline::record {

/// `wanted` if there is nothing of that name, else the first of `wanted`-2, -3, ... that is free.
[[nodiscard]] std::filesystem::path free_session_folder(const std::filesystem::path& wanted);

/// Writes what a replay needs to find the same bits: pictures, poses, settings (docs/recording.md), and the
/// scan's own messages (scan.btln).  Poses and messages go first; pictures for which the disk is too slow are
/// left out and counted.  A full disk ends the recording, not the scan; what was written stays readable.
///
/// Thread: keep_message from the stream thread; request_finish() from any, once nothing more comes; a thread
/// of its own
/// (`bl-record`) writes.
class SessionRecorder {
 public:
  struct Config {
    std::filesystem::path folder;  ///< made here; nothing of that name may exist
    geometry::SensorModel model;
    session::RecordingFacts facts;   ///< the settings in it
    std::string settings{};          ///< the set in use, as a settings file; empty: none is kept
    std::filesystem::path series{};  ///< whose oldest recordings make room (make_room())
    std::uint64_t keep_bytes{0};     ///< of all of them; 0: all stay
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
  /// No scan came of it: the folder goes.
  void discard();
  /// All is on the disk that will be.
  [[nodiscard]] bool done() const { return done_.load(); }

 private:
  /// Messages that wait for the disk; 20 s of full profiles at 100 Hz.
  static constexpr std::size_t k_most_waiting_bytes = 64U << 20U;

  explicit SessionRecorder(Config config);
  [[nodiscard]] Result<void> open_files();
  void run();
  /// False: nothing was there to be written.
  bool write_waiting();
  [[nodiscard]] Result<bool> write_poses();
  [[nodiscard]] Result<bool> write_messages();
  [[nodiscard]] Result<bool> write_picture();
  [[nodiscard]] Result<void> write_facts();
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
  std::optional<HeldFolder> held_;
  std::optional<AppendFile> frames_, frame_facts_, poses_, scan_;
  std::uint64_t pictures_left_out_{0}, poses_left_out_{0};
  image::GreyImage picture_;  ///< the one being written
  SensorClock::time_point last_picture_{SensorClock::time_point::min()};
  bool failed_{false};
};

}  // namespace biteline::record
