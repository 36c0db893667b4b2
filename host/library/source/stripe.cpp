// SPDX-License-Identifier: MIT
#include "biteline/stripe.hpp"

#include "common/config/sensor_yaml.hpp"
#include "common/stripe/peak_extractor.hpp"
#include "host/library/source/inside.hpp"

namespace biteline::sdk {

Head make_head(const geometry::SensorModel& model) {
  return Head{std::make_shared<const Head::State>(Head::State{.model = model})};
}

Head::Head(std::shared_ptr<const State> state) : state_{std::move(state)} {}

int Head::width_px() const {
  return state_->model.region.width_px;
}
int Head::height_px() const {
  return state_->model.region.height_px;
}
Motion Head::T_flange_cam() const {
  return from_inside(state_->model.T_flange_cam);
}
Eigen::Vector3d Head::laser_normal_cam() const {
  return state_->model.laser_plane.normal_cam;
}
double Head::laser_distance_mm() const {
  return state_->model.laser_plane.distance_mm;
}

Eigen::Vector2d Head::project(const Eigen::Vector3d& point_cam_mm) const {
  if (!point_cam_mm.allFinite() || point_cam_mm.z() <= 0)
    throw Error{"point: not before the camera", "give a finite point with z above 0"};
  const geometry::Region& region = state_->model.region;
  return state_->model.camera.project(point_cam_mm) - Vec2{region.offset_u_px, region.offset_v_px};
}

Eigen::Vector3d Head::triangulate(double column_px, double row_px) const {
  const geometry::Region& region = state_->model.region;
  const Vec3 point = geometry::triangulate(state_->model.camera, state_->model.laser_plane,
                                           {column_px + region.offset_u_px, row_px + region.offset_v_px});
  if (!point.allFinite() || point.z() <= 0)
    throw Error{"pixel: its ray does not meet the laser's plane", "give a pixel that the stripe can reach"};
  return point;
}

std::string Head::yaml() const {
  return config::sensor_yaml_text(state_->model, "written by libbiteline");
}

Head read_head(const std::filesystem::path& file) {
  return make_head(or_throw(config::read_sensor_yaml(file)));
}

std::vector<Peak> find_stripe(const Picture& picture, const StripeSettings& settings) {
  if (picture.pixels == nullptr || picture.width_px < 0 ||
      picture.stride_bytes < static_cast<std::size_t>(picture.width_px))
    throw Error{"picture: no pixels, or rows that overlap", "give a picture with its stride"};
  stripe::PeakExtractor extractor =
      or_throw(stripe::PeakExtractor::create({.threshold_grey = settings.threshold_grey,
                                              .width_min_px = settings.width_min_px,
                                              .width_max_px = settings.width_max_px},
                                             picture.width_px, picture.height_px));
  const auto found = std::make_unique<stripe::Peaks>();
  extractor.rt_extract(
      {.pixels = picture.pixels, .stride_bytes = picture.stride_bytes, .height_px = picture.height_px},
      *found);
  std::vector<Peak> peaks;
  for (int column = 0; column < found->column_count; ++column) {
    const stripe::ColumnPeaks& there = found->columns[static_cast<std::size_t>(column)];
    if (there.kept_count == 0) continue;
    const stripe::Peak& peak = there.kept[0];
    peaks.push_back({.column_px = column,
                     .row_px = peak.row_px,
                     .sigma_row_px = peak.sigma_row_px,
                     .amplitude = peak.amplitude,
                     .width_px = peak.width_px,
                     .sound = peak.flags == 0});
  }
  return peaks;
}

}  // namespace biteline::sdk
