// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/scanned_cloud.hpp"

#include <cmath>
#include <numbers>

#include "common/optics/speckle.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

struct Viewer {
  double distance_mm;
  double z_mm;
};

/// Clears `seen` where the section hides itself from a viewer in its plane.  Going away from the viewer's own
/// height, a point is seen only if its elevation goes beyond that of all points before it.
void hide(const std::vector<double>& z_mm, const std::vector<double>& offset_mm, Viewer viewer,
          std::vector<bool>& seen) {
  const auto elevation = [&](std::size_t i) {
    return (z_mm[i] - viewer.z_mm) / (viewer.distance_mm - offset_mm[i]);
  };
  std::size_t level = 0;
  while (level < z_mm.size() && z_mm[level] < viewer.z_mm) ++level;
  double highest = -1e9;
  for (std::size_t i = level; i < z_mm.size(); ++i) {
    if (elevation(i) <= highest) seen[i] = false;
    highest = std::max(highest, elevation(i));
  }
  double lowest = 1e9;
  for (std::size_t i = level; i-- > 0;) {
    if (elevation(i) >= lowest) seen[i] = false;
    lowest = std::min(lowest, elevation(i));
  }
}

/// The stripe as the head of the rendered pictures sees it (MadeHead's light and lens), in the plane of the
/// section.
class StripeOn {
 public:
  StripeOn(const ScanSettings& settings, Random random)
      : settings_{settings}, random_{random}, rows_per_grain_{optics::rows_per_grain({})} {}

  /// A section's wall faces the head by another angle than the next one's.
  void next_profile() { facing_ratio_ = std::exp(k_facing_spread * random_.gaussian()); }

  void add(const SurfaceLook& look, const Vec2& place_mm, double slope, ScannedCloud& cloud) {
    const Vec2 to_laser = Vec2{settings_.laser_distance_mm, settings_.laser_z_mm} - place_mm;
    const double distance_mm = to_laser.norm();
    const double cosine = Vec2{1, -slope}.normalized().dot(to_laser) / distance_mm;
    const double sigma_px = std::hypot(k_sheet_px, k_blur_px, look.scattering_mm / k_mm_per_px);
    const double grey = k_full_grey * settings_.light_ratio * facing_ratio_ *
                        (look.glossy ? k_gloss_ratio : look.diffuse_ratio) *
                        std::max(cosine, k_least_cosine) * (settings_.laser_distance_mm / distance_mm) *
                        (k_sheet_px / sigma_px) * (1 + speckle_ratio(sigma_px) * random_.gaussian());
    cloud.amplitude.push_back(
        static_cast<float>(std::clamp(grey + k_noise_grey * random_.gaussian(), 1.0, 255.0)));
    cloud.width_px.push_back(static_cast<float>(k_fwhm_per_sigma * sigma_px *
                                                std::max(0.2, 1 + k_width_spread * random_.gaussian())));
  }

 private:
  /// Of a Gaussian's height as it is fitted to light of contrast C whose grain is L rows: C sqrt(L / (sqrt(2
  /// pi) s)).
  [[nodiscard]] double speckle_ratio(double sigma_px) const {
    return contrast_ * std::sqrt(rows_per_grain_ / (std::sqrt(2 * std::numbers::pi) * sigma_px));
  }

  static constexpr double k_mm_per_px = 0.1, k_sheet_px = 1.9, k_blur_px = 1.1, k_full_grey = 380;
  static constexpr double k_gloss_ratio = 0.02, k_least_cosine = 0.03;
  static constexpr double k_noise_grey = 1.0, k_width_spread = 0.06;
  static constexpr double k_facing_spread = 0.1, k_fwhm_per_sigma = 2.3548;

  const ScanSettings& settings_;
  Random random_;
  double rows_per_grain_;
  double contrast_{optics::polarised_contrast(0) * optics::pixel_contrast({})};
  double facing_ratio_{1};
};

}  // namespace

ScannedCloud scan_quickly(const MadeShoe& shoe, const ScanSettings& settings, const SE3& T_frame_shoe) {
  Random random(settings.seed);
  StripeOn stripe{settings, random.fork(1)};
  ScannedCloud cloud;
  const int profiles =
      std::max(3, static_cast<int>(std::round(shoe.perimeter_mm() / settings.profile_step_mm)));
  const Viewer camera{settings.camera_distance_mm, settings.camera_z_mm};
  const Viewer laser{settings.laser_distance_mm, settings.laser_z_mm};

  std::vector<double> z_mm, offset_mm;
  std::vector<bool> seen;
  for (int profile = 0; profile < profiles; ++profile) {
    const Section section = shoe.section(settings.begin_s_mm + shoe.perimeter_mm() * profile / profiles);
    // Columns do not stand still on the shoe: the arm never repeats a height exactly.
    const double first_z_mm = std::max(section.bottom_z_mm(), settings.field_low_z_mm) +
                              settings.column_step_mm * random.uniform({0, 1});
    const double last_z_mm = std::min(settings.field_high_z_mm, section.top_z_mm());
    z_mm.clear();
    offset_mm.clear();
    for (double z = first_z_mm; z < last_z_mm; z += settings.column_step_mm) {
      z_mm.push_back(z);
      offset_mm.push_back(section.offset_mm(z));
    }
    seen.assign(z_mm.size(), true);
    hide(z_mm, offset_mm, camera, seen);
    hide(z_mm, offset_mm, laser, seen);
    stripe.next_profile();
    for (std::size_t i = 0; i < z_mm.size(); ++i) {
      const double noise_mm = settings.noise_mm * random.gaussian();
      const SurfaceLook look = section.look(z_mm[i]);
      const bool lost = look.glossy && random.chance(settings.gloss_loss_ratio);
      if (!seen[i] || lost) continue;
      const Vec2 horizontal = section.place().point + offset_mm[i] * section.place().normal;
      const Vec2 eye = section.place().point + settings.camera_distance_mm * section.place().normal;
      const Vec3 point{horizontal.x(), horizontal.y(), z_mm[i]};
      const Vec3 ray = (point - Vec3{eye.x(), eye.y(), settings.camera_z_mm}).normalized();
      cloud.points.push_back((T_frame_shoe * (point + noise_mm * ray)).cast<float>());
      cloud.profile.push_back(static_cast<std::uint32_t>(profile));
      cloud.column.push_back(static_cast<std::uint16_t>(std::floor(z_mm[i] / settings.column_step_mm)));
      if (!settings.stripe) continue;
      const std::size_t before = i > 0 ? i - 1 : i;
      const std::size_t behind = i + 1 < z_mm.size() ? i + 1 : i;
      const double slope = (offset_mm[behind] - offset_mm[before]) / (z_mm[behind] - z_mm[before] + 1e-9);
      stripe.add(look, {offset_mm[i], z_mm[i]}, slope, cloud);
    }
  }
  return cloud;
}

}  // namespace biteline::sim
