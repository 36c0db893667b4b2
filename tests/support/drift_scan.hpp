// SPDX-License-Identifier: MIT
#pragma once
/// \file A shoe on its table, scanned with a check lap by a head that has drifted: exact rays, no pictures.

#include <cstdint>
#include <memory>
#include <vector>

#include "hal/sim/live/arm_way.hpp"
#include "hal/sim/record/made_scene.hpp"
#include "host/calibration/drift/evidence.hpp"

namespace biteline::test {

/// What a scan came to.
struct DriftScan {
  std::vector<Eigen::Vector3f> points_base;
  std::vector<std::uint32_t> profile;
  std::vector<drift::PosedProfile> poses;
  [[nodiscard]] drift::ScanView view() const { return {points_base, profile, poses}; }
};

/// One shoe before one head on one arm.  Immutable.
class DriftCell {
 public:
  struct Settings {
    sim::ShoeClass shoe_class{sim::ShoeClass::Deep};
    std::uint64_t shoe_seed{1}, head_seed{21};
    double size{42};
    double speed_mm_s{250};
    bool takt{false};  ///< begins in the waist and goes clockwise
    bool real{true};   ///< elastic joints, following error, latency
    bool table{true};  ///< under the shoe; else it hangs in the dark
    sim::CheckLap check{.length_mm = 50};
    int fan_rays{260};  ///< some 0.6 mm apart on the wall
  };
  [[nodiscard]] static Result<DriftCell> make(const Settings& settings);

  /// What the camera sees of the stripe, without noise.
  struct Look {
    std::uint32_t profile;
    Vec2 pixel;
  };
  struct Setting {
    drift::Vector drifted{drift::Vector::Zero()};  ///< of the head and the table, since the calibration
    SE3 T_shoe_put{SE3::Identity()};               ///< where the shoe stands, in the frame of where it should
    double shining_ratio{0};  ///< of the line: beside that part the stripe is seen anywhere near
  };
  [[nodiscard]] std::vector<Look> looks(const Setting& setting) const;

  struct Draw {
    double late_s{0};  ///< of the pose clock
    std::uint64_t seed{1};
    double noise_px{0.1};
    double pose_mm{0.010}, pose_rad{5.2e-5};  ///< as a recorded session's
  };
  /// Places by the calibration that the head had.
  [[nodiscard]] DriftScan scan(const std::vector<Look>& looks, const Draw& draw) const;
  [[nodiscard]] const geometry::SensorModel& calibrated() const { return scene_->head.model; }
  /// From rest: until the last profile, and until rest.
  [[nodiscard]] double last_profile_s() const { return last_profile_s_; }
  [[nodiscard]] double rest_to_rest_s() const { return rest_to_rest_s_; }

 private:
  std::shared_ptr<const sim::MadeScene> scene_;
  sim::HeadWay way_;
  int fan_rays_{0};
  double last_profile_s_{0}, rest_to_rest_s_{0};
};

}  // namespace biteline::test
