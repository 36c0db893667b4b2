// SPDX-License-Identifier: MIT
#include "host/transfer/moved.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "host/transfer/align/icp.hpp"
#include "host/transfer/align/line_beside.hpp"

namespace biteline::transfer {
namespace {

using Told = Moved::Verdict;
using Motion = Eigen::Matrix<double, 6, 1>;
using MotionSquares = Eigen::Matrix<double, 6, 6>;

constexpr float k_look_pitch_mm = 2;
constexpr double k_motion_reach_mm = 5;
// What belongs to the shoe: its groove and the sole's edge below the line, everything above.  Tables lie
// level below it.
constexpr double k_shoe_below_mm = 6, k_shoe_beside_mm = 12;
constexpr double k_level_below_mm = 3, k_level_cosine = 0.8;
// Poses of one stretch of the way are off alike, so a piece of the line counts once, however many points it
// has.
constexpr double k_piece_mm = 25;
constexpr std::size_t k_piece_surfels = 30;
constexpr std::size_t k_least_pieces = 9;  // three degrees of freedom besides the six of the motion
constexpr double k_widest_gap_ratio = 0.5;
constexpr double k_least_overlap = 0.7;
constexpr double k_patch_high_mm = 15;
constexpr double k_patch_least = 5;
// Of one shoe twice at most 0.036 mm (bench_moved), of two pieces whose lasts differ by 0.15 mm at least
// 0.06.
constexpr double k_same_shoe_mm = 0.05;
// What an arm does not repeat of a whole scan looks like a shoe that moved: 0.05 mm as makers tell it (ISO
// 9283: mean and three standard deviations of the distance) is 0.04 mm with 95 %.
constexpr double k_arm_u95_mm = 0.04;
constexpr double k_sigmas_95 = 1.96;
constexpr double k_weight_sigmas = 3;  // as run_icp() has it

template <class... Values>
std::string said(const char* pattern, Values... values) {
  return std::string{FixedText<200>::format(pattern, values...).view()};
}

struct Places {
  LineBeside line;
  Eigen::AlignedBox3f box;

  explicit Places(const std::vector<Vec3>& points) : line{points} {
    constexpr float k_around_mm = static_cast<float>(k_shoe_beside_mm + k_motion_reach_mm);
    constexpr float k_high_mm = 1000;
    for (const Vec3& p : points) box.extend(p.cast<float>());
    box.min().array() -= k_around_mm;
    box.max() += Eigen::Vector3f{k_around_mm, k_around_mm, k_high_mm};
  }
  [[nodiscard]] int piece(const LineBeside::Place& beside) const {
    return static_cast<int>(beside.along_mm / k_piece_mm);
  }
};

Surfels shoe_at_line(const cloud::PointCloud& cloud, const Places& places) {
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3f& p : cloud.points) {
    if (places.box.contains(p)) points.push_back(p);
  }
  if (points.empty()) return {.pitch_mm = k_look_pitch_mm};
  const Surfels all = surfels_of(points, k_look_pitch_mm);
  Surfels kept{.pitch_mm = all.pitch_mm};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const LineBeside::Place beside = places.line.at(all.positions[i].cast<double>());
    const double up_mm = all.positions[i].z() - beside.height_mm;
    const double out_mm = (all.positions[i].head<2>() - beside.foot.place).dot(beside.foot.outward);
    if (up_mm < -k_shoe_below_mm || out_mm > k_shoe_beside_mm) continue;
    if (up_mm < -k_level_below_mm && std::abs(all.normals[i].z()) > k_level_cosine) continue;
    kept.positions.push_back(all.positions[i]);
    kept.normals.push_back(all.normals[i]);
  }
  return kept;
}

/// Which side is outside is told by the whole shoe; of a part it is not known.
void face_alike(Surfels& part, const Surfels& whole, const NearestTable& table) {
  for (std::size_t i = 0; i < part.size(); ++i) {
    const std::uint32_t near = table.near(part.positions[i]);
    if (near != NearestTable::k_none && part.normals[i].dot(whole.normals[near]) < 0)
      part.normals[i] = -part.normals[i];
  }
}

/// Why this does not show enough of the shoe; empty: it does.
std::string why_not_seen(const char* name, const Surfels& shown, const Places& places) {
  const auto all = static_cast<std::size_t>(places.line.length_mm() / k_piece_mm) + 1;
  std::vector<std::size_t> surfels(all);
  for (const Eigen::Vector3f& p : shown.positions)
    ++surfels[static_cast<std::size_t>(places.piece(places.line.at(p.cast<double>())))];
  const auto seen = [](std::size_t count) { return count >= k_piece_surfels; };
  const auto pieces = static_cast<std::size_t>(std::ranges::count_if(surfels, seen));
  std::size_t gap = 0, widest = 0;
  for (std::size_t i = 0; i < 2 * all; ++i) {  // twice round: a gap may lie across the first place
    gap = seen(surfels[i % all]) ? 0 : gap + 1;
    widest = std::max(widest, gap);
  }
  if (pieces >= k_least_pieces &&
      static_cast<double>(widest) <= k_widest_gap_ratio * static_cast<double>(all))
    return {};
  const double length_mm = places.line.length_mm();
  const auto on_line_mm = [&](std::size_t count) {
    return std::min(static_cast<double>(count) * k_piece_mm, length_mm);
  };
  return said("%s shows too little of the shoe: %.0f mm of %.0f mm of its line, %.0f mm missing in one piece",
              name, on_line_mm(pieces), length_mm, on_line_mm(widest));
}

struct Estimate {
  MotionSquares covariance{MotionSquares::Zero()};
  double unexplained_mm{0};
};

/// Covariance by what the pieces of the line say apart (clustered: Liang and Zeger 1986, "Longitudinal data
/// analysis using generalized linear models"): no model of what the arm does is needed.
Estimate estimate(const std::vector<Pair>& pairs, const IcpResult& fit, const IcpOptions& options,
                  const Places& places) {
  const Mat3 R_source_target = fit.placement.T_target_source.linear().transpose();
  const double kernel_mm = k_weight_sigmas * std::max(options.least_scale_mm, fit.robust_mm);
  MotionSquares information = MotionSquares::Zero(), between = MotionSquares::Zero();
  std::map<int, Motion> pulls;
  std::map<std::pair<int, int>, std::pair<double, double>> patches;  // sum, count
  for (const Pair& pair : pairs) {
    const Vec3 n = R_source_target * pair.direction;
    Motion J;
    J << n, pair.point.cross(n);
    const double ratio = pair.residual_mm / kernel_mm;
    const double weight = 1 / ((1 + ratio * ratio) * (1 + ratio * ratio));
    information += weight * J * J.transpose();
    const LineBeside::Place beside = places.line.at(pair.point);
    const int piece = places.piece(beside);
    pulls.try_emplace(piece, Motion::Zero()).first->second += weight * pair.residual_mm * J;
    const int band = static_cast<int>(std::floor((pair.point.z() - beside.height_mm) / k_patch_high_mm));
    auto& [sum, count] = patches[{piece, band}];
    sum += pair.residual_mm;
    count += 1;
  }
  for (const auto& [piece, pull] : pulls) between += pull * pull.transpose();
  const auto pieces = static_cast<double>(pulls.size());
  const MotionSquares inverse = information.ldlt().solve(MotionSquares::Identity());
  Estimate out{.covariance = inverse * between * inverse * (pieces / std::max(1.0, pieces - 6))};
  double squares = 0, counted = 0;
  for (const auto& [at, patch] : patches) {
    const auto& [sum, count] = patch;
    if (count < k_patch_least) continue;
    squares += sum * sum / count;
    counted += count;
  }
  out.unexplained_mm = counted > 0 ? std::sqrt(squares / counted) : 0;
  return out;
}

void judge_motion(Moved& moved) {
  if (moved.shift_mm + moved.u95_mm <= moved.limit_mm) {
    moved.verdict = Told::Unmoved;
    moved.words =
        said("the shoe stands as it was scanned: moved %.2f mm, U95 %.2f mm", moved.shift_mm, moved.u95_mm);
  } else if (moved.shift_mm > std::max(moved.limit_mm, moved.u95_mm)) {
    moved.verdict = Told::Moved;
    moved.words = said("the shoe was moved by %.2f mm (U95 %.2f mm); up to %.2f mm it could be worked",
                       moved.shift_mm, moved.u95_mm, moved.limit_mm);
  } else {
    moved.words =
        said("the look does not tell whether the shoe was moved by more than %.2f mm: %.2f mm, U95 %.2f mm",
             moved.limit_mm, moved.shift_mm, moved.u95_mm);
  }
}

}  // namespace

Moved moved_since(const cloud::PointCloud& held, const cloud::PointCloud& look,
                  const std::vector<Vec3>& line_base, const MovedOptions& options) {
  Moved moved{.limit_mm = options.limit_mm};
  if (line_base.size() < 3) {
    moved.words = "the held scan has no line";
    return moved;
  }
  const Places places{line_base};
  const Surfels target = shoe_at_line(held, places);
  Surfels source = shoe_at_line(look, places);
  moved.words = why_not_seen("the held scan", target, places);
  if (moved.words.empty()) moved.words = why_not_seen("the look", source, places);
  if (!moved.words.empty()) return moved;
  const NearestTable table{target, static_cast<float>(k_motion_reach_mm)};
  face_alike(source, target, table);
  const Surfaces surfaces{.source = source, .target = target, .target_table = table};
  const IcpOptions icp{.reach_mm = k_motion_reach_mm, .max_iterations = 60};
  const IcpResult fit = run_icp(surfaces, {}, icp);
  if (!fit.converged || fit.overlap_ratio < k_least_overlap) {
    moved.verdict = Told::OtherShoe;
    moved.words =
        said("another shoe stands there, or it was moved far: %.0f %% of the look lies on the held scan",
             100 * fit.overlap_ratio);
    return moved;
  }
  const SE3 T_back = fit.placement.T_target_source.inverse();  // from where the shoe stood to where it stands
  const Estimate known = estimate(find_pairs(surfaces, fit.placement, icp), fit, icp, places);
  for (const Vec3& p : line_base) {
    const Vec3 now = T_back * p;
    moved.shift_mm = std::max(moved.shift_mm, (now - p).norm());
    Eigen::Matrix<double, 3, 6> J;
    J << Mat3::Identity(), -geometry::hat(now);
    const double sigma_mm = std::sqrt((J * known.covariance * J.transpose()).trace());
    moved.u95_mm = std::max(moved.u95_mm, std::hypot(k_sigmas_95 * sigma_mm, k_arm_u95_mm));
  }
  moved.unexplained_mm = known.unexplained_mm;
  if (moved.unexplained_mm > k_same_shoe_mm) {
    moved.verdict = Told::OtherShoe;
    moved.words = said(
        "another shoe stands there: no motion brings it nearer to the held one than %.2f mm (limit %.2f mm)",
        moved.unexplained_mm, k_same_shoe_mm);
    return moved;
  }
  judge_motion(moved);
  return moved;
}

}  // namespace biteline::transfer
