// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor program as a camera for single pictures (`biteline-sensor --stills`).

#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/geometry/camera_state.hpp"
#include "common/geometry/se3.hpp"
#include "host/intake/child_process.hpp"

namespace biteline::capture {

/// Where the arm is, and how still; over the last 0.3 s.
struct ArmRest {
  int poses{0};  ///< 0: no pose came
  SE3 T_base_flange{SE3::Identity()};
  double moved_mm{0}, moved_deg{0};
  std::optional<double> exposure_us;  ///< of a picture; 0: the camera's driver has no exposure control
};

struct StillOrder {
  bool laser{false};  ///< the laser's guard decides
  double exposure_us{0};
};

/// Thread: one owner.
class StillCamera {
 public:
  /// Errc::ProcessDied with the sensor program's own words when it does not come up.
  [[nodiscard]] static Result<StillCamera> start(const std::filesystem::path& board, const std::string& rt);

  [[nodiscard]] Result<ArmRest> rest();
  /// What the camera does to its pictures, for as long as this lives.
  [[nodiscard]] Result<geometry::CameraState> state();
  /// The picture is written to `file`.  Errc::DeviceError with the sensor's words when there is none.
  [[nodiscard]] Result<ArmRest> take(const StillOrder& order, const std::filesystem::path& file);

 private:
  explicit StillCamera(intake::ChildProcess sensor) : sensor_{std::move(sensor)} {}
  [[nodiscard]] Result<ArmRest> ask(const std::string& order);

  intake::ChildProcess sensor_;
};

}  // namespace biteline::capture
