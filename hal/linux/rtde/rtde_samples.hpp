// SPDX-License-Identifier: MIT
#pragma once
/// \file From RTDE data packages to pose samples: units, TCP offset, status, sequence, and the controller's
/// clock on ours.

#include <array>
#include <cstdint>
#include <optional>

#include "common/rtde/client_session.hpp"
#include "hal/api/pose_source.hpp"
#include "hal/timing/clock_map.hpp"

namespace biteline::hal {

struct RtdeSampleCounts {
  std::uint64_t poses{0};
  std::uint64_t poses_lost{0};  ///< gaps in the controller's stamps, and samples nobody fetched
  std::uint64_t poses_rejected{0};
};

/// Thread: one owner.  Memory: fixed.
class RtdeSamples final : public rtde::ClientListener {
 public:
  struct Config {
    double rate_hz{500};  ///< of the recipe; a CB3 gives its own 125
    ClockMapCore::Config clock{};
  };
  explicit RtdeSamples(const Config& config) : config_{config}, clock_{config.clock} {}

  /// The recipe whose data packages are read here.
  [[nodiscard]] static rtde::ClientSession::OutputRecipe recipe(double rate_hz);

  /// A new connection: the sequence goes on; stamps go on too, with a gap, or begin anew with a controller
  /// that did.
  void begin_connection() { first_of_connection_ = true; }
  /// When the bytes about to be consumed arrived.
  void set_received(SensorClock::time_point received) { received_ = received; }

  [[nodiscard]] std::optional<RobotPose> take();
  [[nodiscard]] const RtdeSampleCounts& counts() const { return counts_; }
  [[nodiscard]] ClockMapHealth clock_health() const { return clock_.health(); }

  void on_data(std::size_t recipe, std::span<const rtde::Value> values) override;
  void on_text(const rtde::TextMessage&) override {}

 private:
  static constexpr std::size_t k_waiting = 64;  // 128 ms at 500 Hz between two calls of the owner
  static constexpr std::size_t k_steps_kept = 64;
  /// The recipe's two poses, stamp and words, without their header: no data package is shorter.
  static constexpr std::size_t k_package_bytes = 2 * 6 * 8 + 8 + 2 * 4;

  void put(const RobotPose& sample);
  void keep_step(Nanoseconds step);
  /// The controller's own period, the least of the last steps: it may be slower than what was wished.
  [[nodiscard]] Nanoseconds period() const;

 public:
  /// What may be read at once without a sample's being lost, one package cut off before included.
  static constexpr std::size_t k_burst_bytes = (k_waiting - 1) * k_package_bytes;

 private:
  Config config_;
  ClockMap<RobotClock> clock_;
  SensorClock::time_point received_;
  std::optional<RobotClock::time_point> last_stamp_;
  std::array<Nanoseconds, k_steps_kept> steps_{};  ///< 0: none yet
  std::size_t next_step_{0};
  bool first_of_connection_{true};
  std::uint64_t sequence_{0};
  std::array<RobotPose, k_waiting> waiting_{};
  std::size_t first_{0};
  std::size_t count_{0};
  RtdeSampleCounts counts_;
};

}  // namespace biteline::hal
