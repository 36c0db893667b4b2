// SPDX-License-Identifier: MIT
#include "host/second_look/told_along.hpp"

#include <CppUTest/TestHarness.h>

#include "host/second_look/bands.hpp"

namespace biteline::second_look {
namespace {

constexpr double k_line_mm = 100;

}  // namespace

/// Rows of 1 mm round a line; each is as sure as it is expected to be.
TEST_GROUP(ToldAlong) {
  std::vector<RowScore> rows{};

  void setup() override {
    fill(4 * k_told);
  }
  void fill(double evidence) {
    rows.clear();
    for (double mm = 0; mm < k_line_mm; ++mm)
      rows.push_back({.along_mm = mm, .likelihood = evidence, .evidence = evidence});
  }
  void set(std::size_t first, std::size_t end, double likelihood) {
    for (std::size_t i = first; i < end; ++i) rows[i].likelihood = likelihood;
  }
  void expect(std::size_t first, std::size_t end, Told told) {
    const std::vector<Told> found = told_along(rows, k_line_mm);
    for (std::size_t i = 0; i < rows.size(); ++i)
      LONGS_EQUAL(static_cast<int>(i >= first && i < end ? told : Told::Worked), static_cast<int>(found[i]));
  }
};

TEST(ToldAlong, AGapIsTold) {
  set(20, 23, -4 * k_told);
  expect(20, 23, Told::Missing);
}

TEST(ToldAlong, AGapOverTheFirstRowIsTold) {
  set(98, 100, -4 * k_told);
  set(0, 2, -4 * k_told);
  const std::vector<Told> found = told_along(rows, k_line_mm);
  for (const std::size_t i : {98U, 99U, 0U, 1U}) CHECK(found[i] == Told::Missing);
  CHECK(found[97] == Told::Worked && found[2] == Told::Worked);
}

TEST(ToldAlong, RowsThatAreUnsureAloneAreSureTogether) {
  fill(k_told);  // two of them tell whether 2 mm are a gap
  expect(0, 0, Told::Worked);
  set(40, 42, -k_told);
  expect(40, 42, Told::Missing);
}

TEST(ToldAlong, WhereTwoRowsCouldNotTellAGapItIsUnclear) {
  fill(0.9 * k_told);
  expect(0, rows.size(), Told::Unclear);
}

TEST(ToldAlong, NothingIsMissingWhereNothingCouldBeTold) {
  fill(0.5 * k_told);  // however much all of them say together
  set(0, rows.size(), -0.5 * k_told);
  expect(0, rows.size(), Told::Unclear);
}

TEST(ToldAlong, OneRowThatLiesOffIsNoGap) {
  set(50, 51, -k_told);
  expect(0, 0, Told::Worked);
}

TEST(ToldAlong, AGapIsNotToldByOneOfItsRowsAlone) {
  set(50, 51, -2 * k_told);
  set(51, 52, -0.5 * k_told);
  expect(50, 52, Told::Unclear);
}

TEST(ToldAlong, OneRowTellsAGapWhereRowsStandFarApart) {
  rows.clear();
  for (double mm = 0; mm < k_line_mm; mm += 2)
    rows.push_back({.along_mm = mm, .likelihood = 4 * k_told, .evidence = 4 * k_told});
  set(20, 21, -4 * k_told);
  expect(20, 21, Told::Missing);
}

TEST(ToldAlong, TwoRowsThatSayNeitherAreUnclear) {
  set(60, 62, 0);
  expect(60, 62, Told::Unclear);
}

TEST(ToldAlong, AnUnsureRowInAGapDoesNotCutIt) {
  set(30, 36, -4 * k_told);
  set(33, 34, 0.5 * k_told);
  expect(30, 36, Told::Missing);
}

TEST(ToldAlong, RowsThatArePassedHideNothing) {
  rows[33] = {.along_mm = 33, .counts = RowScore::Counts::Passed};
  set(32, 33, -4 * k_told);
  set(34, 35, -4 * k_told);
  const std::vector<Told> found = told_along(rows, k_line_mm);
  CHECK(found[32] == Told::Missing && found[34] == Told::Missing);
  CHECK(found[31] == Told::Worked && found[35] == Told::Worked);
}

TEST(ToldAlong, NothingIsToldAcrossWhatIsNotSeen) {
  for (std::size_t i = 70; i < 75; ++i)
    rows[i] = {.along_mm = static_cast<double>(i), .counts = RowScore::Counts::No};
  expect(70, 75, Told::Unclear);
}

TEST(ToldAlong, NoRowsAreNothing) {
  CHECK(told_along({}, k_line_mm).empty());
}

}  // namespace biteline::second_look
