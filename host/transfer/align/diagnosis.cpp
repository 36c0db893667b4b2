// SPDX-License-Identifier: MIT
#include "host/transfer/align/diagnosis.hpp"

#include <cmath>

#include "common/core/fixed_text.hpp"

namespace biteline::transfer {
namespace {

constexpr double k_max_size_change = 0.3;
// The next half size is 4 mm longer; less is a dent that grading takes up.
constexpr double k_min_length_change = 0.01;

template <class... Arguments>
std::string sentence(const char* pattern, Arguments... arguments) {
  return FixedText<400>::format(pattern, arguments...).c_str();
}

std::string words_of(const Grade& grade) {
  return sentence("%.3f of the sample's length, %.3f of its width, %.3f of its height (grading is off)",
                  grade.length, grade.width, grade.height);
}

bool is_other_size(const Alignment& graded) {
  const Grade& grade = graded.placement.grade;
  return graded.accepted() && grade.largest_change() < k_max_size_change &&
         std::abs(grade.length - 1) >= k_min_length_change;
}

}  // namespace

Diagnosis diagnose(const Sample& sample, const Upper& upper, const AlignOptions& options,
                   const Alignment& refused) {
  const AlignOptions mirrored{.mirror = !options.mirror, .grade = options.grade};
  const Alignment other_foot = align(sample, upper, mirrored);
  if (other_foot.accepted()) {
    return {Verdict::OtherFoot, sentence("the upper is of the other foot: mirrored, the sample fits to %.2f "
                                         "mm RMS, as it is only to %.2f mm",
                                         other_foot.shape_rms_mm, refused.shape_rms_mm)};
  }
  if (!options.grade) {
    const Alignment graded = align(sample, upper, {.mirror = options.mirror, .grade = true});
    if (is_other_size(graded)) {
      return {Verdict::OtherSize, "the upper is of another size: " + words_of(graded.placement.grade)};
    }
    const Alignment both = align(sample, upper, {.mirror = mirrored.mirror, .grade = true});
    if (is_other_size(both)) {
      return {Verdict::OtherFoot,
              "the upper is of the other foot and of another size: " + words_of(both.placement.grade)};
    }
  }
  const Verdict over = align(sample, turned_over(upper), options).verdict;
  // Turned over its collar, which fixes the height, is not looked for.
  if (over == Verdict::Aligned || over == Verdict::DirectionNotFixed)
    return {Verdict::UpsideDown, "the upper is upside down: turned over, it fits the sample"};
  return {Verdict::OtherModel, refused.reason + ", and neither mirroring nor another size explains it"};
}

}  // namespace biteline::transfer
