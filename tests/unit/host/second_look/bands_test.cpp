// SPDX-License-Identifier: MIT
#include "host/second_look/bands.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <vector>

namespace biteline::second_look {
namespace {

/// So many cells, `inside` where worked and `outside` elsewhere.
std::vector<double> step(std::size_t cells, std::size_t first, std::size_t end,
                         std::array<double, 2> values) {
  std::vector<double> likelihood(cells, values[0]);
  for (std::size_t j = first; j < end; ++j) likelihood[j] = values[1];
  return likelihood;
}

}  // namespace

TEST_GROUP(WorkedPieces){};

TEST(WorkedPieces, FindsTheWorkedCells) {
  const auto pieces = worked_pieces(step(100, 30, 70, {-1, 1}));
  LONGS_EQUAL(1, pieces.size());
  LONGS_EQUAL(30, pieces[0].first);
  LONGS_EQUAL(70, pieces[0].end);
  DOUBLES_EQUAL(40, pieces[0].told, 1e-12);
}

TEST(WorkedPieces, TellsNothingOfTooLittle) {
  LONGS_EQUAL(0, worked_pieces(step(100, 30, 45, {-1, 1})).size());
}

TEST(WorkedPieces, CutsAtAHoleThatIsToldAndNotAtASmallerOne) {
  std::vector<double> likelihood = step(100, 10, 90, {-1, 1});
  for (std::size_t j = 50; j < 60; ++j) likelihood[j] = -1;
  LONGS_EQUAL(1, worked_pieces(likelihood).size());
  for (std::size_t j = 50; j < 70; ++j) likelihood[j] = -1;
  const auto pieces = worked_pieces(likelihood);
  LONGS_EQUAL(2, pieces.size());
  LONGS_EQUAL(10, pieces[0].first);
  LONGS_EQUAL(50, pieces[0].end);
  LONGS_EQUAL(70, pieces[1].first);
}

TEST_GROUP(EndOf){};

TEST(EndOf, IsWhereTheLikelihoodTurns) {
  const std::vector<double> likelihood = step(100, 30, 70, {-3, 3});
  DOUBLES_EQUAL(30, end_of(likelihood, {.middle = 50, .limit = 0}).cell, 0.01);
  DOUBLES_EQUAL(70, end_of(likelihood, {.middle = 50, .limit = 100}).cell, 0.01);
}

TEST(EndOf, IsUnsureWhereCellsAreHidden) {
  std::vector<double> likelihood = step(100, 30, 70, {-3, 3});
  for (std::size_t j = 65; j < 85; ++j) likelihood[j] = 0;
  const End end = end_of(likelihood, {.middle = 50, .limit = 100});
  DOUBLES_EQUAL(75, end.cell, 0.5);
  DOUBLES_EQUAL(6, end.sigma_cells, 0.5);  // evenly over 21 places: sqrt((21^2 - 1) / 12)
}

TEST(EndOf, ManyNatsBeyondDoNotUnderflow) {
  const End end = end_of(step(400, 100, 300, {-1e5, 1e5}), {.middle = 200, .limit = 400});
  DOUBLES_EQUAL(300, end.cell, 1e-9);
}

}  // namespace biteline::second_look
