// SPDX-License-Identifier: MIT
// How sizes of one model differ, and what a factory's law says of it.
#include <CppUTest/TestHarness.h>

#include "host/transfer/align/grade.hpp"

namespace biteline::transfer {

TEST_GROUP(Grading){
    static double off_law(const GradingLaw& law, const Grade& grade){const double change = grade.length - 1;
double sum = 0;
const auto add = [&](const GradingLaw::Share& share, double value, double least) {
  const double off = value - share.mean * change;
  sum += 0.5 * off * off / (least * least + share.sigma * share.sigma * change * change);
};
add(law.width, grade.width - 1, GradingLaw::k_factor_sigma);
add(law.section_along, grade.section_along - 1, GradingLaw::k_factor_sigma);
add(law.section_across, grade.section_across - 1, GradingLaw::k_factor_sigma);
add(law.height, grade.height - 1, GradingLaw::k_factor_sigma);
add(law.offset_mm, grade.offset_mm, GradingLaw::k_offset_sigma_mm);
return sum;
}  // namespace biteline::transfer
}
;

TEST(Grading, AGradeByTheLawIsNotPulled) {
  const GradingLaw law = usual_law();
  const GradingLaw::Pull sut = law.pull(law.at_length(1.08));
  DOUBLES_EQUAL(0, sut.gradient.norm(), 1e-9);
}

TEST(Grading, EachFactorIsPulledTowardsTheLaw) {
  // Where the sigmas do not change with the length: the gradient of what the law takes the grade for.
  GradingLaw law = usual_law();
  for (GradingLaw::Share* share :
       {&law.width, &law.section_along, &law.section_across, &law.height, &law.offset_mm})
    share->sigma = 0;
  Grade grade = law.at_length(1.05);
  grade.width += 0.004;
  grade.height -= 0.003;
  grade.offset_mm += 0.2;
  const GradingLaw::Pull sut = law.pull(grade);
  double* const factors[] = {&grade.length,         &grade.width,  &grade.section_along,
                             &grade.section_across, &grade.height, &grade.offset_mm};
  constexpr double k_step = 1e-7;
  for (int i = 0; i < 6; ++i) {
    const double before = *factors[i];
    const double step = k_length + i == k_offset ? k_step : k_step * before;
    *factors[i] = before + step;
    const double above = off_law(law, grade);
    *factors[i] = before - step;
    const double below = off_law(law, grade);
    *factors[i] = before;
    DOUBLES_EQUAL((below - above) / (2 * k_step), sut.gradient[k_length + i],
                  1e-3 * (1 + std::abs(sut.gradient[k_length + i])));
  }
}

TEST(Grading, ASectionsFactorTurnsItsNormals) {
  // A wall of 45 degrees at the shoe's side: twice as far in and out makes it lie flatter.
  const Grade across{.section_across = 2};
  const Vec3 sut = across.apply_normal(Vec3{0, 1, 1}.normalized());
  DOUBLES_EQUAL(2, sut.z() / sut.y(), 1e-9);
  const Vec3 along = across.apply_normal(Vec3{1, 0, 1}.normalized());
  DOUBLES_EQUAL(1, along.z() / along.x(), 1e-9);
}

}  // namespace biteline::transfer
