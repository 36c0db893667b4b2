// SPDX-License-Identifier: MIT
#include "hal/sim/live/target_show.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hal/sim/render/stripe_renderer.hpp"

namespace biteline::sim {
namespace {

constexpr double k_degree = std::numbers::pi / 180;
constexpr double k_camera_tilt_rad = 40 * k_degree, k_hand_eye_tilt_rad = 32 * k_degree;
constexpr double k_plane_angle_error_rad = 0.03;

double seconds(Nanoseconds time) {
  return 1e-9 * static_cast<double>(time.count());
}

/// Grey levels under `ratio` of the nominal light.
std::array<std::uint8_t, 256> scaled_by(double ratio) {
  std::array<std::uint8_t, 256> table{};
  for (std::size_t grey = 0; grey < table.size(); ++grey)
    table[grey] = static_cast<std::uint8_t>(std::min(255.0, std::round(ratio * static_cast<double>(grey))));
  return table;
}

}  // namespace

TargetShow::TargetShow(const MadeHead& head, const TargetShowSettings& settings)
    : head_{head}, settings_{settings} {
  head_.model.region = {.offset_u_px = 0,
                        .offset_v_px = 0,
                        .width_px = head.sensor_width_px,
                        .height_px = head.sensor_height_px};
  CalibrationViews views(head_, Random(settings.seed).fork(3), settings.chessboard_squares);
  const SE3 T_base_sheet = views.draw_table_place();
  const SE3 T_cam_flange = head_.model.T_flange_cam.inverse(Eigen::Isometry);
  const auto add = [&](std::vector<PlacedGrid> sheets) {
    const SE3 T_base_flange =
        T_base_sheet * sheets.front().T_cam_sheet.inverse(Eigen::Isometry) * T_cam_flange;
    places_.push_back(
        {.sheets = std::move(sheets), .lamp = views.draw_lamp(1), .T_base_flange = T_base_flange});
  };
  for (int i = 0; i < settings.camera_places; ++i) add({views.draw_view(k_camera_tilt_rad)});
  const double plane_angle_rad = std::numbers::pi / 2 + k_plane_angle_error_rad * views.gaussian();
  for (int i = 0; i < settings.laser_places; ++i) {
    const auto sheets = views.draw_two_planes(plane_angle_rad);
    add({sheets.begin(), sheets.end()});
  }
  for (int i = 0; i < settings.hand_eye_places; ++i) add({views.draw_view(k_hand_eye_tilt_rad)});
}

void TargetShow::prepare(std::size_t index) {
  const Place& place = places_[index];
  const std::uint64_t noise_seed = settings_.seed * 1000 + index;
  rings_ = render_rings(head_, place.sheets, place.lamp, noise_seed);
  stripe_ = {.width_px = head_.sensor_width_px, .height_px = head_.sensor_height_px, .pixels = {}};
  stripe_.pixels.assign(rings_.pixels.size(), 0);
  // Triangles are always enough for a scene of sheets.
  if (const Result<Scene> scene = Scene::build(mesh_of_sheets(place.sheets))) {
    StripeRenderer(*scene, head_)
        .render(
            {.T_scene_cam = SE3::Identity(), .region = head_.model.region, .noise_seed = noise_seed + 500},
            stripe_.pixels, nullptr);
  }
  prepared_ = index;
}

void TargetShow::paint(std::size_t index, const GvExposure& exposure, bool lit,
                       std::span<std::uint8_t> pixels) {
  if (index != prepared_) prepare(index);
  const double gain = std::pow(10, exposure.gain_db / 20);
  const auto lamp = scaled_by(gain * seconds(exposure.exposure) / seconds(settings_.lamp_exposure));
  const auto laser = scaled_by(gain * seconds(exposure.exposure) / seconds(*head_.model.exposure));
  const auto full_width = static_cast<std::size_t>(head_.sensor_width_px);
  const auto width = static_cast<std::size_t>(exposure.region.width_px);
  for (int row = 0; row < exposure.region.height_px; ++row) {
    const std::size_t from = static_cast<std::size_t>(row + exposure.region.offset_v_px) * full_width +
                             static_cast<std::size_t>(exposure.region.offset_u_px);
    const std::size_t to = static_cast<std::size_t>(row) * width;
    for (std::size_t column = 0; column < width; ++column) {
      const int light = lit ? laser[stripe_.pixels[from + column]] : 0;
      pixels[to + column] =
          static_cast<std::uint8_t>(std::min(255, light + int{lamp[rings_.pixels[from + column]]}));
    }
  }
}

}  // namespace biteline::sim
