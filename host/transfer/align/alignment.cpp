// SPDX-License-Identifier: MIT
#include "host/transfer/align/alignment.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "common/core/fixed_text.hpp"
#include "host/geometry/symmetric.hpp"
#include "host/transfer/align/advice.hpp"
#include "host/transfer/align/fit.hpp"
#include "host/transfer/align/line_beside.hpp"
#include "host/transfer/align/starts.hpp"

namespace biteline::transfer {
namespace {

// Lasts of one model differ by about half as much; other models by several times.
constexpr double k_max_shape_rms_mm = 0.2;
constexpr double k_max_graded_rms_mm = 0.3;  // sizes of one model differ besides by what grading describes
constexpr double k_min_overlap_ratio = 0.6;
constexpr double k_hopeless_overlap_ratio =
    0.4;  // so small a part fits in many places: nothing else can be said of it
constexpr double k_min_upper_overlap_ratio =
    0.85;  // a partial scan of the right shoe lies wholly on the sample
constexpr double k_max_direction_sigma_mm =
    0.5;  // beyond it the line misses its 0.35 mm at the 95th percentile

double square(double value) {
  return value * value;
}

/// Which of the graded sample's surfels lies where.
std::shared_ptr<const NearestTable> table_of(const Sample& sample, const Grade& grade) {
  if (grade.is_none() && sample.common_table) return sample.common_table;
  Surfels graded = sample.common;
  for (std::size_t i = 0; i < graded.size(); ++i)
    graded.positions[i] = grade.apply(graded.positions[i].cast<double>(), graded.foot(i)).cast<float>();
  return std::make_shared<const NearestTable>(graded, static_cast<float>(k_fine_reach_mm));
}

/// Share of the upper's surfels, beside and above the line, that lie on the placed sample.
double upper_overlap_ratio(const Sample& sample, const Upper& upper, const Placement& placement) {
  const std::shared_ptr<const NearestTable> table = table_of(sample, placement.grade);
  std::vector<Vec3> graded_line = sample.line_shoe;
  for (Vec3& p : graded_line) p = placement.grade.apply(p, Foot{.place = p.head<2>().cast<float>()});
  const LineBeside line{graded_line};
  const SE3 T_source_target = placement.T_target_source.inverse();
  std::size_t above = 0, paired = 0;
  for (const Eigen::Vector3f& position : upper.surfels_coarse.positions) {
    const Vec3 p = T_source_target * position.cast<double>();
    if (p.z() < line.at(p).height_mm + k_groove_margin_mm) continue;
    ++above;
    if (table->near(p.cast<float>()) != NearestTable::k_none) ++paired;
  }
  return above > 0 ? static_cast<double>(paired) / static_cast<double>(above) : 0;
}

/// How far turning about each axis moves the line, RMS, per rad.
Vec3 arms_mm(const std::vector<Vec3>& line, const Vec3& centre) {
  Vec3 squares = Vec3::Zero();
  for (const Vec3& p : line) {
    const Vec3 d = (p - centre).cwiseAbs2();
    squares += Vec3{d.y() + d.z(), d.z() + d.x(), d.x() + d.y()};
  }
  return (squares / static_cast<double>(line.size())).cwiseSqrt();
}

const char* words_of(const Twist& scaled_direction) {
  // The largest of six displacements at the shoe's end, each a thing that an operator can picture.
  static constexpr std::array<const char*, 6> k_words{"along the shoe",
                                                      "across the shoe",
                                                      "up and down",
                                                      "in roll (about its length)",
                                                      "in pitch (heel against toe)",
                                                      "in yaw (about the vertical)"};
  Eigen::Index largest = 0;
  scaled_direction.cwiseAbs().maxCoeff(&largest);
  return k_words[static_cast<std::size_t>(largest)];
}

/// RMS over the line of how far it may be off, grading included: J covariance J^T with J of each of its
/// points.
double line_sigma_mm(const Sample& sample, const Fit& fit, const Information& H) {
  const Information covariance = geometry::SymmetricSolver{H}.inverse();
  double sum = 0;
  for (const Vec3& p : sample.line_shoe) {
    const LineJacobian J = line_jacobian(fit.icp.placement.grade, p, Vec2::Zero(), H.rows());
    sum += (J * covariance * J.transpose()).trace();
  }
  return std::sqrt(std::max(0.0, sum) / static_cast<double>(sample.line_shoe.size()));
}

/// Of another size: independent pieces of the wall and of the edge, each as uncertain as the next.
Information graded_information(const Sample& sample, const Fit& fit, const GradingLaw& law,
                               double shape_rms_mm) {
  const double piece_per_surfel = square(sample.common.pitch_mm / k_surface_correlation_mm);
  const double sigma_mm = std::max(k_last_sigma_mm, shape_rms_mm);
  Information H = fit.icp.information * (piece_per_surfel / square(sigma_mm));
  H += law.pull(fit.icp.placement.grade).information;
  if (fit.rim_used) {
    const double pairs = fit.icp.rim_overlap_ratio * static_cast<double>(sample.rim.size());
    H += fit.icp.rim_information * (k_rim_pieces / pairs / square(k_rim_sigma_mm));
  }
  if (fit.icp.line_pairs > 0)
    H += fit.icp.line_information *
         (k_line_pieces / static_cast<double>(fit.icp.line_pairs) / square(sigma_mm));
  return H;
}

Information rigid_information(const Belief& belief) {
  Eigen::Matrix<double, k_motion, k_motion> covariance = Eigen::Matrix<double, k_motion, k_motion>::Zero();
  for (const BeliefPart& part : belief)
    covariance += part.weight * (part.covariance + part.mean * part.mean.transpose());
  return covariance.inverse();
}

/// From the information: covariance, the line's own uncertainty, the weakest direction.
void tell_uncertainty(const Sample& sample, const Fit& fit, const GradingLaw& law, Alignment& alignment) {
  const Information H = fit.evidence.belief.empty()
                            ? graded_information(sample, fit, law, alignment.shape_rms_mm)
                            : rigid_information(fit.evidence.belief);
  alignment.information = H;

  // The weakest direction is told of the rigid part only.  About the line's centre, where turning and
  // shifting part.
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : sample.line_shoe) centre += p;
  centre /= static_cast<double>(sample.line_shoe.size());
  const Vec3 pivot = fit.icp.placement.grade.apply(centre, Foot{.place = centre.head<2>().cast<float>()});
  Eigen::Matrix<double, 6, 6> shift = Eigen::Matrix<double, 6, 6>::Identity();
  shift.topRightCorner<3, 3>() =
      geometry::hat(pivot);  // twist about the pivot -> twist about the frame's origin
  const Eigen::Matrix<double, 6, 6> about_pivot = shift.transpose() * H.topLeftCorner<6, 6>() * shift;

  const Vec3 arms = arms_mm(sample.line_shoe, centre);
  Eigen::Matrix<double, 6, 1> unit;
  unit << 1, 1, 1, 1 / arms.x(), 1 / arms.y(), 1 / arms.z();
  const auto [values, axes] = geometry::principal_axes(unit.asDiagonal() * about_pivot * unit.asDiagonal());
  const Eigen::Matrix<double, 6, 1> variances = values.cwiseMax(1e-12).cwiseInverse();
  alignment.weakest = {.sigma_mm = std::sqrt(variances[0]), .words = words_of(axes.col(0))};
  // Rims that move the line may be right or not: half of what they move it by stays in doubt.
  alignment.rim_doubt_mm = fit.rim_shift_mm / 2;
  alignment.line_sigma_mm = std::hypot(line_sigma_mm(sample, fit, H), alignment.rim_doubt_mm);
}

Alignment describe(const FitTask& task, const Fit& fit, const GradingLaw& law) {
  const IcpResult& icp = fit.icp;
  Alignment alignment{.placement = icp.placement,
                      .T_upper_sample = icp.placement.T_target_source * task.sample.T_base_shoe.inverse(),
                      .converged = icp.converged,
                      .iterations = icp.iterations,
                      .overlap_ratio = icp.overlap_ratio,
                      .residual_rms_mm = icp.rms_mm,
                      .shape_rms_mm = fit.shape_rms_mm,
                      .rim_used = fit.rim_used,
                      .same_edge_ratio = fit.evidence.same_edge_ratio,
                      .rim_mm = icp.rim_mm,
                      .belief = fit.evidence.belief};
  alignment.compared.reserve(fit.pairs.size());
  for (const Pair& pair : fit.pairs) {
    alignment.compared.push_back({.point = icp.placement.place(pair.point, pair.foot).cast<float>(),
                                  .difference_mm = static_cast<float>(pair.residual_mm)});
  }
  alignment.upper_overlap_ratio = upper_overlap_ratio(task.sample, task.upper, icp.placement);
  tell_uncertainty(task.sample, fit, law, alignment);
  return alignment;
}

/// Aligned, or what of the common surface itself forbids it.
Verdict judge(const Alignment& alignment, const AlignOptions& options) {
  const double max_shape_rms_mm = options.grade ? k_max_graded_rms_mm : k_max_shape_rms_mm;
  const bool upper_is_on_sample = alignment.upper_overlap_ratio >= k_min_upper_overlap_ratio;
  if (alignment.overlap_ratio < k_hopeless_overlap_ratio && upper_is_on_sample)
    return Verdict::TooLittleOverlap;
  if (alignment.shape_rms_mm >= max_shape_rms_mm ||
      (alignment.overlap_ratio < k_min_overlap_ratio && !upper_is_on_sample)) {
    return Verdict::OtherModel;
  }
  if (alignment.overlap_ratio < k_min_overlap_ratio) return Verdict::TooLittleOverlap;
  if (alignment.weakest.sigma_mm > k_max_direction_sigma_mm) return Verdict::DirectionNotFixed;
  if (!alignment.converged) return Verdict::NotConverged;
  return Verdict::Aligned;
}

/// The best of the two best starts, refined.
Alignment best_alignment(const FitTask& task, const std::vector<IcpResult>& coarse,
                         const AlignOptions& options) {
  constexpr std::size_t k_refined = 2;
  constexpr double k_hopeless_cost_ratio =
      10;  // the right start is at most a few times worse than another at the coarse pitch
  const auto hopeless = std::find_if(coarse.begin(), coarse.end(), [&](const IcpResult& fit) {
    return fit.cost_mm2 > k_hopeless_cost_ratio * coarse.front().cost_mm2;
  });
  std::vector<Fit> fits(std::min(k_refined, static_cast<std::size_t>(hopeless - coarse.begin())));
  tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t i) {
    const Placement& start = coarse[i].placement;
    fits[i] = options.grade ? fit_graded(task, start, options.law) : fit_rigid(task, start);
  });
  std::sort(fits.begin(), fits.end(),
            [](const Fit& a, const Fit& b) { return a.icp.cost_mm2 < b.icp.cost_mm2; });
  if (!options.grade) weigh(task, fits.front());
  Alignment alignment = describe(task, fits.front(), options.law);
  if (fits.size() > 1 && fits[1].icp.cost_mm2 > 0) {
    alignment.runner_up_ratio = fits[0].icp.cost_mm2 / fits[1].icp.cost_mm2;
  }
  alignment.verdict = judge(alignment, options);
  return alignment;
}

template <class... Arguments>
std::string sentence(const char* pattern, Arguments... arguments) {
  return FixedText<400>::format(pattern, arguments...).c_str();
}

}  // namespace

Alignment::OnLine Alignment::as_used(const OnLine& on_sample) const {
  const auto turned = [&](const Vec3& v) { return mirrored ? Vec3{v.x(), -v.y(), v.z()} : v; };
  return {.point = turned(on_sample.point), .normal = turned(on_sample.normal)};
}

Alignment::OnLine Alignment::placed(const OnLine& on_sample) const {
  const auto [point, normal] = as_used(on_sample);
  const Foot foot{.place = point.head<2>().cast<float>(),
                  .outward = normal.head<2>().normalized().cast<float>()};
  return {.point = placement.place(point, foot), .normal = placement.place_normal(normal)};
}

Alignment align_samples(const Sample& sample, const Sample& other, const AlignOptions& options) {
  const std::optional<Sample> turned = options.mirror ? std::optional{mirrored(sample)} : std::nullopt;
  const Sample& used = turned ? *turned : sample;
  const Upper upper = upper_of(other);
  const NearestTable table{upper.surfels, static_cast<float>(k_fine_reach_mm)};
  const LineBeside line{other.line_shoe};
  const FitTask task{.sample = used, .upper = upper, .upper_table = table, .upper_line = &line};
  Alignment alignment = best_alignment(task, coarse_fits(used, upper, options), options);
  alignment.mirrored = options.mirror;
  return alignment;
}

Alignment align(const Sample& sample, const Upper& upper, const AlignOptions& options) {
  const std::optional<Sample> turned = options.mirror ? std::optional{mirrored(sample)} : std::nullopt;
  const Sample& used = turned ? *turned : sample;
  std::optional<NearestTable> table;
  std::vector<IcpResult> coarse;
  tbb::parallel_invoke([&] { coarse = coarse_fits(used, upper, options); },
                       [&] { table.emplace(upper.surfels, static_cast<float>(k_fine_reach_mm)); });
  const FitTask task{.sample = used, .upper = upper, .upper_table = *table};
  Alignment alignment = best_alignment(task, coarse, options);
  alignment.mirrored = options.mirror;
  if (!options.grade && alignment.verdict != Verdict::OtherModel) {
    alignment.next_step =
        advice_for_upper(used, upper, alignment.placement.T_target_source, alignment.rim_used);
  }
  switch (alignment.verdict) {
    case Verdict::Aligned:
      break;
    case Verdict::TooLittleOverlap:
      alignment.reason = sentence(
          "too little overlap: the upper's scan shows %.0f %% of the surface above the sample's line (at "
          "least %.0f %%)",
          100 * alignment.overlap_ratio, 100 * k_min_overlap_ratio);
      break;
    case Verdict::DirectionNotFixed:
      alignment.reason =
          sentence("the common surface does not fix the upper %s: it may be off by %.1f mm (at most %.1f mm)",
                   alignment.weakest.words.c_str(), alignment.weakest.sigma_mm, k_max_direction_sigma_mm);
      if (!alignment.next_step.empty()) alignment.reason += "; " + alignment.next_step;
      break;
    case Verdict::NotConverged:
      alignment.reason = sentence("the alignment did not settle within %d steps", alignment.iterations);
      break;
    default:
      alignment.reason = sentence(
          "the upper is another model: its surface differs from the sample's by %.2f mm RMS (at most %.2f "
          "mm) over %.0f %% of it",
          alignment.shape_rms_mm, k_max_shape_rms_mm, 100 * alignment.overlap_ratio);
  }
  return alignment;
}

}  // namespace biteline::transfer
