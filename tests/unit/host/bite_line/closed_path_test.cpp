// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <random>

#include "host/bite_line/place/closed_path.hpp"

namespace biteline::bite_line {
namespace {

constexpr double k_step_cost = 0.02;

/// Best closed path by trying every start row on its own: the oracle.
double brute_force(const std::vector<float>& cost, int rows, int cols, int reach) {
  double best = std::numeric_limits<double>::max();
  for (int start = 0; start < rows; ++start) {
    std::vector<double> total(static_cast<std::size_t>(rows), 1e18);
    total[static_cast<std::size_t>(start)] = static_cast<double>(cost[static_cast<std::size_t>(start)]);
    for (int c = 1; c <= cols; ++c) {
      std::vector<double> next(static_cast<std::size_t>(rows), 1e18);
      for (int r = 0; r < rows; ++r) {
        for (int d = -reach; d <= reach; ++d) {
          if (r + d < 0 || r + d >= rows) continue;
          const double own =
              c == cols ? 0.0 : static_cast<double>(cost[static_cast<std::size_t>(c * rows + r)]);
          next[static_cast<std::size_t>(r)] =
              std::min(next[static_cast<std::size_t>(r)],
                       total[static_cast<std::size_t>(r + d)] + k_step_cost * d * d + own);
        }
      }
      total = next;
    }
    best = std::min(best, total[static_cast<std::size_t>(start)]);
  }
  return best;
}

}  // namespace

TEST_GROUP(ClosedPath){};

TEST(ClosedPath, IsAsCheapAsTheBestOfAllStarts) {
  std::mt19937 random{3};
  std::uniform_real_distribution<float> any{0.0F, 1.0F};
  for (int round = 0; round < 30; ++round) {
    const int rows = 12;
    const int cols = 40;
    std::vector<float> cost(static_cast<std::size_t>(rows * cols));
    for (float& c : cost) c = any(random);
    const ClosedPath sut =
        shortest_closed_path(cost, rows, cols, {.max_step_rows = 2, .step_cost = k_step_cost});
    // Twice round, free at both ends, finds the best crossing of the seam but for near ties.
    DOUBLES_EQUAL(brute_force(cost, rows, cols, 2), sut.cost, 0.02 * sut.cost);
    LONGS_EQUAL(cols, sut.row.size());
    for (int c = 0; c < cols; ++c) {
      CHECK(std::abs(sut.row[static_cast<std::size_t>(c)] -
                     sut.row[static_cast<std::size_t>((c + 1) % cols)]) <= 2);
    }
  }
}

TEST(ClosedPath, FollowsAGrooveAcrossTheSeam) {
  const int rows = 30;
  const int cols = 64;
  std::vector<float> cost(static_cast<std::size_t>(rows * cols), 1.0F);
  const auto groove = [&](int c) {
    return 15 + ((c + 10) % cols < cols / 2 ? (c + 10) % cols : cols - (c + 10) % cols) / 4;
  };
  for (int c = 0; c < cols; ++c) cost[static_cast<std::size_t>(c * rows + groove(c))] = 0.0F;
  const ClosedPath sut = shortest_closed_path(cost, rows, cols, {});
  for (int c = 0; c < cols; ++c) LONGS_EQUAL(groove(c), sut.row[static_cast<std::size_t>(c)]);
}

}  // namespace biteline::bite_line
