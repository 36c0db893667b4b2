// SPDX-License-Identifier: MIT
#include "common/stripe/line_average.hpp"

#include <CppUTest/TestHarness.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace biteline::stripe {
namespace {

constexpr double k_sigma_px = 0.05;
constexpr std::size_t k_columns = 4000, k_reach = 4;

}  // namespace

TEST_GROUP(LineAverage) {
  std::mt19937_64 random{31};
  std::normal_distribution<double> normal;

  struct Result {
    double rms_px{0}, normalised_variance{0}, bias_px{0};
  };

  /// Errors blurred along the columns: those of neighbours correlate as `correlation`, farther ones as its
  /// power of their distance's square.
  Result average(const std::function<double(double)>& row_px, double correlation, std::size_t first,
                 std::size_t end) {
    std::vector<LinePoint> line(k_columns), work(k_columns);
    // A Gaussian of variance v correlates as exp(-distance^2 / (4 v)).
    std::vector<double> white(k_columns + 2 * k_reach);
    for (double& value : white) value = normal(random);
    std::array<double, 2 * k_reach + 1> kernel{};
    double power = 0;
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const double apart = static_cast<double>(k) - static_cast<double>(k_reach);
      kernel[k] = correlation > 0 ? std::pow(correlation, 2 * apart * apart) : (k == k_reach ? 1.0 : 0.0);
      power += kernel[k] * kernel[k];
    }
    for (std::size_t i = 0; i < k_columns; ++i) {
      double error = 0;
      for (std::size_t k = 0; k < kernel.size(); ++k) error += white[i + k] * kernel[k];
      line[i] = {.row_px = static_cast<float>(row_px(static_cast<double>(i)) +
                                              k_sigma_px * error / std::sqrt(power)),
                 .sigma_row_px = static_cast<float>(k_sigma_px),
                 .present = true,
                 .joined = i > 0};
    }
    LineAverage{{}}.rt_average(line, work, static_cast<float>(correlation));
    Result result;
    const auto count = static_cast<double>(end - first);
    for (std::size_t i = first; i < end; ++i) {
      const double off = static_cast<double>(line[i].row_px) - row_px(static_cast<double>(i));
      result.rms_px += off * off / count;
      result.bias_px += off / count;
      result.normalised_variance += std::pow(off / static_cast<double>(line[i].sigma_row_px), 2) / count;
    }
    result.rms_px = std::sqrt(result.rms_px);
    return result;
  }
};

TEST(LineAverage, SmoothSurfaceIsAveragedAndSaysSo) {
  const auto gentle = [](double u) { return 100 + 0.2 * u + 0.0005 * (u - 2000) * (u - 2000); };
  const Result white = average(gentle, 0, 10, k_columns - 10);
  CHECK(white.rms_px < 0.55 * k_sigma_px);  // sqrt of 0.17 where the widest window is taken throughout
  CHECK(white.normalised_variance > 0.8 && white.normalised_variance < 1.35);
  const Result correlated = average(gentle, 0.42, 10, k_columns - 10);
  CHECK(correlated.rms_px < 0.75 * k_sigma_px);
  CHECK(correlated.normalised_variance > 0.8 && correlated.normalised_variance < 1.35);
}

TEST(LineAverage, CreaseKeepsItsShape) {
  // A groove's bottom every 40 columns: the slope turns by four rows per column.
  const auto creased = [](double u) { return 100 + 2 * std::fabs(std::remainder(u, 40.0)); };
  double worst_px = 0;
  for (int turn = 0; turn < 4; ++turn) {
    for (std::size_t at = 400; at <= 440; at += 1) {
      const Result one = average(creased, 0, at, at + 1);
      worst_px = std::max(worst_px, one.rms_px);
    }
  }
  // Of 164 columns none is off by more than single columns would be; a fixed window of 13 would be off by 2
  // px at the crease.
  CHECK(worst_px < 5 * k_sigma_px);
}

TEST(LineAverage, NothingIsTakenAcrossAGap) {
  std::vector<LinePoint> line(40), work(40);
  for (std::size_t i = 0; i < 40; ++i) {
    line[i] = {
        .row_px = i < 20 ? 10.0F : 10.1F, .sigma_row_px = 1.0F, .present = true, .joined = i != 0 && i != 20};
  }
  LineAverage{{}}.rt_average(line, work, 0.42F);
  for (std::size_t i = 0; i < 40; ++i)
    DOUBLES_EQUAL(i < 20 ? 10.0 : 10.1, static_cast<double>(line[i].row_px), 1e-5);
}

TEST(LineAverage, EndsOfAStretchAreLeftAsTheyAre) {
  std::vector<LinePoint> line(30), work(30);
  for (std::size_t i = 0; i < 30; ++i)
    line[i] = {.row_px = static_cast<float>(i % 3), .sigma_row_px = 5, .present = true, .joined = i > 0};
  LineAverage{{}}.rt_average(line, work, 0.42F);
  DOUBLES_EQUAL(0, static_cast<double>(line[0].row_px), 0);
  DOUBLES_EQUAL(5, static_cast<double>(line[0].sigma_row_px), 0);
  CHECK(line[15].sigma_row_px < 5);
}

}  // namespace biteline::stripe
