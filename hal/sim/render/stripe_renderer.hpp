// SPDX-License-Identifier: MIT
#pragma once
/// \file Pictures of the laser stripe on a scene, ray-traced, with the exact place of what they show.

#include <cstdint>
#include <span>
#include <vector>

#include "hal/sim/render/made_head.hpp"
#include "hal/sim/render/scene.hpp"

namespace biteline::sim {

/// The stripe's middle in one column, as drawn (before noise).
struct TrueStripePoint {
  int column_px{0};    ///< in the region
  double row_px{0};    ///< in the region, exact
  double sigma_px{0};  ///< of the drawn Gaussian
  double amplitude_grey{0};
  bool mirrored{
      false};  ///< light that a glossy place threw elsewhere: not where the sheet meets the surface first
};

/// What changes from picture to picture.
struct Shot {
  SE3 T_scene_cam{SE3::Identity()};
  geometry::Region region;
  double exposure_ratio{1};  ///< of the nominal exposure
  bool laser_on{true};
  std::uint64_t noise_seed{0};
};

/// Shoots a fan of laser rays into the scene (what they do not reach first is dark), keeps what the camera
/// sees, and draws the seen curve column by column as the Gaussian that a sheet of that thickness gives on
/// the facet there. Not simulated: blur by motion during the exposure (0.04 mm at 100 mm/s and 0.4 ms), light
/// scattered twice.
///
/// Thread: one owner.  Memory: sized by the first shot of a region.
class StripeRenderer {
 public:
  /// Borrows the scene.
  StripeRenderer(const Scene& scene, const MadeHead& head);

  /// Fills `pixels` (region width * height).  `truth` may be null.
  void render(const Shot& shot, std::span<std::uint8_t> pixels, std::vector<TrueStripePoint>* truth);

 private:
  struct CurvePoint {
    Vec3 point_scene{Vec3::Zero()};
    Vec2 pixel_px{Vec2::Zero()};  ///< in the region
    double sigma_px{0};
    double amplitude_grey{0};
    bool seen{false};
  };

  void prepare(const Shot& shot);
  [[nodiscard]] CurvePoint look_at(const Vec3& point_scene, const RayHit& hit, const Vec3& light_direction,
                                   double light_ratio, const Shot& shot) const;
  void trace(const Shot& shot);
  void draw_curve(const std::vector<CurvePoint>& curve, bool mirrored, const Shot& shot,
                  std::vector<TrueStripePoint>* truth);
  void draw(const TrueStripePoint& stripe, const Shot& shot);
  void develop(const Shot& shot, std::span<std::uint8_t> pixels);

  const Scene& scene_;
  MadeHead head_;
  std::vector<Vec3> fan_cam_;      ///< unit directions of the laser rays
  std::vector<CurvePoint> curve_;  ///< along the fan
  std::vector<CurvePoint> mirror_curve_;
  std::vector<float> gaussians_;          ///< table of normal deviates
  std::vector<std::uint8_t> background_;  ///< a picture without stripe, twice as tall as the region
  double background_grey_{-1};
  std::vector<float> light_;  ///< laser light by pixel, zero between pictures
  struct Range {
    int column, low, high;
  };
  std::vector<Range> touched_;
};

}  // namespace biteline::sim
