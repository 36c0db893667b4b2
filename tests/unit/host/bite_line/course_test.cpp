// SPDX-License-Identifier: MIT
// The best closed course and its rivals, on small made fields of cost.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <random>
#include <vector>

#include "host/bite_line/layers/course.hpp"

namespace biteline::bite_line {
namespace {

constexpr int k_rows = 80;
constexpr int k_cols = 200;

struct Field {
  std::vector<float> cost = std::vector<float>(static_cast<std::size_t>(k_rows) * k_cols, 1.0F);
  float& at(int row, int col) {
    return cost[static_cast<std::size_t>(col % k_cols) * k_rows + static_cast<std::size_t>(row)];
  }
  void line(int row, int first, int end, float value) {
    for (int col = first; col < end; ++col) at(row, col) = value;
  }
};

Course found(const Field& field) {
  const Ways ways{field.cost, k_rows, k_cols, CourseConfig{}.path};
  return find_course(ways, ways.best(), {});
}

}  // namespace

TEST_GROUP(Course){};

TEST(Course, KeepsItsLayerWhereALongOneBelowIsStrongerForAWhile) {
  // A bite line of 0.3, and over a third of the way round a deep groove of 0.15 some 7 mm below it: to change
  // over and back costs two climbs without a crease, 28 rows at 4 a column each.
  Field field;
  field.line(50, 0, k_cols, 0.3F);
  field.line(22, 60, 130, 0.15F);
  const Course sut = found(field);
  LONGS_EQUAL(50, *std::max_element(sut.row.begin(), sut.row.end()));
  LONGS_EQUAL(50, *std::min_element(sut.row.begin(), sut.row.end()));
  const auto below = std::find_if(sut.branches.begin(), sut.branches.end(), [](const Branch& branch) {
    return !branch.above && branch.row.size() > 60;
  });
  CHECK(below != sut.branches.end());
  // 70 columns that are better by 0.15, less two climbs that cost 0.7 a column more and their steps.
  CHECK(below->worse > 0);
  CHECK(below->worse < 10);
}

TEST(Course, ALayerAllTheWayRoundIsARivalThatNeverComesBack) {
  Field field;
  field.line(50, 0, k_cols, 0.1F);
  field.line(20, 0, k_cols, 0.2F);
  const Course sut = found(field);
  CHECK_FALSE(sut.branches.empty());
  const auto whole = std::find_if(sut.branches.begin(), sut.branches.end(),
                                  [](const Branch& branch) { return branch.over_cols >= k_cols; });
  CHECK(whole != sut.branches.end());
  CHECK_FALSE(whole->above);
  LONGS_EQUAL(k_cols, whole->row.size());
  DOUBLES_EQUAL(0.1, whole->worse / whole->over_cols, 0.02);
}

TEST(Course, ForkIsFoundWithItsEndsAndItsPrice) {
  // Two ways over columns 80 to 119 that part and meet smoothly.
  Field field;
  field.line(40, 0, k_cols, 0.1F);
  const auto lift = [](int col) { return std::min({14, (col - 80) * 2, (120 - col) * 2}); };
  for (int col = 80; col <= 120; ++col) field.at(40 + lift(col), col) = 0.12F;
  const Course sut = found(field);
  const auto fork = std::find_if(sut.branches.begin(), sut.branches.end(),
                                 [](const Branch& branch) { return branch.above && branch.row.size() > 30; });
  CHECK(fork != sut.branches.end());
  CHECK(fork->first_col >= 78 && fork->first_col <= 84);
  // 39 columns at 0.02 and 14 steps of two rows.
  DOUBLES_EQUAL(39 * 0.02 + 14 * 0.03 * 4, fork->worse, 0.2);
}

TEST(Course, IsTheSameWhereverTheSeamIs) {
  std::mt19937 random{5};
  std::uniform_real_distribution<float> uniform{0.2F, 1.0F};
  Field field;
  for (float& cost : field.cost) cost = uniform(random);
  for (int col = 0; col < k_cols; ++col) field.at(40 + (col < 100 ? col / 10 : (200 - col) / 10), col) = 0.0F;
  const Course sut = found(field);
  for (const int shift : {37, 120}) {
    Field turned;
    for (int col = 0; col < k_cols; ++col) {
      for (int row = 0; row < k_rows; ++row) turned.at(row, col + shift) = field.at(row, col);
    }
    const Course other = found(turned);
    DOUBLES_EQUAL(sut.cost, other.cost, 1e-3);
    for (int col = 0; col < k_cols; ++col)
      LONGS_EQUAL(sut.row[static_cast<std::size_t>(col)],
                  other.row[static_cast<std::size_t>((col + shift) % k_cols)]);
  }
}

TEST(Course, TheWaysKnowTheBestClosedPath) {
  std::mt19937 random{6};
  std::uniform_real_distribution<float> uniform{0.0F, 1.0F};
  Field field;
  for (float& cost : field.cost) cost = uniform(random);
  const ClosedPath expected = shortest_closed_path(field.cost, k_rows, k_cols, CourseConfig{}.path);
  const ClosedPath sut = Ways{field.cost, k_rows, k_cols, CourseConfig{}.path}.best();
  CHECK(expected.row == sut.row);
  DOUBLES_EQUAL(expected.cost, sut.cost, 0.0);
}

}  // namespace biteline::bite_line
