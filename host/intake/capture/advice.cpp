// SPDX-License-Identifier: MIT
#include "host/intake/capture/advice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/geometry/symmetric.hpp"

namespace biteline::capture {
namespace {

constexpr double k_degree = std::numbers::pi / 180;
/// Tilts below this hardly tell the focal length from the distance.
const double k_least_tilt = std::sin(12 * k_degree);
/// Two axes with turns of this size determine the mounting; see host/calibration/handeye.
constexpr double k_least_turn_rad = 25 * k_degree, k_least_spread_rad = 10 * k_degree;

constexpr std::array k_fields{"upper left corner", "upper edge", "upper right corner",
                              "left edge",         "middle",     "right edge",
                              "lower left corner", "lower edge", "lower right corner"};
/// Corners first: there the lens distorts most.
constexpr std::array<std::size_t, 9> k_order{0, 2, 6, 8, 1, 3, 5, 7, 4};

std::size_t third(double place, int size) {
  return static_cast<std::size_t>(std::clamp(static_cast<int>(3 * place / size), 0, 2));
}

}  // namespace

int Coverage::count() const {
  return static_cast<int>(std::ranges::count(seen, true));
}

Coverage coverage_of(const std::vector<calibration::PlaneView>& views, calibration::PictureSize size) {
  Coverage coverage;
  for (const calibration::PlaneView& view : views) {
    for (const calibration::CentreObservation& centre : view.centres)
      coverage
          .seen[3 * third(centre.pixel_px.y(), size.height_px) + third(centre.pixel_px.x(), size.width_px)] =
          true;
  }
  return coverage;
}

std::string missing_field(const Coverage& coverage) {
  for (const std::size_t field : k_order) {
    if (!coverage.seen[field]) return k_fields[field];
  }
  return {};
}

std::string missing_tilt(const std::vector<SE3>& T_cam_target) {
  // The normal points away from the camera: where it leans to the right, the left edge lies farther.
  bool left = false, right = false, up = false, down = false;
  for (const SE3& T : T_cam_target) {
    const Vec3 normal = T.linear().col(2);
    left = left || normal.x() > k_least_tilt;
    right = right || normal.x() < -k_least_tilt;
    up = up || normal.y() > k_least_tilt;
    down = down || normal.y() < -k_least_tilt;
  }
  if (!left) return "tilt more: the left edge away from the camera";
  if (!right) return "tilt more: the right edge away from the camera";
  if (!up) return "tilt more: the upper edge away from the camera";
  if (!down) return "tilt more: the lower edge away from the camera";
  return {};
}

std::string missing_depth(const std::vector<double>& stripe_rows_px, int height_px) {
  std::array<bool, 3> seen{};
  for (const double row : stripe_rows_px) seen[third(row, height_px)] = true;
  constexpr std::array k_words{"upper", "middle", "lower"};
  for (const std::size_t part : {std::size_t{0}, std::size_t{2}, std::size_t{1}}) {
    if (!seen[part])
      return std::string{"nearer or farther, until the stripe lies in the "} + k_words[part] +
             " third of the picture";
  }
  return {};
}

std::string missing_turn(const std::vector<SE3>& T_base_flange) {
  if (T_base_flange.size() < 2) return "turn the head about any axis";
  Mat3 scatter = Mat3::Zero();
  double largest_rad = 0;
  for (const SE3& T : T_base_flange) {
    const Eigen::AngleAxisd turn{T_base_flange.front().linear().transpose() * T.linear()};
    largest_rad = std::max(largest_rad, std::abs(turn.angle()));
    const Vec3 vector = turn.angle() * turn.axis();
    scatter += vector * vector.transpose();
  }
  if (largest_rad < k_least_turn_rad) return "turn the head farther, by 30 degrees or more";
  scatter /= static_cast<double>(T_base_flange.size() - 1);
  if (std::sqrt(std::max(0.0, geometry::principal_axes(scatter).values[1])) < k_least_spread_rad)
    return "turn the head about another axis: so far it turned about one only";
  return {};
}

}  // namespace biteline::capture
