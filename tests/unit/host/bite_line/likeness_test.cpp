// SPDX-License-Identifier: MIT
// The likeness of a column in vector lanes against its formula, row by row.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "host/bite_line/layers/likeness.hpp"

namespace biteline::bite_line {
namespace {

constexpr LikenessConfig k_config{.row_mm = 0.25,
                                  .crease_rad = 0.12,
                                  .crest = 6,
                                  .one_surface_ratio = 0.45,
                                  .flank_soft_rad = 0.05,
                                  .rad_per_step_mm = 0.35,
                                  .near_from = 4,
                                  .near_to = 12,
                                  .flank_from = 8,
                                  .flank_to = 24};
constexpr double k_noise_rad = 0.026;

struct Column {
  std::vector<float> turn_rad, o_mm;
  std::vector<std::uint8_t> seen;
};

/// A wall that bulges, turns inwards at one place and stands out at another, with holes.
Column drawn(int rows) {
  std::mt19937 random{3};
  std::uniform_real_distribution<float> uniform{0.0F, 1.0F};
  Column column;
  for (int row = 0; row < rows; ++row) {
    const float step = row < rows / 3 ? 3.0F : 0.0F;
    const float lid = row > rows / 2 ? 2.0F : 0.0F;
    column.o_mm.push_back(step + lid + std::sin(0.05F * static_cast<float>(row)) + 0.02F * uniform(random));
    column.turn_rad.push_back(0.3F * uniform(random));
    column.seen.push_back(row % 37 > 5 ? 1 : 0);
  }
  return column;
}

struct Line {
  double at_mm, slope;
};
std::optional<Line> line(const Column& column, int row, int low, int high) {
  double n = 0, z = 0, zz = 0, o = 0, zo = 0;
  for (int r = std::max(0, row + low); r <= std::min(static_cast<int>(column.o_mm.size()) - 1, row + high);
       ++r) {
    const auto at = static_cast<std::size_t>(r);
    if (column.seen[at] == 0) continue;
    const double z_mm = (r - row) * k_config.row_mm;
    const auto o_mm = static_cast<double>(column.o_mm[at]);
    n += 1, z += z_mm, zz += z_mm * z_mm, o += o_mm, zo += z_mm * o_mm;
  }
  if (n < 0.6 * (high - low + 1)) return std::nullopt;
  const double slope = (n * zo - z * o) / (n * zz - z * z);
  return Line{(o - slope * z) / n, slope};
}

double expected(const Column& column, int row) {
  const auto turn = static_cast<double>(column.turn_rad[static_cast<std::size_t>(row)]);
  if (turn <= k_noise_rad) return 0;
  double most = turn;
  for (int r = std::max(0, row - k_config.crest);
       r <= std::min(static_cast<int>(column.turn_rad.size()) - 1, row + k_config.crest); ++r)
    most = std::max(most, static_cast<double>(column.turn_rad[static_cast<std::size_t>(r)]));
  double two = 0.6;
  const auto above = line(column, row, k_config.flank_from, k_config.flank_to);
  const auto below = line(column, row, -k_config.flank_to, -k_config.flank_from);
  if (above && below) {
    const double between = std::atan(above->slope) - std::atan(below->slope) +
                           k_config.rad_per_step_mm * std::max(below->at_mm - above->at_mm, 0.0);
    two = 1 / (1 + std::exp(-between / k_config.flank_soft_rad));
  }
  double not_overhung = 1;
  const auto near_above = line(column, row, k_config.near_from, k_config.near_to);
  const auto near_below = line(column, row, -k_config.near_to, -k_config.near_from);
  if (near_above && near_below)
    not_overhung = 1 / (1 + std::exp((near_above->at_mm - near_below->at_mm - 0.5) / 0.1));
  return turn / most * (1 - std::exp(-(turn - k_noise_rad) / k_config.crease_rad)) *
         (k_config.one_surface_ratio + (1 - k_config.one_surface_ratio) * two) * not_overhung;
}

}  // namespace

TEST_GROUP(ColumnLikeness){};

TEST(ColumnLikeness, IsItsFormulaRowByRow) {
  for (const int rows : {16, 87, 360}) {
    const Column column = drawn(rows);
    ColumnLikeness sut{k_config, static_cast<std::size_t>(rows)};
    std::ranges::copy(column.turn_rad, sut.turn_rad().begin());
    const auto likeness = sut.of(column.o_mm.data(), column.seen.data(), k_noise_rad);
    LONGS_EQUAL(rows, likeness.size());
    for (int row = 0; row < rows; ++row)
      DOUBLES_EQUAL(expected(column, row), likeness[static_cast<std::size_t>(row)], 1e-6);
  }
}

TEST(ColumnLikeness, ASoleMayEndAtARimCloseBelow) {
  // The upper goes out by 45 degrees over 2 mm and then stands upright.  Below it lies a plate's upright edge
  // of 1.5 mm, and below that all goes in.
  constexpr int k_rows = 120, k_crease = 60;
  Column column;
  for (int row = 0; row < k_rows; ++row) {
    const float up_mm = 0.25F * static_cast<float>(row - k_crease);
    const float out_mm = up_mm > 0 ? std::min(up_mm, 2.0F) : std::min(1.5F * (up_mm + 1.5F), 0.0F);
    column.o_mm.push_back(out_mm);
    column.turn_rad.push_back(row == k_crease ? 0.6F : 0.0F);
    column.seen.push_back(1);
  }
  const auto likeness = [&](LikenessConfig config) {
    ColumnLikeness sut{config, k_rows};
    std::ranges::copy(column.turn_rad, sut.turn_rad().begin());
    return sut.of(column.o_mm.data(), column.seen.data(), k_noise_rad)[k_crease];
  };
  LikenessConfig with_rims = k_config;
  with_rims.rim_from = 3;
  with_rims.rim_to = 12;
  with_rims.rim_rad = 0.5;
  CHECK_TEXT(likeness(k_config) < 0.5F, "what lies below the rim counts as the sole");
  // 1 - exp(-(0.6 - 0.026) / 0.12) is all that is left to ask.
  DOUBLES_EQUAL(0.992, static_cast<double>(likeness(with_rims)), 0.002);
}

}  // namespace biteline::bite_line
