// SPDX-License-Identifier: MIT
#include "host/transfer/align/grade.hpp"

namespace biteline::transfer {

namespace {

/// How far one parameter is off what the law makes of the length.
struct Off {
  int parameter;
  double share, slope;  ///< mean share of the law; d value / d parameter
  double off, variance;
};

// off = value - mean * change.  A law that bends leaves the line between its two samples by a parabola.
std::array<Off, 5> offs(const GradingLaw& law, const Grade& grade) {
  const double change = grade.length - 1;
  const auto of = [&](int parameter, const GradingLaw::Share& share, double value, double slope,
                      double least_sigma) {
    const double straight = share.sigma * change, bent = share.bend * change * (change - law.taught_at);
    return Off{.parameter = parameter,
               .share = share.mean,
               .slope = slope,
               .off = value - share.mean * change,
               .variance = least_sigma * least_sigma + straight * straight + bent * bent};
  };
  const auto factor = [&](int parameter, const GradingLaw::Share& share, double value) {
    return of(parameter, share, value - 1, value, GradingLaw::k_factor_sigma);
  };
  return {factor(k_width, law.width, grade.width),
          factor(k_section_along, law.section_along, grade.section_along),
          factor(k_section_across, law.section_across, grade.section_across),
          factor(k_height, law.height, grade.height),
          of(k_offset, law.offset_mm, grade.offset_mm, 1, GradingLaw::k_offset_sigma_mm)};
}

}  // namespace

GradingLaw::Pull GradingLaw::pull(const Grade& grade) const {
  Pull pull{.information = Information::Zero(k_most_parameters, k_most_parameters),
            .gradient = ParameterStep::Zero(k_most_parameters)};
  for (const Off& one : offs(*this, grade)) {
    ParameterStep J = ParameterStep::Zero(k_most_parameters);
    J[one.parameter] = one.slope;
    // d change / d parameter of the length = length
    J[k_length] = -one.share * grade.length;
    pull.information += J * J.transpose() / one.variance;
    pull.gradient -= J * (one.off / one.variance);
  }
  return pull;
}

double GradingLaw::misfit(const Grade& grade) const {
  double sum = 0;
  for (const Off& one : offs(*this, grade)) sum += one.off * one.off / one.variance;
  return sum;
}

Grade GradingLaw::at_length(double length) const {
  const double change = length - 1;
  return {.length = length,
          .width = 1 + width.mean * change,
          .section_along = 1 + section_along.mean * change,
          .section_across = 1 + section_across.mean * change,
          .height = 1 + height.mean * change,
          .offset_mm = offset_mm.mean * change};
}

GradingLaw usual_law() {
  // Ball girth takes some 5 mm of a size's 6.7 mm in length, which is 0.8 of its relative change.  Heights
  // and sections grow less, or stay.
  return {.width = {.mean = 0.8, .sigma = 0.25},
          .section_along = {.mean = 0.6, .sigma = 0.3},
          .section_across = {.mean = 0.6, .sigma = 0.3},
          .height = {.mean = 0.5, .sigma = 0.25},
          .offset_mm = {.mean = 0, .sigma = 5}};
}

}  // namespace biteline::transfer
