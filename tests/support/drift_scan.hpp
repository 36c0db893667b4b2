// SPDX-License-Identifier: MIT
#pragma once
/// \file A shoe scanned with a check lap by a head that has drifted: exact rays, no pictures.

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
    bool real{true};  ///< elastic joints, following error, latency
    sim::CheckLap check{.length_mm = 50};
  };
  [[nodiscard]] static Result<DriftCell> make(const Settings& settings);

  struct Draw {
    drift::Vector drifted{drift::Vector::Zero()};  ///< of the head, since its calibration
    std::uint64_t seed{1};
    double noise_px{0.1};
    double pose_mm{0.010}, pose_rad{5.2e-5};  ///< as a recorded session's
    bool only_lap{true};                      ///< what is seen once is left out
  };
  [[nodiscard]] DriftScan scan(const Draw& draw) const;
  [[nodiscard]] const geometry::SensorModel& calibrated() const { return scene_->head.model; }
  [[nodiscard]] double duration_s() const { return way_.duration_s; }

 private:
  std::shared_ptr<const sim::MadeScene> scene_;
  sim::HeadWay way_;
};

}  // namespace biteline::test
