// SPDX-License-Identifier: MIT
#include "host/bite_line/path/creases.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

template <class Value>
double median(std::vector<Value> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

float turn_at(const SideField& field, std::size_t cell) {
  // The wider turn sees rounded creases (a scanned shoe's), the narrower one fine grooves; the wider one also
  // turns with the shoe's own shape, hence the discount.
  return std::max(field.turn_rad[cell], 0.8F * field.wide_turn_rad[cell]);
}

/// A turn stands out when it is three times that of most places of its surroundings, 4 to 12 mm above and
/// below the path: these are texture and noise.
bool stands_out(const SideField& field, int row, int col, double turn_rad) {
  const SideGrid& grid = field.grid;
  const int near = static_cast<int>(4.0 / grid.row_mm);
  const int far = static_cast<int>(12.0 / grid.row_mm);
  constexpr double k_times = 3.0;
  int seen = 0;
  int calmer = 0;
  const auto look = [&](const std::size_t column, int low, int high) {
    const int first = low < 0 ? low + (1 - low) / 2 * 2 : low;
    const int last = std::min(high, grid.rows - 1);
    for (int r = first; r <= last; r += 2) {
      const std::size_t cell = column + static_cast<std::size_t>(r);
      seen += field.seen[cell];
      const auto around = static_cast<double>(std::abs(field.turn_rad[cell]));
      calmer += field.seen[cell] != 0 && k_times * around < turn_rad ? 1 : 0;
    }
  };
  for (int c = col - 2; c <= col + 2; c += 2) {
    const std::size_t column = grid.at(0, (c + grid.cols) % grid.cols);
    look(column, row - far, row - near);
    look(column, row + near, row + far);
  }
  return seen == 0 ? turn_rad > 0 : calmer > seen / 2;
}

/// How far the surface below the path stands out beyond the surface above it.
bool step_at(const SideField& field, int row, int col, double& step_mm) {
  const SideGrid& grid = field.grid;
  const int from = static_cast<int>(std::lround(0.75 / grid.row_mm));
  const int to = static_cast<int>(std::lround(6.0 / grid.row_mm));
  constexpr float k_nothing_mm = -1e9F;
  const auto outermost = [&](int low, int high) {
    float most = k_nothing_mm;
    for (int r = std::max(0, low); r <= std::min(grid.rows - 1, high); ++r) {
      const std::size_t cell = grid.at(r, col);
      if (field.seen[cell] != 0) most = std::max(most, field.o_mm[cell]);
    }
    return most;
  };
  const float below = outermost(row - to, row - from);
  const float above = outermost(row + from, row + to);
  step_mm = static_cast<double>(below) - static_cast<double>(above);
  return below > k_nothing_mm && above > k_nothing_mm;
}

/// A straight line o = middle + slope z through rows from `low` to `high`, z from the row `zero`.
struct Flank {
  bool known{false};
  double at_zero_mm{0};
  double slope{0};
};

Flank flank_of(const SideField& field, int col, int zero, int low, int high) {
  const SideGrid& grid = field.grid;
  double n = 0, sz = 0, szz = 0, so = 0, szo = 0;
  for (int r = std::max(0, low); r <= std::min(grid.rows - 1, high); ++r) {
    const std::size_t cell = grid.at(r, col);
    if (field.seen[cell] == 0) continue;
    const double z = (r - zero) * grid.row_mm;
    const auto o = static_cast<double>(field.o_mm[cell]);
    n += 1;
    sz += z;
    szz += z * z;
    so += o;
    szo += z * o;
  }
  const double det = n * szz - sz * sz;
  if (n < 0.6 * (high - low + 1) || det < 1e-6) return {};
  const double slope = (n * szo - sz * so) / det;
  return {.known = true, .at_zero_mm = (so - slope * sz) / n, .slope = slope};
}

/// Turn and step between the surfaces on both sides of a place.
struct TwoFlanks {
  double turn_rad;
  double step_mm;
};

std::optional<TwoFlanks> flanks_at(const SideField& field, int row, int col) {
  constexpr double k_from_mm = 2.0;
  constexpr double k_to_mm = 6.0;
  const auto rows_of = [&](double mm) { return static_cast<int>(std::lround(mm / field.grid.row_mm)); };
  const Flank above = flank_of(field, col, row, row + rows_of(k_from_mm), row + rows_of(k_to_mm));
  const Flank below = flank_of(field, col, row, row - rows_of(k_to_mm), row - rows_of(k_from_mm));
  if (!above.known || !below.known) return std::nullopt;
  return TwoFlanks{.turn_rad = std::atan(above.slope) - std::atan(below.slope),
                   .step_mm = below.at_zero_mm - above.at_zero_mm};
}

/// Whether a wall goes on above the path: most of what lies up to `upper_mm` above it was seen.
bool wall_above(const SideField& field, int row, int col, double upper_mm) {
  const SideGrid& grid = field.grid;
  const int from = row + static_cast<int>(std::lround(2.0 / grid.row_mm));
  const int to = row + static_cast<int>(std::lround(upper_mm / grid.row_mm));
  int seen = 0;
  for (int r = from; r <= std::min(to, grid.rows - 1); ++r) seen += field.seen[grid.at(r, col)] != 0 ? 1 : 0;
  return seen > 0.6 * (to - from + 1);
}

/// Whether something that may be a sole shows below the path.
bool sole_below(const SideField& field, int row, int col, const CreaseConfig& config) {
  const SideGrid& grid = field.grid;
  const float widest_mm = field.o_mm[grid.at(row, col)] + static_cast<float>(config.widest_sole_mm);
  const int to = row - static_cast<int>(std::lround(config.least_sole_mm / grid.row_mm));
  for (int r = to; r >= 0; --r) {
    const std::size_t cell = grid.at(r, col);
    if (field.seen[cell] != 0 && field.o_mm[cell] < widest_mm) return true;
  }
  return false;
}

}  // namespace

std::vector<double> smooth_rows(const SideGrid& grid, std::span<const int> path) {
  constexpr double k_smooth_mm = 2.0;
  const std::vector<double> rows(path.begin(), path.end());
  return geometry::smooth_closed(rows, k_smooth_mm / grid.col_mm);
}

std::vector<int> on_crest(const SideField& field, std::span<const int> path, double reach_mm) {
  const SideGrid& grid = field.grid;
  const int reach = static_cast<int>(std::lround(reach_mm / grid.row_mm));
  std::vector<int> crest;
  for (int col = 0; col < grid.cols; ++col) {
    const int middle = path[static_cast<std::size_t>(col)];
    int best = middle;
    for (int row = std::max(0, middle - reach); row <= std::min(grid.rows - 1, middle + reach); ++row)
      if (field.turn_rad[grid.at(row, col)] > field.turn_rad[grid.at(best, col)]) best = row;
    crest.push_back(best);
  }
  return crest;
}

Crease describe(const SideField& field, std::span<const int> path, const CreaseConfig& config) {
  const SideGrid& grid = field.grid;
  Crease crease;
  const auto cols = static_cast<std::size_t>(grid.cols);
  crease.turn_rad.assign(cols, std::numeric_limits<float>::quiet_NaN());
  crease.visible.assign(cols, 0);
  crease.upper.assign(cols, 0);
  crease.sole.assign(cols, 0);
  crease.row = smooth_rows(grid, path);

  std::vector<double> turns;
  std::vector<double> steps;
  std::vector<double> flank_turns;
  std::vector<double> flank_steps;
  std::size_t seen = 0;
  for (int c = 0; c < grid.cols; ++c) {
    const auto col = static_cast<std::size_t>(c);
    const int row = path[col];
    const std::size_t cell = grid.at(row, c);
    crease.mean_height_mm += grid.z_mm(row) / grid.cols;
    if (field.seen[cell] == 0) continue;
    ++seen;
    crease.upper[col] = wall_above(field, row, c, config.upper_mm) ? 1 : 0;
    crease.sole[col] = sole_below(field, row, c, config) ? 1 : 0;
    const double turn = static_cast<double>(turn_at(field, cell));
    crease.turn_rad[col] = static_cast<float>(turn);
    turns.push_back(turn);
    if (!(turn > config.least_turn_rad && stands_out(field, row, c, turn))) continue;
    crease.visible[col] = 1;
    if (const std::optional<TwoFlanks> flanks = flanks_at(field, row, c)) {
      flank_turns.push_back(flanks->turn_rad);
      flank_steps.push_back(flanks->step_mm);
    }
    double step = 0;
    if (step_at(field, row, c, step)) steps.push_back(step);
  }
  const auto visible = static_cast<double>(std::count(crease.visible.begin(), crease.visible.end(), 1));
  const auto share_of = [seen](const std::vector<std::uint8_t>& marks) {
    return static_cast<double>(std::ranges::count(marks, 1)) /
           std::max<double>(static_cast<double>(seen), 1.0);
  };
  crease.upper_share = share_of(crease.upper);
  crease.sole_share = share_of(crease.sole);
  crease.seen_share = static_cast<double>(seen) / grid.cols;
  crease.visible_share = visible / grid.cols;
  crease.median_turn_rad = median(std::move(turns));
  crease.median_step_mm = median(std::move(steps));
  crease.flanks_seen = static_cast<double>(flank_turns.size()) > visible / 3;
  crease.flank_turn_rad = median(std::move(flank_turns));
  crease.flank_step_mm = median(std::move(flank_steps));
  const auto longest_run_mm = [&](auto&& missing) {
    int run = 0;
    int longest = 0;
    for (int c = 0; c < 2 * grid.cols; ++c) {  // twice round: a run may cross the seam
      run = missing(static_cast<std::size_t>(c % grid.cols)) ? run + 1 : 0;
      longest = std::max(longest, std::min(run, grid.cols));
    }
    return longest * grid.col_mm;
  };
  crease.longest_gap_mm = longest_run_mm([&](std::size_t c) { return crease.visible[c] == 0; });
  crease.longest_unseen_mm =
      longest_run_mm([&](std::size_t c) { return field.seen[grid.at(path[c], static_cast<int>(c))] == 0; });
  return crease;
}

}  // namespace biteline::bite_line
