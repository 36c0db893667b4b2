// SPDX-License-Identifier: MIT
#include "hal/sim/render/stripe_renderer.hpp"

#include <algorithm>
#include <cfenv>
#include <cmath>

#include "common/core/contracts.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

/// Rays of the fan lie about half a pixel apart in the picture.
constexpr int k_fan_rays = 4600;
constexpr std::size_t k_gaussians = 1U << 16U;
/// Neighbouring rays whose hits are farther apart than this do not lie on one surface.
constexpr double k_jump_mm = 1.0;
/// Surfaces lit or seen flatter than this give no stripe worth drawing.
constexpr double k_least_cosine = 0.03;
constexpr double k_widest_sigma_px = 12;
/// Beyond this many sigmas a Gaussian of 255 levels is below a tenth of a level.
constexpr double k_reach_sigma = 4;
/// A glossy place gives back this share of what a matt one would, and mirrors that share.
constexpr double k_gloss_diffuse_ratio = 0.02;
constexpr double k_gloss_mirror_ratio = 0.35;
/// Places within the exposure that are looked at, and how far apart in the picture.
constexpr int k_most_places = 32;
constexpr double k_place_step_px = 0.5;
/// Light that wanders inside by a millimetre, across, has gone this much farther than light that did not;
/// judged.
constexpr double k_way_per_scattering = 2;
/// A mirrored stripe lies in another part of the field.
constexpr int k_mirrored_columns = 137, k_mirrored_rows = 91;

/// SplitMix64's last step: neighbouring numbers give unrelated ones.
std::uint64_t mixed(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  bits = (bits ^ (bits >> 27U)) * 0x94D049BB133111EBULL;
  return bits ^ (bits >> 31U);
}

/// Embree's vector lanes divide by zero on triangles parallel to a ray and throw the result away; the flags
/// that leaves are not this program's.
class KeepFloatingPointFlags {
 public:
  KeepFloatingPointFlags() { std::feholdexcept(&environment_); }
  ~KeepFloatingPointFlags() { std::fesetenv(&environment_); }
  KeepFloatingPointFlags(const KeepFloatingPointFlags&) = delete;
  KeepFloatingPointFlags& operator=(const KeepFloatingPointFlags&) = delete;

 private:
  std::fenv_t environment_{};
};

}  // namespace

StripeRenderer::StripeRenderer(const Scene& scene, const MadeHead& head) : scene_(scene), head_(head) {
  // Towards rising columns.
  Vec3 across_cam = head.laser.beam_cam.cross(head.model.laser_plane.normal_cam).normalized();
  if (across_cam.x() < 0) across_cam = -across_cam;
  const double reach = std::tan(head.laser.fan_half_rad);
  for (int i = 0; i < k_fan_rays; ++i) {
    const double tangent = reach * (2.0 * i / (k_fan_rays - 1) - 1);
    fan_cam_.push_back((head.laser.beam_cam + tangent * across_cam).normalized());
  }
  if (head.laser.coherent) speckle_ = SpeckleField::of(head.optics);
  Random random(12345);  // the same table for every head: pictures differ by where they begin in it
  for (std::size_t i = 0; i < k_gaussians; ++i) gaussians_.push_back(static_cast<float>(random.gaussian()));
}

void StripeRenderer::render(const Shot& shot, std::span<std::uint8_t> pixels,
                            std::vector<TrueStripePoint>* truth) {
  BITELINE_EXPECTS(pixels.size() == static_cast<std::size_t>(shot.region.width_px) *
                                        static_cast<std::size_t>(shot.region.height_px));
  if (truth != nullptr) truth->clear();
  prepare(shot);
  if (shot.laser_on) {
    lay_speckle(shot);
    trace(shot);
    draw_curve(curve_, false, shot, truth);
    draw_curve(mirror_curve_, true, shot, truth);
  }
  develop(shot, pixels);
}

void StripeRenderer::prepare(const Shot& shot) {
  const std::size_t count =
      static_cast<std::size_t>(shot.region.width_px) * static_cast<std::size_t>(shot.region.height_px);
  const double grey =
      head_.faults.black_grey + head_.faults.ambient_grey * shot.ambient_ratio * shot.exposure_ratio;
  if (light_.size() != count) backgrounds_.clear();
  if (light_.size() != count) light_.assign(count, 0.0F);
  constexpr std::size_t k_most_levels = 16;
  if (backgrounds_.size() > k_most_levels) backgrounds_.clear();
  std::vector<std::uint8_t>& background = backgrounds_[grey];
  background_ = &background;
  background_grey_ = grey;
  if (background.size() == 2 * count) return;
  background.resize(2 * count);
  const double sigma =
      std::hypot(head_.faults.read_noise_grey, std::sqrt(grey / head_.faults.electrons_per_grey));
  Random random(54321);
  for (auto& pixel : background) {
    const double level = grey + sigma * gaussians_[random.next() % k_gaussians];
    pixel = static_cast<std::uint8_t>(std::clamp(std::lround(level), 0L, 255L));
  }
}

StripeRenderer::CurvePoint StripeRenderer::look_at(const Vec3& point_scene, const RayHit& hit,
                                                   const Vec3& light_direction, double light_ratio,
                                                   const Shot& shot) const {
  CurvePoint seen{.point_scene = point_scene};
  const Vec3 eye_scene = shot.T_scene_cam.translation();
  const Vec3 to_eye = (eye_scene - point_scene).normalized();
  const double cosine_light = -hit.normal.dot(light_direction);
  if (cosine_light < k_least_cosine || hit.normal.dot(to_eye) < k_least_cosine) return seen;
  const Vec3 point_cam = shot.T_scene_cam.inverse(Eigen::Isometry) * point_scene;
  if (point_cam.z() <= 0) return seen;
  seen.pixel_px =
      head_.model.camera.project(point_cam) - Vec2(shot.region.offset_u_px, shot.region.offset_v_px);
  constexpr double k_margin_px = 40;
  if (seen.pixel_px.x() < -k_margin_px || seen.pixel_px.x() > shot.region.width_px + k_margin_px ||
      seen.pixel_px.y() < -k_margin_px || seen.pixel_px.y() > shot.region.height_px + k_margin_px) {
    return seen;
  }
  if (!scene_.sees(eye_scene, point_scene)) return seen;

  // Down the column the seen point moves on the facet: P(v) = r (n . P0) / (n . r).  How fast it leaves the
  // sheet's middle makes the stripe's width in the picture.
  const Vec3 normal_cam = shot.T_scene_cam.linear().transpose() * hit.normal;
  const Vec3 ray = point_cam / point_cam.z();
  const Vec3 ray_per_px{0, 1 / head_.model.camera.fv_px, 0};
  const Vec3 moved_per_px =
      point_cam.z() * (ray_per_px - ray * (normal_cam.dot(ray_per_px) / normal_cam.dot(ray)));
  const double sheet_mm_per_px = std::abs(head_.model.laser_plane.normal_cam.dot(moved_per_px));
  const double mm_per_px = std::max(sheet_mm_per_px, 1e-6);
  const double sheet_px = std::min(k_widest_sigma_px, head_.laser.sigma_mm / mm_per_px);
  const double scattered_px = std::min(k_widest_sigma_px, hit.look.scattering_mm / mm_per_px);
  seen.sigma_px = std::hypot(std::hypot(sheet_px, head_.faults.blur_px), scattered_px);

  const double distance_mm = (point_cam - head_.laser.emitter_cam).norm();
  const double nominal_mm = (Vec3(0, 0, head_.working_distance_mm) - head_.laser.emitter_cam).norm();
  const double diffuse_ratio = hit.look.glossy ? k_gloss_diffuse_ratio : hit.look.diffuse_ratio;
  seen.amplitude_grey = head_.laser.full_grey * shot.exposure_ratio * light_ratio * diffuse_ratio *
                        cosine_light * (nominal_mm / distance_mm) * (sheet_px / seen.sigma_px);
  const Vec3 light_cam = shot.T_scene_cam.linear().transpose() * light_direction;
  seen.grains = grains_of(hit.look);
  seen.smeared_px = smeared_px(point_cam, normal_cam, light_cam, shot);
  seen.seen = true;
  return seen;
}

Vec2 StripeRenderer::smeared_px(const Vec3& point_cam, const Vec3& normal_cam, const Vec3& light_cam,
                                const Shot& shot) const {
  if (shot.moved_cam_mm.isZero(0) && shot.turned_cam_rad.isZero(0)) return Vec2::Zero();
  // In the camera's frame the ray stands and the facet goes the other way; the spot runs along the ray.
  const Vec3 facet_moved = -(shot.moved_cam_mm + shot.turned_cam_rad.cross(point_cam));
  const double along_mm = normal_cam.dot(facet_moved) / normal_cam.dot(light_cam);
  const auto& camera = head_.model.camera;
  return camera.project(point_cam + 0.5 * along_mm * light_cam) -
         camera.project(point_cam - 0.5 * along_mm * light_cam);
}

void StripeRenderer::trace(const Shot& shot) {
  const KeepFloatingPointFlags flags;
  curve_.clear();
  mirror_curve_.clear();
  const Vec3 emitter_scene = shot.T_scene_cam * head_.laser.emitter_cam;
  for (const Vec3& direction_cam : fan_cam_) {
    const Vec3 direction = shot.T_scene_cam.linear() * direction_cam;
    const auto hit = scene_.first_hit(emitter_scene, direction);
    if (!hit) {
      curve_.emplace_back();
      mirror_curve_.emplace_back();
      continue;
    }
    const Vec3 point = emitter_scene + hit->distance_mm * direction;
    curve_.push_back(look_at(point, *hit, direction, 1.0, shot));
    mirror_curve_.emplace_back();
    if (!hit->look.glossy) continue;
    const Vec3 mirrored = direction - 2 * direction.dot(hit->normal) * hit->normal;
    const auto second = scene_.first_hit(point + 0.01 * hit->normal, mirrored);
    if (!second || second->look.glossy) continue;
    mirror_curve_.back() =
        look_at(point + second->distance_mm * mirrored, *second, mirrored, k_gloss_mirror_ratio, shot);
  }
}

void StripeRenderer::draw_curve(const std::vector<CurvePoint>& curve, bool mirrored, const Shot& shot,
                                std::vector<TrueStripePoint>* truth) {
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const CurvePoint& a = curve[i - 1];
    const CurvePoint& b = curve[i];
    if (!a.seen || !b.seen || (a.point_scene - b.point_scene).norm() > k_jump_mm) continue;
    const double left = std::min(a.pixel_px.x(), b.pixel_px.x()),
                 right = std::max(a.pixel_px.x(), b.pixel_px.x());
    if (right - left < 1e-12) continue;
    const double slope = (b.pixel_px.y() - a.pixel_px.y()) / (b.pixel_px.x() - a.pixel_px.x());
    // Of the curve, in one column.
    const double smear_a = a.smeared_px.y() - slope * a.smeared_px.x(),
                 smear_b = b.smeared_px.y() - slope * b.smeared_px.x();
    // Columns in (left, right]: each belongs to one pair of neighbours.
    const int first = std::max(0, static_cast<int>(std::floor(left)) + 1);
    const int last = std::min(shot.region.width_px - 1, static_cast<int>(std::floor(right)));
    for (int column = first; column <= last; ++column) {
      const double part = (column - a.pixel_px.x()) / (b.pixel_px.x() - a.pixel_px.x());
      TrueStripePoint stripe{
          .column_px = column,
          .row_px = a.pixel_px.y() + part * (b.pixel_px.y() - a.pixel_px.y()),
          .sigma_px = a.sigma_px + part * (b.sigma_px - a.sigma_px),
          .amplitude_grey = a.amplitude_grey + part * (b.amplitude_grey - a.amplitude_grey),
          .mirrored = mirrored};
      if (const double smear_px = smear_a + part * (smear_b - smear_a); smear_px != 0) {
        const double still_px = stripe.sigma_px;
        stripe.sigma_px = std::hypot(still_px, smear_px / std::sqrt(12.0));
        stripe.amplitude_grey *= still_px / stripe.sigma_px;
      }
      draw(stripe, a.grains, shot);
      if (truth != nullptr) truth->push_back(stripe);
    }
  }
}

StripeRenderer::Grains StripeRenderer::grains_of(const SurfaceLook& look) const {
  // What is mirrored was scattered once, at the surface.
  const double polarised_ratio = look.glossy ? 1 : look.polarised_ratio;
  const double spread_mm =
      std::hypot(2 * look.roughness_mm, look.glossy ? 0 : k_way_per_scattering * look.scattering_mm);
  return {.along_ratio = static_cast<float>(0.5 * (1 + polarised_ratio)),
          .contrast_ratio = static_cast<float>(optics::spectral_contrast(
              head_.optics, {.spread_mm = spread_mm, .line_width_nm = head_.laser.line_width_nm}))};
}

void StripeRenderer::lay_speckle(const Shot& shot) {
  if (!speckle_) return;
  const double px_per_mm = head_.model.camera.fu_px / head_.working_distance_mm;
  const Vec3 middle_cam(0, 0, head_.working_distance_mm);
  std::uint64_t pattern = mixed(shot.noise_seed + 1);
  Vec2 place_px(shot.region.offset_u_px, shot.region.offset_v_px);
  if (shot.speckle_stays_put) {
    const double turn_rad = 2 * optics::aperture_sine(head_.optics);
    Vec3 turned = geometry::log_so3(shot.T_scene_cam.linear()) / turn_rad;
    pattern = 0;
    for (double& steps : turned) {
      steps = std::round(steps);
      pattern = mixed(pattern + static_cast<std::uint64_t>(static_cast<std::int64_t>(steps)) + 1);
    }
    const Mat3 R_scene_cam = geometry::exp_so3(turn_rad * turned);
    const Vec3 middle_scene = shot.T_scene_cam * middle_cam;
    place_px += px_per_mm * (R_scene_cam.transpose() * middle_scene).head<2>();
  }
  const Vec2 way_px = px_per_mm * (shot.moved_cam_mm + shot.turned_cam_rad.cross(middle_cam)).head<2>();
  const int count =
      std::clamp(static_cast<int>(std::ceil(way_px.norm() / k_place_step_px)), 1, k_most_places);
  speckle_places_.clear();
  for (int i = 0; i < count; ++i) {
    const Vec2 half_px = 2 * (place_px + ((i + 0.5) / count - 0.5) * way_px);
    speckle_places_.push_back(
        {.column_half_px = static_cast<int>(std::lround(half_px.x())) +
                           static_cast<int>(pattern % (2 * SpeckleField::k_columns)),
         .row_half_px = static_cast<int>(std::lround(half_px.y())) +
                        static_cast<int>((pattern >> 32U) % (2 * SpeckleField::k_rows))});
  }
}

void StripeRenderer::read_speckle(const SpeckleField::Pixel& pixel, bool mirrored, const Grains& grains) {
  SpeckleField::Pixel from = pixel;
  if (mirrored) {
    from.column += k_mirrored_columns;
    from.first_row += k_mirrored_rows;
  }
  column_grains_.assign(grey_ratio_.size(), {});
  for (const SpeckleField::Place& place : speckle_places_) speckle_->add(place, from, column_grains_);
  const float share = grains.contrast_ratio / static_cast<float>(speckle_places_.size());
  const float along = share * grains.along_ratio, across = share * (1 - grains.along_ratio);
  for (std::size_t i = 0; i < grey_ratio_.size(); ++i)
    grey_ratio_[i] =
        1 - grains.contrast_ratio + along * column_grains_[i].along + across * column_grains_[i].across;
}

void StripeRenderer::draw(const TrueStripePoint& stripe, const Grains& grains, const Shot& shot) {
  const double reach = k_reach_sigma * stripe.sigma_px;
  const int low = std::max(0, static_cast<int>(std::ceil(stripe.row_px - reach)));
  const int high = std::min(shot.region.height_px - 1, static_cast<int>(std::floor(stripe.row_px + reach)));
  if (low > high) return;
  // A Gaussian at even steps: each value is the one before times a factor that itself changes by a constant
  // factor.
  const double inverse = 1 / (stripe.sigma_px * stripe.sigma_px);
  const double begin = low - stripe.row_px;
  double value = stripe.amplitude_grey * std::exp(-0.5 * begin * begin * inverse);
  double factor = std::exp(-(begin + 0.5) * inverse);
  const double change = std::exp(-inverse);
  const auto width = static_cast<std::size_t>(shot.region.width_px);
  grey_ratio_.assign(static_cast<std::size_t>(high - low + 1), 1.0F);
  if (speckle_) read_speckle({.column = stripe.column_px, .first_row = low}, stripe.mirrored, grains);
  for (int row = low; row <= high; ++row) {
    light_[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(stripe.column_px)] +=
        static_cast<float>(value) * grey_ratio_[static_cast<std::size_t>(row - low)];
    value *= factor;
    factor *= change;
  }
  touched_.push_back({stripe.column_px, low, high});
}

void StripeRenderer::develop(const Shot& shot, std::span<std::uint8_t> pixels) {
  Random random(shot.noise_seed);
  // Rows of the empty picture in an order of their own.
  const auto width = static_cast<std::size_t>(shot.region.width_px);
  for (int row = 0; row < shot.region.height_px; ++row) {
    const std::size_t begin = random.next() % (background_->size() - width);
    std::copy_n(background_->begin() + static_cast<std::ptrdiff_t>(begin), width,
                pixels.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(row) * width));
  }
  const CameraFaults& faults = head_.faults;
  for (const Range& range : touched_) {
    for (int row = range.low; row <= range.high; ++row) {
      const std::size_t index =
          static_cast<std::size_t>(row) * width + static_cast<std::size_t>(range.column);
      const double light = light_[index];
      if (light <= 0) continue;  // already developed: two stripes overlapped here
      light_[index] = 0;
      const std::uint64_t bits = random.next();
      const double level = background_grey_ + light;
      const double sigma = std::hypot(faults.read_noise_grey, std::sqrt(level / faults.electrons_per_grey));
      const double noisy = level + sigma * gaussians_[bits % k_gaussians];
      pixels[index] = static_cast<std::uint8_t>(std::clamp(std::lround(noisy), 0L, 255L));
    }
  }
  touched_.clear();
}

}  // namespace biteline::sim
