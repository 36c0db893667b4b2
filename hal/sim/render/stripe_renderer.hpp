// SPDX-License-Identifier: MIT
#pragma once
/// \file Pictures of the laser stripe on a scene, ray-traced, with the exact place of what they show.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "hal/sim/render/made_head.hpp"
#include "hal/sim/render/scene.hpp"
#include "hal/sim/render/speckle_field.hpp"

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
  /// What the camera moves and turns by from the exposure's begin to its end, in its own frame.
  Vec3 moved_cam_mm{Vec3::Zero()}, turned_cam_rad{Vec3::Zero()};
  double ambient_ratio{1};        ///< of CameraFaults::ambient_grey: lamps flicker
  bool speckle_stays_put{false};  ///< on the surface: at rest the same picture after picture; else drawn anew
};

/// Shoots a fan of laser rays into the scene (what they do not reach first is dark), keeps what the camera
/// sees, and draws the seen curve column by column as the Gaussian that a sheet of that thickness gives on
/// the facet there. Motion during the exposure widens the stripe by the variance of its way down the column,
/// where the surface draws nearer or farther meanwhile; its ends stay sharp.
///
/// The light has the grain of the head's optics (SpeckleField).  It goes with the surface as the picture of
/// the working point does, is another one when the head has turned by what the lens takes in, and the
/// exposure's motion averages it.  Polarisation, roughness and scattering of the surface lower its contrast.
/// Not simulated: light scattered twice.
///
/// Thread: one owner.  Memory: sized by the first shot of a region, a megabyte for each level of the room's
/// light.
class StripeRenderer {
 public:
  /// Borrows the scene.
  StripeRenderer(const Scene& scene, const MadeHead& head);

  /// Fills `pixels` (region width * height).  `truth` may be null.
  void render(const Shot& shot, std::span<std::uint8_t> pixels, std::vector<TrueStripePoint>* truth);

 private:
  /// What a surface makes of the two polarisations' grains.
  struct Grains {
    float along_ratio{0.5F};  ///< of the light: in the laser's own polarisation
    float contrast_ratio{1};  ///< what depth and the spectrum's width leave
  };
  struct CurvePoint {
    Vec3 point_scene{Vec3::Zero()};
    Vec2 pixel_px{Vec2::Zero()};  ///< in the region
    double sigma_px{0};
    double amplitude_grey{0};
    Vec2 smeared_px{Vec2::Zero()};  ///< way of this ray's spot during the exposure
    Grains grains{};
    bool seen{false};
  };

  void prepare(const Shot& shot);
  [[nodiscard]] CurvePoint look_at(const Vec3& point_scene, const RayHit& hit, const Vec3& light_direction,
                                   double light_ratio, const Shot& shot) const;
  [[nodiscard]] Grains grains_of(const SurfaceLook& look) const;
  void lay_speckle(const Shot& shot);
  void trace(const Shot& shot);
  void draw_curve(const std::vector<CurvePoint>& curve, bool mirrored, const Shot& shot,
                  std::vector<TrueStripePoint>* truth);
  [[nodiscard]] Vec2 smeared_px(const Vec3& point_cam, const Vec3& normal_cam, const Vec3& light_cam,
                                const Shot& shot) const;
  void draw(const TrueStripePoint& stripe, const Grains& grains, const Shot& shot);
  /// The speckle of the rows from `pixel` on, into grey_ratio_.
  void read_speckle(const SpeckleField::Pixel& pixel, bool mirrored, const Grains& grains);
  void develop(const Shot& shot, std::span<std::uint8_t> pixels);

  const Scene& scene_;
  MadeHead head_;
  std::vector<Vec3> fan_cam_;      ///< unit directions of the laser rays
  std::vector<CurvePoint> curve_;  ///< along the fan
  std::vector<CurvePoint> mirror_curve_;
  std::vector<float> gaussians_;  ///< table of normal deviates
  /// Pictures without stripe, twice as tall as the region, by grey level.
  std::map<double, std::vector<std::uint8_t>> backgrounds_;
  const std::vector<std::uint8_t>* background_{nullptr};  ///< the one in use
  double background_grey_{-1};
  std::vector<float> light_;                         ///< laser light by pixel, zero between pictures
  std::shared_ptr<const SpeckleField> speckle_;      ///< none: the light is not coherent
  std::vector<SpeckleField::Place> speckle_places_;  ///< that follow each other within the exposure
  std::vector<SpeckleField::Grain> column_grains_;
  std::vector<float> grey_ratio_;
  struct Range {
    int column, low, high;
  };
  std::vector<Range> touched_;
};

}  // namespace biteline::sim
