// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/arm_sway.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "host/cloud/uncertainty/radius.hpp"

namespace biteline::uncertainty {
namespace {

/// A piece of a level surface: so long at least, of points so near to the lowest one.
constexpr float k_level_mm = 0.4F, k_least_length_mm = 1.5F;
constexpr std::size_t k_least_points = 6;
/// The surface may lean so much at first sight; what then lies farther off is another level, or lies about.
constexpr double k_most_lean_mm = 5, k_least_off_mm = 0.3, k_most_off_mm = 1;
constexpr std::size_t k_least_pieces = 60;
constexpr double k_least_share = 0.6;
/// Of the pieces' places, where it is less: they lie on both sides of a shoe.
constexpr double k_least_spread_mm = 12;
/// Degrees of freedom: a plane takes some, and fewer tell too little.
constexpr double k_of_plane = 3, k_least_freedom = 4;
/// A swing of 8 Hz and what it follows from: to either side of a profile.
constexpr double k_reach_s = 0.1;
constexpr int k_least_near = 5;
/// Of the whole scan's variance in that of a place.
constexpr double k_of_all = 0.35;
/// Likewise of an arm by its motion: a spring swings on behind what moved it.
constexpr double k_of_all_by_motion = 0.5;

/// z = fit . (1, x, y), counted from a middle.
struct Plane {
  Vec2 middle{Vec2::Zero()};
  Vec3 fit{Vec3::Zero()};

  [[nodiscard]] Vec3 terms(const Vec3& point) const {
    return {1, point.x() - middle.x(), point.y() - middle.y()};
  }
  [[nodiscard]] double above_mm(const Vec3& point) const { return point.z() - fit.dot(terms(point)); }
};

template <typename Number>
Number median_of(std::vector<Number>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double mean_of(std::span<const double> values) {
  return values.empty()
             ? 0
             : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Student's limit for 95 % over that of the normal distribution; good to 2 % from four degrees of freedom
/// on.
double student_ratio(double freedom) {
  constexpr double k_z2 = 1.96 * 1.96;
  return 1 + (k_z2 + 1) / (4 * freedom) + (5 * k_z2 * k_z2 + 16 * k_z2 + 3) / (96 * freedom * freedom);
}

}  // namespace

double ArmMotion::sigma_mm_at(const Vec3& point_base) const {
  const auto nearest = std::ranges::min_element(
      places, {}, [&](const Place& place) { return (place.middle_base - point_base).squaredNorm(); });
  return nearest == places.end() ? sigma_mm : nearest->sigma_mm;
}

std::optional<ArmSway::Piece> ArmSway::lowest_level(std::span<const Eigen::Vector3f> points_base) {
  if (points_base.size() < k_least_points) return std::nullopt;
  std::vector<float> heights;
  heights.reserve(points_base.size());
  for (const Eigen::Vector3f& point : points_base) heights.push_back(point.z());
  constexpr std::ptrdiff_t k_strays = 2;  // may lie lower
  std::nth_element(heights.begin(), heights.begin() + k_strays, heights.end());
  const float low_mm = heights[static_cast<std::size_t>(k_strays)];
  heights.clear();
  Vec3 sum = Vec3::Zero();
  Eigen::Vector2f first{0, 0};
  float length_mm = 0;
  for (const Eigen::Vector3f& point : points_base) {
    if (!(std::abs(point.z() - low_mm) < k_level_mm)) continue;
    if (heights.empty()) first = point.head<2>();
    length_mm = std::max(length_mm, (point.head<2>() - first).norm());
    heights.push_back(point.z() - low_mm);
    sum += point.cast<double>();
  }
  if (heights.size() < k_least_points || length_mm < k_least_length_mm) return std::nullopt;
  const auto count = static_cast<double>(heights.size());
  const float level_mm = median_of(heights);
  for (float& height : heights) height = std::abs(height - level_mm);
  // Of a median: 1.2533 of a mean's; a normal's deviation is 1.4826 of its median from the middle.
  const double noise_mm = 1.2533 * 1.4826 * static_cast<double>(median_of(heights)) / std::sqrt(count);
  Vec3 middle = sum / count;
  middle.z() = static_cast<double>(low_mm + level_mm);
  return Piece{.middle_base = middle, .noise_mm2 = noise_mm * noise_mm, .profile = 0};
}

void ArmSway::add_profile(std::span<const Eigen::Vector3f> points_base, const ProfilePose& pose) {
  if (points_base.empty()) return;
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();  // from the first: single precision has few digits
  for (const Eigen::Vector3f& point : points_base) sum += point - points_base.front();
  sum /= static_cast<float>(points_base.size());
  if (std::optional<Piece> piece = lowest_level(points_base)) {
    piece->profile = profiles_.size();
    pieces_.push_back(*piece);
  }
  profiles_.push_back({.T_base_flange = pose.T_base_flange,
                       .time_s = pose.time_s,
                       .point_base = (points_base.front() + sum).cast<double>()});
}

std::vector<ArmSway::Piece> ArmSway::on_one_plane() const {
  std::vector<double> heights;
  Plane plane;
  for (const Piece& piece : pieces_) {
    heights.push_back(piece.middle_base.z());
    plane.middle += piece.middle_base.head<2>() / static_cast<double>(pieces_.size());
  }
  plane.fit[0] = median_of(heights);
  double limit_mm = k_most_lean_mm;
  std::vector<Piece> used;
  constexpr int k_rounds = 5;
  for (int round = 0; round < k_rounds; ++round) {
    used.clear();
    for (const Piece& piece : pieces_) {
      if (std::abs(plane.above_mm(piece.middle_base)) < limit_mm) used.push_back(piece);
    }
    if (used.size() < k_least_pieces) return {};
    Mat3 normal = Mat3::Zero();
    Vec3 right = Vec3::Zero();
    for (const Piece& piece : used) {
      const Vec3 terms = plane.terms(piece.middle_base);
      normal += terms * terms.transpose();
      right += piece.middle_base.z() * terms;
    }
    plane.fit = normal.ldlt().solve(right);
    heights.clear();
    for (const Piece& piece : used) heights.push_back(std::abs(plane.above_mm(piece.middle_base)));
    constexpr double k_far = 8;  // medians: more than five deviations
    limit_mm = std::clamp(k_far * median_of(heights), k_least_off_mm, k_most_off_mm);
  }
  for (Piece& piece : used) piece.middle_base.z() = plane.above_mm(piece.middle_base);
  return used;
}

std::vector<double> ArmSway::local_mm2(std::span<const Piece> pieces, double mean_mm2) const {
  std::vector<double> local(profiles_.size(), -1);
  double sum_mm2 = 0;
  double worst_mm2 = mean_mm2;
  std::size_t first = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < profiles_.size(); ++i) {
    const auto after_s = [&](std::size_t piece) {
      return profiles_[pieces[piece].profile].time_s - profiles_[i].time_s;
    };
    const auto own_mm2 = [&](std::size_t piece) {
      return std::pow(pieces[piece].middle_base.z(), 2) - pieces[piece].noise_mm2;
    };
    while (end < pieces.size() && after_s(end) <= k_reach_s) sum_mm2 += own_mm2(end++);
    while (first < end && after_s(first) < -k_reach_s) sum_mm2 -= own_mm2(first++);
    if (end - first < k_least_near) continue;
    const double near_mm2 = std::max(sum_mm2, 0.0) / static_cast<double>(end - first);
    local[i] = (1 - k_of_all) * near_mm2 + k_of_all * mean_mm2;
    worst_mm2 = std::max(worst_mm2, local[i]);
  }
  std::ranges::replace(local, -1, worst_mm2);
  return local;
}

std::optional<ArmMotion> ArmSway::motion() const {
  if (pieces_.size() < k_least_pieces) return std::nullopt;
  const std::vector<Piece> used = on_one_plane();
  const auto count = static_cast<double>(used.size());
  if (used.empty() || count < k_least_share * static_cast<double>(pieces_.size())) return std::nullopt;
  Vec2 mean = Vec2::Zero();
  for (const Piece& piece : used) mean += piece.middle_base.head<2>() / count;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  double square_mm2 = 0, noise_mm2 = 0, next_mm2 = 0, before_mm = 0;
  for (const Piece& piece : used) {
    const Vec2 from_mean = piece.middle_base.head<2>() - mean;
    spread += from_mean * from_mean.transpose() / count;
    const double off_mm = piece.middle_base.z();
    square_mm2 += off_mm * off_mm / count;
    noise_mm2 += piece.noise_mm2 / count;
    next_mm2 += std::exchange(before_mm, off_mm) * off_mm / count;
  }
  if (!(principal_axes(spread).minor_mm > k_least_spread_mm)) return std::nullopt;
  // Neighbours sway together: of a series with that correlation so many would tell as much alone.
  const double alike = std::clamp(next_mm2 / std::max(square_mm2, 1e-12), 0.0, 1.0);
  const double freedom = count * (1 - alike * alike) / (1 + alike * alike) - k_of_plane;
  if (!(freedom > k_least_freedom)) return std::nullopt;
  const double wider = student_ratio(freedom) * std::sqrt((freedom + k_of_plane) / freedom);
  const std::vector<double> local = local_mm2(used, std::max(square_mm2 - noise_mm2, 0.0));
  ArmMotion motion;
  motion.profiles = used.size();
  for (std::size_t i = 0; i < profiles_.size(); ++i) {
    motion.places.push_back({profiles_[i].point_base, wider * std::sqrt(local[i])});
    motion.sigma_mm += wider * wider * local[i] / static_cast<double>(profiles_.size());
  }
  motion.sigma_mm = std::sqrt(motion.sigma_mm);
  if (const double square = mean_of(squared_accelerations(profiles_)); square > 0)
    motion.give_mm_per_m_s2 = motion.sigma_mm / std::sqrt(square);
  return motion;
}

std::optional<ArmMotion> ArmSway::motion_by(const ArmGive& give) const {
  const std::vector<double> squares = squared_accelerations(profiles_);
  if (squares.empty()) return std::nullopt;
  const double mean = mean_of(squares);
  ArmMotion motion{.sigma_mm = give.mm_per_m_s2 * std::sqrt(mean),
                   .source = give.source,
                   .give_mm_per_m_s2 = give.mm_per_m_s2};
  double sum = 0;
  std::size_t first = 0;
  std::size_t end = 0;
  for (const CarriedPoint& profile : profiles_) {
    const double time_s = profile.time_s;
    while (end < squares.size() && profiles_[end].time_s <= time_s + k_reach_s) sum += squares[end++];
    while (profiles_[first].time_s < time_s - k_reach_s) sum -= squares[first++];
    const double near = std::max(sum, 0.0) / static_cast<double>(end - first);
    motion.places.push_back({.middle_base = profile.point_base,
                             .sigma_mm = give.mm_per_m_s2 * std::sqrt((1 - k_of_all_by_motion) * near +
                                                                      k_of_all_by_motion * mean)});
  }
  return motion;
}

}  // namespace biteline::uncertainty
