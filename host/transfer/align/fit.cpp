// SPDX-License-Identifier: MIT
#include "host/transfer/align/fit.hpp"

#include <algorithm>
#include <cmath>

#include "host/transfer/align/voxel_map.hpp"

namespace biteline::transfer {
namespace {

constexpr float k_patch_mm = 6;  // several stitches and threads: texture averages out, shape stays
constexpr std::size_t k_min_patch_surfels = 3;
constexpr double k_max_rim_mm = 0.12;  // rims that scatter more are not the same edge
constexpr double k_min_rim_overlap_ratio = 0.5;
constexpr double k_rim_reach_mm = 1.5;

double square(double value) {
  return value * value;
}

IcpOptions fine_options() {
  return {.reach_mm = k_fine_reach_mm, .max_iterations = 40, .rim_reach_mm = k_rim_reach_mm};
}

IcpOptions fine_options(const GradingLaw& law) {
  IcpOptions options = fine_options();
  options.max_iterations = 150;  // length and offset nearly stand for one another
  options.freedom = Freedom::Graded;
  options.law = law;
  return options;
}

/// RMS of the patches' mean residuals.
double shape_rms_mm(const Surfels& source, const std::vector<Pair>& pairs) {
  struct Patch {
    double sum{0};
    std::size_t count{0};
  };
  const VoxelGrid grid{k_patch_mm};
  VoxelMap voxels;
  std::vector<Patch> patches;
  for (const Pair& pair : pairs) {
    const std::uint32_t at = voxels.number(grid.key(source.positions[pair.source]));
    if (at == patches.size()) patches.emplace_back();
    patches[at].sum += pair.residual_mm;
    patches[at].count += 1;
  }
  double sum = 0;
  std::size_t count = 0;
  for (const Patch& patch : patches) {
    if (patch.count < k_min_patch_surfels) continue;
    sum += square(patch.sum / static_cast<double>(patch.count)) * static_cast<double>(patch.count);
    count += patch.count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
}

Surfaces surfaces_of(const FitTask& task) {
  return {.source = task.sample.common,
          .target = task.upper.surfels,
          .target_table = task.upper_table,
          .source_line = task.upper_line != nullptr ? &task.sample.line_shoe : nullptr,
          .target_line = task.upper_line};
}

Surfaces with_rims(const FitTask& task) {
  Surfaces surfaces = surfaces_of(task);
  surfaces.source_rim = &task.sample.rim;
  surfaces.target_rim = &task.upper.rim;
  return surfaces;
}

bool rims_agree(const IcpResult& icp) {
  return icp.rim_overlap_ratio >= k_min_rim_overlap_ratio && icp.rim_mm <= k_max_rim_mm;
}

Fit described(const FitTask& task, Fit fit, const IcpOptions& options) {
  fit.pairs = find_pairs(surfaces_of(task), fit.icp.placement, options);
  fit.shape_rms_mm = shape_rms_mm(task.sample.common, fit.pairs);
  return fit;
}

double line_between_mm(const Sample& sample, const Fit& a, const Fit& b) {
  double sum = 0;
  for (const Vec3& p : sample.line_shoe) {
    const Foot foot{.place = p.head<2>().cast<float>()};
    sum += (a.icp.placement.place(p, foot) - b.icp.placement.place(p, foot)).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(sample.line_shoe.size()));
}

/// By the surface alone, then by the rims, too, where they are the same edge and leave the surfaces over each
/// other: a view that ends elsewhere makes rims that agree with each other and not with the shoe.
Fit refine(const FitTask& task, const Placement& start, const IcpOptions& options) {
  const Fit free = described(task, {.icp = run_icp(surfaces_of(task), start, options)}, options);
  if (task.sample.rim.size() == 0 || task.upper.rim.size() == 0 || free.shape_rms_mm <= 0) return free;
  const Fit with_rim = described(
      task, {.icp = run_icp(with_rims(task), free.icp.placement, options), .rim_used = true}, options);
  const bool borne = with_rim.icp.overlap_ratio >= 0.98 * free.icp.overlap_ratio;
  if (!rims_agree(with_rim.icp) || !borne) return free;
  Fit fit = with_rim;
  fit.rim_shift_mm = line_between_mm(task.sample, with_rim, free);
  return fit;
}

}  // namespace

Fit fit_rigid(const FitTask& task, const Placement& start) {
  const IcpOptions options = fine_options();
  return described(task, {.icp = run_icp(surfaces_of(task), start, options)}, options);
}

void weigh(const FitTask& task, Fit& fit) {
  fit.evidence = weigh_evidence(task.sample, task.upper, task.upper_table, fit.icp.placement);
  fit.icp.placement.T_target_source = fit.evidence.T_target_source;
  fit.icp.converged = fit.evidence.settled;
  fit.rim_used = fit.evidence.same_edge_ratio > 0.5;
  fit.icp.rim_mm = fit.evidence.edge_mm;
  fit.pairs = find_pairs(surfaces_of(task), fit.icp.placement, fine_options());
  fit.icp.overlap_ratio =
      static_cast<double>(fit.pairs.size()) / static_cast<double>(task.sample.common.size());
}

Fit fit_graded(const FitTask& task, const Placement& start, const GradingLaw& law) {
  return refine(task, start, fine_options(law));
}

}  // namespace biteline::transfer
