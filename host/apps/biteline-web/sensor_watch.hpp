// SPDX-License-Identifier: MIT
#pragma once
/// \file What the live view shows: the sensor's pictures and profiles, the cloud as it grows, the line found.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/wire/endpoint.hpp"
#include "common/wire/keys.hpp"
#include "common/wire/messages.hpp"
#include "host/apps/biteline-web/live_messages.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::web {

struct SensorWatchConfig {
  std::optional<wire::Endpoint> sensor;  ///< none: the one that the service names
  std::optional<wire::HostKeys> keys;    ///< compulsory beyond loopback
  double picture_rate_hz{10};
  double profile_rate_hz{20};
  int picture_width_max_px{800};
};

/// Where it goes.  Called on the watch's thread; must not block.
struct LiveSink {
  std::function<void(LiveKind, LiveBytes)> publish;
  std::function<void()> forget_scan;
  std::function<int()> watchers;  ///< with none the sensor is asked for no pictures and profiles
};

/// Turns profiles into pieces of the cloud.  Thread: one owner.
class CloudPieces {
 public:
  static constexpr int k_profiles_a_piece = 5;
  static constexpr std::size_t k_points_a_profile = 400;  ///< evenly thinned: a screen shows no more

  /// Base and flange are the robot's, the head's own mounting is the hello's.
  void begin(const geometry::SensorModel& model) { T_flange_cam_ = model.T_flange_cam; }
  /// A piece when enough has come together; profiles and points that are no surface stay out.
  [[nodiscard]] LiveBytes add(std::uint64_t scan, const profile::Profile& profile);

 private:
  std::optional<SE3> T_flange_cam_;
  std::vector<LivePoint> points_;
  std::uint64_t scan_{0};
  int profiles_{0};
};

/// An observer: holds up no scan, acknowledges nothing, keeps no laser alive.  Connects again for ever.
/// Thread: "bl-watch" is its own; hear() may be called from any.
class SensorWatch {
 public:
  SensorWatch(const SensorWatchConfig& config, LiveSink sink);
  ~SensorWatch();
  SensorWatch(const SensorWatch&) = delete;
  SensorWatch& operator=(const SensorWatch&) = delete;

  /// The service's `hello` names sensor and results; of a `scan` that has a line the line is shown.
  void hear(const control::Event& event);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace biteline::web
