// SPDX-License-Identifier: MIT
#include "host/transfer/align/grade.hpp"

namespace biteline::transfer {

GradingLaw::Pull GradingLaw::pull(const Grade& grade) const {
  Pull pull{.information = Information::Zero(k_most_parameters, k_most_parameters),
            .gradient = ParameterStep::Zero(k_most_parameters)};
  const double change = grade.length - 1;
  // off = value - mean * change; d value / d parameter = slope, d change / d parameter of the length = length
  const auto add = [&](int parameter, const Share& share, double value, double slope, double least_sigma) {
    const double off = value - share.mean * change;
    const double variance = least_sigma * least_sigma + share.sigma * share.sigma * change * change;
    ParameterStep J = ParameterStep::Zero(k_most_parameters);
    J[parameter] = slope;
    J[k_length] = -share.mean * grade.length;
    pull.information += J * J.transpose() / variance;
    pull.gradient -= J * (off / variance);
  };
  const auto factor = [&](int parameter, const Share& share, double value) {
    add(parameter, share, value - 1, value, k_factor_sigma);
  };
  factor(k_width, width, grade.width);
  factor(k_section_along, section_along, grade.section_along);
  factor(k_section_across, section_across, grade.section_across);
  factor(k_height, height, grade.height);
  add(k_offset, offset_mm, grade.offset_mm, 1, k_offset_sigma_mm);
  return pull;
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
