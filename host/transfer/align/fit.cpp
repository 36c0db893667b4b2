// SPDX-License-Identifier: MIT
#include "host/transfer/align/fit.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/transfer/align/voxel_map.hpp"

namespace biteline::transfer {
namespace {

constexpr float k_patch_mm = 6;  // several stitches and threads: texture averages out, shape stays
constexpr std::size_t k_min_patch_surfels = 3;
constexpr double k_max_rim_mm = 0.12;  // rims that scatter more are not the same edge
constexpr double k_min_rim_overlap_ratio = 0.5;
constexpr double k_rim_reach_mm = 1.5;
// A freer fit must be better by this, in independent pieces of the surface, or else move the line farther
// than it is usually off itself (made shoes, 230 to 310 mm from 270: 0.35 mm at most), to be taken for
// another rule.
constexpr double k_worth = 1.5;
constexpr double k_likely_mm = 0.4;
constexpr std::array k_rules{GradeTie{.section_share = 0, .height_share = 0},
                             GradeTie{.section_share = 1, .height_share = 1},
                             GradeTie{.section_share = 1, .height_share = 0}};

double square(double value) {
  return value * value;
}

IcpOptions fine_options(Freedom freedom, const GradeTie& tie) {
  return {.reach_mm = k_fine_reach_mm,
          .max_iterations =
              freedom == Freedom::Rigid ? 40 : 150,  // length and offset nearly stand for one another
          .freedom = freedom,
          .tie = tie,
          .rim_reach_mm = k_rim_reach_mm};
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
  return {.source = task.sample.common, .target = task.upper.surfels, .target_table = task.upper_table};
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

/// How much better the freer fit is, in units of what chance gives: independent pieces of the surface that
/// differ from last to last.
double gain(const Surfels& source, const Fit& tied, const Fit& free) {
  constexpr double k_correlation_mm = 40;  // as in icp.cpp
  const double pieces = static_cast<double>(source.size()) * square(source.pitch_mm / k_correlation_mm);
  return pieces * (square(tied.shape_rms_mm / free.shape_rms_mm) - 1);
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
  const Fit free =
      described(task, {.icp = run_icp(surfaces_of(task), start, options), .tie = options.tie}, options);
  if (task.sample.rim.size() == 0 || task.upper.rim.size() == 0 || free.shape_rms_mm <= 0) return free;
  const Fit with_rim = described(
      task,
      {.icp = run_icp(with_rims(task), free.icp.placement, options), .rim_used = true, .tie = options.tie},
      options);
  const bool borne = with_rim.icp.overlap_ratio >= 0.98 * free.icp.overlap_ratio;
  if (!rims_agree(with_rim.icp) || !borne) return free;
  Fit fit = with_rim;
  fit.rim_shift_mm = line_between_mm(task.sample, with_rim, free);
  return fit;
}

/// Section and height let go from where the rule has brought them; the rims, once found, are kept.
Fit let_go(const FitTask& task, const Fit& tied) {
  const IcpOptions options = fine_options(Freedom::Graded, {});
  const Fit fit{
      .icp = run_icp(tied.rim_used ? with_rims(task) : surfaces_of(task), tied.icp.placement, options),
      .rim_used = tied.rim_used,
      .rim_shift_mm = tied.rim_shift_mm};
  return described(task, fit, options);
}

}  // namespace

Fit fit_rigid(const FitTask& task, const Placement& start) {
  const IcpOptions options = fine_options(Freedom::Rigid, {});
  return described(task, {.icp = run_icp(surfaces_of(task), start, options)}, options);
}

void weigh(const FitTask& task, Fit& fit) {
  fit.evidence = weigh_evidence(task.sample, task.upper, task.upper_table, fit.icp.placement);
  fit.icp.placement.T_target_source = fit.evidence.T_target_source;
  fit.icp.converged = fit.evidence.settled;
  fit.rim_used = fit.evidence.same_edge_ratio > 0.5;
  fit.icp.rim_mm = fit.evidence.edge_mm;
  fit.pairs = find_pairs(surfaces_of(task), fit.icp.placement, fine_options(Freedom::Rigid, {}));
  fit.icp.overlap_ratio =
      static_cast<double>(fit.pairs.size()) / static_cast<double>(task.sample.common.size());
}

Fit fit_graded(const FitTask& task, const Placement& start) {
  std::array<Fit, k_rules.size()> fits;
  tbb::parallel_for(std::size_t{0}, k_rules.size(), [&](std::size_t i) {
    fits[i] = refine(task, start, fine_options(Freedom::Graded, k_rules[i]));
  });
  // A rule that must do without the rims has bought its fit with them, one without pairs is none.
  std::sort(fits.begin(), fits.end(), [](const Fit& a, const Fit& b) {
    if (a.rim_used != b.rim_used) return a.rim_used;
    return a.shape_rms_mm > 0 && (b.shape_rms_mm <= 0 || a.shape_rms_mm < b.shape_rms_mm);
  });
  Fit tied = fits.front();
  if (tied.shape_rms_mm <= 0) return tied;
  Fit free = let_go(task, tied);
  if (free.shape_rms_mm <= 0) return tied;
  const double between_mm = line_between_mm(task.sample, tied, free);
  if (gain(task.sample.common, tied, free) < k_worth && between_mm < k_likely_mm) {
    tied.rival_mm = between_mm;
    return tied;
  }
  return free;
}

}  // namespace biteline::transfer
