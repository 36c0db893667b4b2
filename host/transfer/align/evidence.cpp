// SPDX-License-Identifier: MIT
#include "host/transfer/align/evidence.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "host/transfer/align/voxel_map.hpp"

namespace biteline::transfer {
namespace {

using Motions = Eigen::Matrix<double, k_motion, k_motion>;

// Several stitches and threads: texture averages out, shape stays.
constexpr float k_patch_mm = 6;
constexpr std::size_t k_min_patch_surfels = 3;
constexpr double k_station_mm = 6;  // of the edge
constexpr double k_reach_mm = 5;
constexpr double k_edge_reach_mm = 2.5;  // twice what the wall may leave open in height and is not refused
constexpr double k_min_edge_overlap_ratio = 0.5;
constexpr double k_least_kernel_mm = 0.05, k_kernel_sigmas = 3;  // as run_icp()
constexpr double k_shortest_wave_mm = 60, k_shortest_edge_wave_mm = 40;

// What pairing surfels 2 mm apart leaves of a patch on a curved wall.  With less, its grain would be taken
// for knowledge: on made pairs the line is then twice as far off.
constexpr double k_least_noise_mm = 0.04;
// Patches beside each other see the same difference: some ten of them are one witness of how it varies.
constexpr double k_witness_ratio = 0.1;
// A difference is not of one kind all round the shoe, as the field is: variance that this adds.  Set on 312
// made pairs (bench_transfer_bound 1 3 and 101 10), held against 504 others.
constexpr double k_unlike_anywhere = 2.5;

// Nothing is known beforehand of where the sample lies, once it lies roughly right.
constexpr double k_start_mm = 10, k_start_rad = 0.05;

// The shapes and strengths that are tried.  Each step changes the motion's uncertainty by less than a third.
constexpr std::array k_along_mm{15.0, 25.0, 45.0, 80.0};
constexpr std::array k_across_mm{12.0, 25.0, 50.0, 200.0};
constexpr std::array k_strengths{1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0, 16384.0};  // to noise, squared
constexpr std::array k_edge_along_mm{15.0, 40.0, 100.0};
constexpr std::array k_edge_sigmas_mm{0.01, 0.03, 0.1, 0.3, 1.0};
constexpr std::array k_edge_noises_mm{0.01, 0.03, 0.1};

// An edge that is cut elsewhere and shows no wave of its own: as a template cuts it.
constexpr double k_elsewhere_ratio = 0.15;
constexpr double k_elsewhere_mm = 2.5, k_elsewhere_aslant_mm = 0.7;

constexpr double k_least_weight = 2e-3;  // less is left out

// Weighed from where it led, the next motion moves the line by less than 0.05 mm.  Along the shoe and turned
// about its height little holds an upper, and little of that moves the line: there it takes some rounds.
constexpr int k_rounds = 10;
constexpr double k_settled_mm = 0.03, k_settled_rad = 2e-4;

double square(double value) {
  return value * value;
}

struct Part {
  double log_weight;
  Twist mean;
  Motions covariance;
  FieldShape shape{};
  double sigma_mm{0};
  bool same_edge{false};
};

Motions start_information() {
  Motions information = Motions::Zero();
  information.diagonal().head<3>().setConstant(1 / square(k_start_mm));
  information.diagonal().tail<3>().setConstant(1 / square(k_start_rad));
  return information;
}

double log_determinant(const Motions& positive) {
  return 2 * Motions{positive.llt().matrixL()}.diagonal().array().log().sum();
}

/// What a patch of the wall has measured.  One last differs from the next outwards: where the wall bends over
/// to a collar's rounded edge, little of that is across it.
std::vector<FieldProblem::Row> wall_rows(const Sample& sample, const std::vector<Pair>& pairs,
                                         const SE3& T_target_source) {
  struct Patch {
    FieldProblem::Row sum{.along_mm = 0,
                          .across_mm = 0,
                          .jacobian = MotionRow::Zero(),
                          .difference_mm = 0,
                          .weight = 0,
                          .share = 0};
    std::size_t count{0};
    double way_mm{0};
  };
  const VoxelGrid grid{k_patch_mm};
  VoxelMap voxels;
  std::vector<Patch> patches;
  const double kernel_mm = k_kernel_sigmas * std::max(k_least_kernel_mm, robust_sigma_mm(pairs));
  for (const Pair& pair : pairs) {
    const std::uint32_t at = voxels.number(grid.key(sample.common.positions[pair.source]));
    if (at == patches.size()) patches.emplace_back();
    Patch& patch = patches[at];
    const double weight = 1 / square(1 + square(pair.residual_mm / kernel_mm));
    const OnWall& place = sample.common_on_wall[pair.source];
    if (patch.count == 0) patch.way_mm = place.along_mm;
    // The ring's end is its beginning.
    const double step_mm = std::remainder(place.along_mm - patch.way_mm, sample.line_length_mm);
    const Vec3 n = T_target_source.linear().transpose() * pair.direction;
    MotionRow jacobian;
    jacobian << n, pair.point.cross(n);
    patch.sum.along_mm += weight * step_mm;
    patch.sum.across_mm += weight * place.up_mm;
    patch.sum.jacobian += weight * jacobian;
    patch.sum.difference_mm += weight * pair.residual_mm;
    patch.sum.share += weight * n.head<2>().norm();
    patch.sum.weight += weight;
    ++patch.count;
  }
  std::vector<FieldProblem::Row> rows;
  double mean_weight = 0;
  for (const Patch& patch : patches) {
    if (patch.count < k_min_patch_surfels) continue;
    const double weight = patch.sum.weight;
    rows.push_back({.along_mm = patch.way_mm + patch.sum.along_mm / weight,
                    .across_mm = patch.sum.across_mm / weight,
                    .jacobian = patch.sum.jacobian / weight,
                    .difference_mm = patch.sum.difference_mm / weight,
                    .weight = weight,
                    .share = patch.sum.share / weight});
    mean_weight += weight;
  }
  for (FieldProblem::Row& row : rows) row.weight /= mean_weight / static_cast<double>(rows.size());
  return rows;
}

/// What the wall says by itself: a part for each shape and strength of the difference.
std::vector<Part> wall_parts(const Sample& sample, const std::vector<FieldProblem::Row>& rows) {
  const auto [low, high] = std::minmax_element(
      rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.across_mm < b.across_mm; });
  const FieldWaves waves{{.ring_mm = sample.line_length_mm,
                          .low_mm = low->across_mm,
                          .high_mm = high->across_mm,
                          .shortest_mm = k_shortest_wave_mm}};
  const FieldProblem problem{waves, rows};
  constexpr std::size_t k_tried = k_along_mm.size() * k_across_mm.size() * k_strengths.size();
  std::vector<Part> parts(k_tried);
  tbb::parallel_for(std::size_t{0}, k_tried, [&](std::size_t i) {
    const double strength = k_strengths[i % k_strengths.size()];
    const std::size_t shape_at = i / k_strengths.size();
    const FieldShape shape{.along_mm = k_along_mm[shape_at % k_along_mm.size()],
                           .across_mm = k_across_mm[shape_at / k_along_mm.size()]};
    const FieldProblem::Reduced reduced = problem.reduced(strength * waves.variances(shape));
    // As if the noise were 1 mm; then as strong as it must be (its restricted likelihood's best).
    const Motions& H = reduced.information;
    const Eigen::LDLT<Motions> solver{H};
    const Twist motion = -solver.solve(reduced.slope);
    const double free_count = problem.rows() - k_motion;
    const double variance =
        std::max(square(k_least_noise_mm), (reduced.squares + reduced.slope.dot(motion)) / free_count);
    const Motions information = H / (k_unlike_anywhere * variance) + start_information();
    parts[i] = {.log_weight = -0.5 * k_witness_ratio *
                              (free_count * std::log(variance) + reduced.log_determinant +
                               solver.vectorD().array().abs().max(1e-12).log().sum()),
                .mean = information.ldlt().solve(-reduced.slope / (k_unlike_anywhere * variance)),
                .covariance = information.inverse(),
                .shape = shape,
                .sigma_mm = std::sqrt(variance * strength)};
  });
  return parts;
}

/// Only those that count, weights summing up to 1 once their logarithms are gone.
void prune(std::vector<Part>& parts) {
  const double best = std::max_element(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
                        return a.log_weight < b.log_weight;
                      })->log_weight;
  double sum = 0;
  for (Part& part : parts) sum += std::exp(std::max(-60.0, part.log_weight - best));
  std::erase_if(parts, [&](const Part& part) {
    return std::exp(std::max(-60.0, part.log_weight - best)) < k_least_weight * sum;
  });
  sum = 0;
  for (Part& part : parts) sum += std::exp(part.log_weight - best);
  for (Part& part : parts) part.log_weight -= best + std::log(sum);
}

std::vector<FieldProblem::Row> edge_rows(const Sample& sample, const std::vector<Pair>& pairs,
                                         const SE3& T_target_source) {
  const auto count = static_cast<std::size_t>(std::ceil(sample.line_length_mm / k_station_mm));
  std::vector<FieldProblem::Row> stations(
      count, {.along_mm = 0, .across_mm = 0, .jacobian = MotionRow::Zero(), .difference_mm = 0, .weight = 0});
  for (const Pair& pair : pairs) {
    const double way_mm = sample.rim_on_wall[pair.source].along_mm;
    FieldProblem::Row& station =
        stations[std::min(count - 1, static_cast<std::size_t>(std::max(0.0, way_mm) / k_station_mm))];
    const Vec3 n = T_target_source.linear().transpose() * pair.direction;
    MotionRow jacobian;
    jacobian << n, pair.point.cross(n);
    station.along_mm += way_mm;
    station.jacobian += jacobian;
    station.difference_mm += pair.residual_mm;
    station.weight += 1;
  }
  std::erase_if(stations, [](const FieldProblem::Row& station) { return station.weight == 0; });
  for (FieldProblem::Row& station : stations) {
    station.along_mm /= station.weight;
    station.jacobian /= station.weight;
    station.difference_mm /= station.weight;
    station.weight = 1;
  }
  return stations;
}

/// What the wall says, under everything that the two edges may be.
std::vector<Part> with_edges(const std::vector<Part>& wall, const FieldProblem& problem,
                             const FieldWaves& waves) {
  struct Prepared {
    Motions information;
    Twist slope;
    double squares, log_determinant;
  };
  std::vector<Part> parts;
  std::vector<Prepared> walls;
  for (const Part& part : wall) {
    const Motions information = part.covariance.inverse();
    walls.push_back({.information = information,
                     .slope = -information * part.mean,
                     .squares = part.mean.dot(information * part.mean),
                     .log_determinant = log_determinant(information)});
  }
  for (const double along_mm : k_edge_along_mm) {
    const Eigen::VectorXd unit = waves.variances({.along_mm = along_mm, .across_mm = 1});
    for (const double sigma_mm : k_edge_sigmas_mm) {
      for (const double noise_mm : k_edge_noises_mm) {
        for (const bool same : {true, false}) {
          Eigen::VectorXd variances = square(sigma_mm) * unit;
          if (!same) {
            variances[waves.even()] += square(k_elsewhere_mm);
            variances[waves.once_round().first] += square(k_elsewhere_aslant_mm) / 2;
            variances[waves.once_round().second] += square(k_elsewhere_aslant_mm) / 2;
          }
          const FieldProblem::Reduced edge = problem.reduced(variances / square(noise_mm));
          const double rows_log = problem.rows() * std::log(square(noise_mm)) + edge.log_determinant;
          const double chance = same ? 1 - k_elsewhere_ratio : k_elsewhere_ratio;
          for (std::size_t i = 0; i < wall.size(); ++i) {
            const Motions information = walls[i].information + edge.information / square(noise_mm);
            const Twist slope = walls[i].slope + edge.slope / square(noise_mm);
            const Twist mean = information.ldlt().solve(-slope);
            const double squares = walls[i].squares + edge.squares / square(noise_mm) + slope.dot(mean);
            Part part = wall[i];
            part.log_weight += std::log(chance) - 0.5 * (rows_log - walls[i].log_determinant +
                                                         log_determinant(information) + squares);
            part.mean = mean;
            part.covariance = information.inverse();
            part.same_edge = same;
            parts.push_back(part);
          }
        }
      }
    }
  }
  return parts;
}

Surfaces surfaces_of(const Sample& sample, const Upper& upper, const NearestTable& table) {
  return {.source = sample.common,
          .target = upper.surfels,
          .target_table = table,
          .source_rim = &sample.rim,
          .target_rim = &upper.rim};
}

/// Everything about one placement.
FitEvidence evidence_at(const Sample& sample, const Surfaces& surfaces, const Placement& placement) {
  FitEvidence evidence{.T_target_source = placement.T_target_source};
  const std::vector<Pair> pairs = find_pairs(surfaces, placement, {.reach_mm = k_reach_mm});
  const std::vector<FieldProblem::Row> rows = wall_rows(sample, pairs, placement.T_target_source);
  if (rows.size() < 4 * k_motion) return evidence;
  std::vector<Part> parts = wall_parts(sample, rows);
  prune(parts);

  if (sample.rim.size() > 0 && surfaces.target_rim->size() > 0) {
    const std::vector<Pair> edge_pairs = find_rim_pairs(surfaces, placement, k_edge_reach_mm);
    const double overlap_ratio =
        static_cast<double>(edge_pairs.size()) / static_cast<double>(sample.rim.size());
    if (overlap_ratio >= k_min_edge_overlap_ratio) {
      const FieldWaves waves{{.ring_mm = sample.line_length_mm,
                              .low_mm = 0,
                              .high_mm = 0,
                              .shortest_mm = k_shortest_edge_wave_mm}};
      const FieldProblem problem{waves, edge_rows(sample, edge_pairs, placement.T_target_source)};
      parts = with_edges(parts, problem, waves);
      prune(parts);
      evidence.edges_compared = true;
      evidence.edge_mm = robust_sigma_mm(edge_pairs);
      for (const Part& part : parts)
        evidence.same_edge_ratio += part.same_edge ? std::exp(part.log_weight) : 0;
    }
  }

  // The likelier of the two readings of the edge has its way; the other stays in the uncertainty.
  const bool same = evidence.same_edge_ratio > 0.5;
  Twist motion = Twist::Zero();
  double sum = 0, best = -1e300;
  for (const Part& part : parts) {
    if (part.log_weight > best) {
      best = part.log_weight;
      evidence.likeliest_shape = part.shape;
      evidence.difference_sigma_mm = part.sigma_mm;
    }
    if (part.same_edge != same) continue;
    motion += std::exp(part.log_weight) * part.mean;
    sum += std::exp(part.log_weight);
  }
  motion /= sum;
  evidence.settled = motion.head<3>().norm() < k_settled_mm && motion.tail<3>().norm() < k_settled_rad;
  evidence.T_target_source = placement.T_target_source * geometry::exp_se3(motion);
  for (const Part& part : parts) {
    evidence.belief.push_back(
        {.weight = std::exp(part.log_weight), .mean = part.mean - motion, .covariance = part.covariance});
  }
  return evidence;
}

}  // namespace

FitEvidence weigh_evidence(const Sample& sample, const Upper& upper, const NearestTable& upper_table,
                           const Placement& start) {
  // Again from where it led: pairs, and which edge lies beside which, are those of a place.
  const Surfaces surfaces = surfaces_of(sample, upper, upper_table);
  Placement placement = start;
  FitEvidence evidence;
  for (int round = 0; round < k_rounds && !evidence.settled; ++round) {
    evidence = evidence_at(sample, surfaces, placement);
    placement.T_target_source = evidence.T_target_source;
  }
  return evidence;
}

}  // namespace biteline::transfer
