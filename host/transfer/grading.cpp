// SPDX-License-Identifier: MIT
#include "host/transfer/grading.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/fixed_text.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::transfer {
namespace {

// The next half size is 1.2 % longer.
constexpr double k_least_change = 0.01;
// Laws are lines over the sizes in the main.  One that bends takes a fifth more or less a tenth farther on.
constexpr double k_bend = 2;
constexpr double k_least_share = 0.3;

}  // namespace

Result<TaughtGrading> teach_grading(const Sample& sample, const Sample& other, bool mirror) {
  const Alignment found = align_samples(sample, other, {.mirror = mirror, .grade = true});
  const Grade& grade = found.placement.grade;
  const double change = grade.length - 1;
  if (!found.accepted())
    return fail(
        Errc::Refused,
        "the samples are no two sizes of one model and foot: %.2f mm RMS apart over %.0f %%; take two of one",
        found.shape_rms_mm, 100 * found.overlap_ratio);
  if (std::abs(change) < k_least_change)
    return fail(Errc::Refused,
                "the samples are of nearly one size: %.1f %% apart in length (at least %.0f %%); take one "
                "that is some sizes away",
                std::abs(100 * change), 100 * k_least_change);
  const Information covariance = geometry::SymmetricSolver{found.information}.inverse();
  const auto share = [&](int parameter, double value, double least) {
    const double mean = value / change;
    const double measured = std::sqrt(std::max(0.0, covariance(parameter, parameter))) / std::abs(change);
    return GradingLaw::Share{
        .mean = mean, .sigma = measured, .bend = k_bend * std::max(std::abs(mean), least)};
  };
  return TaughtGrading{
      .law = {.width = share(k_width, grade.width - 1, k_least_share),
              .section_along = share(k_section_along, grade.section_along - 1, k_least_share),
              .section_across = share(k_section_across, grade.section_across - 1, k_least_share),
              .height = share(k_height, grade.height - 1, k_least_share),
              .offset_mm = share(k_offset, grade.offset_mm, 1),
              .taught_at = change},
      .between = grade,
      .shape_rms_mm = found.shape_rms_mm};
}

GradingLaw law_from(const GradingLaw& law, const Grade& between) {
  const auto from = [&](const GradingLaw::Share& share, double factor) {
    const double times = between.length / factor;
    return GradingLaw::Share{
        .mean = share.mean * times, .sigma = share.sigma * times, .bend = share.bend * times};
  };
  return {.width = from(law.width, between.width),
          .section_along = from(law.section_along, between.section_along),
          .section_across = from(law.section_across, between.section_across),
          .height = from(law.height, between.height),
          .offset_mm = from(law.offset_mm, 1),
          .taught_at = 1 / between.length - 1};
}

Result<Transfer> transfer_by_two(const std::array<const ReadySample*, 2>& samples,
                                 const cloud::PointCloud& upper, TransferOptions options) {
  const auto& [first, second] = samples;
  for (const ReadySample* sample : samples)
    if (!sample->prepared()) return tl::unexpected<Error>{sample->prepared().error()};
  BITELINE_ASSIGN(const TaughtGrading taught, teach_grading(*first->prepared(), *second->prepared()));
  options.align.grade = true;
  options.align.law = taught.law;
  Transfer by_first = transfer_line(*first, upper, options);
  const double length = by_first.alignment.placement.grade.length;
  const bool first_is_nearer =
      std::abs(std::log(length)) <= std::abs(std::log(length / taught.between.length));
  // One that found no place on the first sample may find one on the other.
  if (by_first.found && first_is_nearer) return by_first;
  options.align.law = law_from(taught.law, taught.between);
  Transfer by_second = transfer_line(*second, upper, options);
  return by_second.found || !by_first.found ? std::move(by_second) : std::move(by_first);
}

}  // namespace biteline::transfer
