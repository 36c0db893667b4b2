// SPDX-License-Identifier: MIT
#include "tests/bench/line/curve_fit_held.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace biteline::bench {

namespace {

using bite_line::Raster;

std::size_t direction_of(const Vec2& along) {
  const auto off = [&](std::size_t k) {
    const bite_line::CellStep step = bite_line::k_cell_steps[k];
    return -(along.x() * step.cols + along.y() * step.rows) / step.length();
  };
  std::size_t best = 0;
  for (std::size_t k = 1; k < bite_line::k_directions; ++k)
    if (off(k) < off(best)) best = k;
  return best;
}

}  // namespace

bool Held::right_by_eye() const {
  constexpr std::array k_right = {"s01_airjordan1_scan", "s06_nike_pegasus36",
                                  "s15_mit_sneaker",     "s24_khronos_shoe_with_part_labels",
                                  "s41_low_basketball",  "s43_running"};
  return std::ranges::find(k_right, name) != k_right.end();
}

std::optional<Held> held_of(const CurveCase& of) {
  const std::optional<bite_line::Side> side = side_of(of.scan.cloud);
  if (!side) return std::nullopt;
  const bite_line::SideGrid& grid = side->field.grid;
  return Held{
      .kind = of.kind,
      .group = of.group,
      .name = of.name,
      .raster = Raster::of({side->field.places.data(), side->field.places.size()}, side->outline.length_mm(),
                           grid.z_low_mm, grid.rows * grid.row_mm, side->field.points_per_mm2),
      .truth = truth_on_side(*side, of),
      .truth_mm = of.truth_mm,
      .turn_mm = side->outline.length_mm(),
      .plain = of.truth_mm > 0 || of.scan.plain_to_see};
}

double off_mm(const Vec2& a, const Vec2& b, double turn_mm) {
  const double s = a.x() - b.x();
  return std::hypot(s - turn_mm * std::round(s / turn_mm), a.y() - b.y());
}

double least_off_mm(const Vec2& place, const std::vector<Vec2>& line, double turn_mm) {
  double least = 1e9;
  for (const Vec2& at : line) least = std::min(least, off_mm(place, at, turn_mm));
  return least;
}

bool known_beside(const Held& held, const Vec2& place) {
  constexpr double k_beside_mm = 3;
  return std::ranges::any_of(held.truth, [&](const Vec2& at) {
    return off_mm({place.x(), at.y()}, at, held.turn_mm) < k_beside_mm;
  });
}

std::optional<Passing> passing_at(const Held& held, const bite_line::CreaseLooks& looks, std::size_t i) {
  constexpr std::size_t k_about = 3;
  if (i < k_about || i + k_about >= held.truth.size()) return std::nullopt;
  const Vec2 along = held.truth[i + k_about] - held.truth[i - k_about];
  if (along.norm() > 4 * k_about * Raster::k_cell_mm) return std::nullopt;
  const std::size_t k = direction_of(along);
  const Vec2 left = Vec2{-along.y(), along.x()}.normalized();
  const int reach = held.made() ? 1 : 2;
  std::optional<Passing> best;
  float most = -1;
  for (int d = -reach; d <= reach; ++d) {
    const Vec2 at = held.truth[i] + d * Raster::k_cell_mm * left;
    const int row = static_cast<int>(std::lround(held.raster.row_of(at.y())));
    const int col = held.raster.round_col(static_cast<int>(std::lround(held.raster.col_of(at.x()))));
    if (row < 0 || row >= held.raster.rows || held.raster.seen[held.raster.at(row, col)] == 0) continue;
    const float turn = looks.alone(row, col, k)[static_cast<std::size_t>(bite_line::CreaseSign::FineTurn)];
    if (turn <= most) continue;
    most = turn;
    best = Passing{row, col, k};
  }
  return best;
}

}  // namespace biteline::bench
