// SPDX-License-Identifier: MIT
// How sizes of one model differ, and what a factory's law says of it.
#include <CppUTest/TestHarness.h>

#include "host/transfer/align/grade.hpp"

namespace biteline::transfer {

TEST_GROUP(Grading){};

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
    const double above = law.misfit(grade) / 2;
    *factors[i] = before - step;
    const double below = law.misfit(grade) / 2;
    *factors[i] = before;
    DOUBLES_EQUAL((below - above) / (2 * k_step), sut.gradient[k_length + i],
                  1e-3 * (1 + std::abs(sut.gradient[k_length + i])));
  }
}

TEST(Grading, ALawThatBendsIsSureAtItsTwoSamplesAndDoubtsBetweenAndBeyond) {
  GradingLaw law = usual_law();
  law.height = {.mean = 0.5, .sigma = 0, .bend = 1};
  law.taught_at = 0.12;
  const auto sigmas_off = [&](double length) {
    Grade grade = law.at_length(length);
    grade.height += 0.002;
    return std::sqrt(law.misfit(grade));
  };
  // What sizes are rounded to is all that is left at the samples.
  DOUBLES_EQUAL(0.002 / GradingLaw::k_factor_sigma, sigmas_off(1), 1e-9);
  DOUBLES_EQUAL(0.002 / GradingLaw::k_factor_sigma, sigmas_off(1.12), 1e-9);
  // The parabola half way: 0.06 times 0.06.
  DOUBLES_EQUAL(0.002 / std::hypot(GradingLaw::k_factor_sigma, 0.0036), sigmas_off(1.06), 1e-9);
  CHECK(sigmas_off(1.15) < sigmas_off(1.12));
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
