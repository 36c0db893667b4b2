// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/crease_looks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <tbb/parallel_for.h>

#include "host/geometry/logistic.hpp"

namespace biteline::bite_line {

namespace {

constexpr double k_fine_mm = 1.0, k_wide_mm = 2.25;
constexpr double k_run_mm = 3.0;  // to both sides along a direction: over so much a crease is straight
constexpr float k_crease_rad = 0.12F, k_wide_crease_rad = 0.2F;  // above the noise, plain with 63 %

/// atan to 1e-4 rad, without a branch: the compiler makes vectors of it.
float quick_atan(float slope) {
  constexpr float k_right_angle = std::numbers::pi_v<float> / 2;
  const float size = std::abs(slope);
  const float t = size > 1 ? 1 / std::max(size, 1.0F) : size;  // no division by 0, in vectors neither
  const float tt = t * t;
  const float low =
      t * (0.9998660F + tt * (-0.3302995F + tt * (0.1801410F + tt * (-0.0851330F + tt * 0.0208351F))));
  return std::copysign(size > 1 ? k_right_angle - low : low, slope);
}

float plain(float over_rad, float crease_rad) {
  return over_rad > 0 ? 1 - std::exp(-over_rad / crease_rad) : 0.0F;
}

float& of(CreaseSigns& signs, CreaseSign sign) {
  return signs[static_cast<std::size_t>(sign)];
}

/// Of signs, or of their weights.
float value(const std::array<float, k_crease_signs>& signs, CreaseSign sign) {
  return signs[static_cast<std::size_t>(sign)];
}

constexpr float k_unknown = 2;  // beyond any sign

}  // namespace

float log_odds(const SignWeights& weights, const CreaseSigns& signs) {
  float sum = 0;
  for (std::size_t i = 0; i < k_crease_signs; ++i) sum += weights[i] * signs[i];
  return sum;
}

CreaseSigns medians_of(std::span<const CreaseSigns> all) {
  CreaseSigns medians{};
  if (all.empty()) return medians;
  std::vector<float> values(all.size());
  for (std::size_t i = 0; i < k_crease_signs; ++i) {
    std::ranges::transform(all, values.begin(), [i](const CreaseSigns& signs) { return signs[i]; });
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    medians[i] = *middle;
  }
  return medians;
}

CreaseLooks::Beside CreaseLooks::left_of(std::size_t direction, double mm) {
  const CellStep step = k_cell_steps[direction];
  const double along = -step.rows / step.length() * mm / Raster::k_cell_mm;
  const double up = step.cols / step.length() * mm / Raster::k_cell_mm;
  const double col = std::round(along), row = std::round(up);
  return {.cols = static_cast<int>(col),
          .rows = static_cast<int>(row),
          .along_mm = static_cast<float>((along - col) * Raster::k_cell_mm),
          .up_mm = static_cast<float>((up - row) * Raster::k_cell_mm),
          .away_mm = static_cast<float>(mm)};
}

CreaseLooks::Ways CreaseLooks::ways_of(std::size_t direction) {
  const auto from_to = [&](double from_mm, double to_mm, double step_mm) {
    std::vector<Beside> places;
    const auto count = static_cast<int>(std::lround(std::abs(to_mm - from_mm) / step_mm));
    for (int i = 0; i <= count; ++i)
      places.push_back(left_of(direction, from_mm + (to_mm - from_mm) * i / count));
    return places;
  };
  Ways ways;
  ways.crest = from_to(-1.5, 1.5, 0.75);
  ways.upper = from_to(1.5, 4.0, 0.75);
  ways.sole = from_to(-1.5, -4.0, 0.75);
  ways.rim = from_to(-1.0, -3.0, 0.75);
  ways.wall = from_to(2.0, 8.0, 1.5);
  ways.foot = from_to(-1.5, -4.5, 1.0);
  ways.left = from_to(2.5, 25.0, 1.0);
  ways.right = from_to(-2.5, -25.0, 1.0);
  return ways;
}

CreaseLooks::CreaseLooks(const Raster& raster) : raster_{raster} {
  for (std::size_t k = 0; k < k_directions; ++k) ways_[k] = ways_of(k);
  tbb::parallel_for(std::size_t{0}, 2 * k_axes, [&](std::size_t i) {
    const std::size_t axis = i / 2;
    if (i % 2 == 0)
      read_turns(axis, k_fine_mm, fine_rad_[axis]);
    else
      read_turns(axis, k_wide_mm, wide_rad_[axis]);
  });
  read_noise();
}

void CreaseLooks::read_turns(std::size_t axis, double flank_mm, PooledVector<float>& mean_rad) {
  const Beside left = left_of(axis, flank_mm), right = left_of(axis, -flank_mm);
  const auto per_flank = static_cast<float>(1 / flank_mm);
  const int first = std::abs(left.rows), last = raster_.rows - std::abs(left.rows);
  PooledVector<float> turn_rad(raster_.size());
  std::fill(turn_rad.begin(), turn_rad.end(), 0.0F);
  for (int col = 0; col < raster_.cols; ++col) {
    const std::size_t here = raster_.at(0, col);
    const std::ptrdiff_t to_left =
        static_cast<std::ptrdiff_t>(raster_.at(0, raster_.round_col(col + left.cols))) + left.rows;
    const std::ptrdiff_t to_right =
        static_cast<std::ptrdiff_t>(raster_.at(0, raster_.round_col(col + right.cols))) + right.rows;
    for (int row = first; row < last; ++row) {
      const std::size_t own = here + static_cast<std::size_t>(row);
      const auto l = static_cast<std::size_t>(to_left + row), r = static_cast<std::size_t>(to_right + row);
      const float above = (o_mm(static_cast<std::ptrdiff_t>(l), left) - raster_.o_mm[own]) * per_flank;
      const float below = (raster_.o_mm[own] - o_mm(static_cast<std::ptrdiff_t>(r), right)) * per_flank;
      const bool seen = (raster_.seen[own] & raster_.seen[l] & raster_.seen[r]) != 0;
      turn_rad[own] = seen ? quick_atan(above) - quick_atan(below) : 0.0F;
    }
  }
  const CellStep step = k_cell_steps[axis];
  const double cells = 1 / step.length();
  const int reach = static_cast<int>(std::lround(k_run_mm / Raster::k_cell_mm));
  const float weight = 1 / static_cast<float>(2 * reach + 1);
  mean_rad.resize(raster_.size());
  std::fill(mean_rad.begin(), mean_rad.end(), 0.0F);
  for (int j = -reach; j <= reach; ++j) {
    const int cols = static_cast<int>(std::lround(j * step.cols * cells));
    const int rows = static_cast<int>(std::lround(j * step.rows * cells));
    for (int col = 0; col < raster_.cols; ++col) {
      const float* from = turn_rad.data() + raster_.at(0, raster_.round_col(col + cols));
      float* to = mean_rad.data() + raster_.at(0, col);
      for (int row = std::max(0, -rows); row < raster_.rows - std::max(0, rows); ++row)
        to[row] += weight * from[row + rows];
    }
  }
}

void CreaseLooks::read_noise() {
  constexpr float k_least_rad = 0.026F;  // of a scan of 0.02 mm noise at 5 points on 1 mm^2
  constexpr float k_rough_ratio = 0.7F;  // of the median turn of a rough column is noise, too
  constexpr int k_about_cols = 3;
  noise_rad_.assign(static_cast<std::size_t>(raster_.cols), k_least_rad);
  std::vector<float> sizes;
  for (int col = 0; col < raster_.cols; ++col) {
    sizes.clear();
    for (int c = col - k_about_cols; c <= col + k_about_cols; c += k_about_cols) {
      for (int row = 0; row < raster_.rows; row += 2) {
        const std::size_t cell = raster_.at(row, raster_.round_col(c));
        if (raster_.seen[cell] != 0) sizes.push_back(std::abs(fine_rad_[0][cell]));
      }
    }
    if (sizes.empty()) continue;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    noise_rad_[static_cast<std::size_t>(col)] = std::max(k_least_rad, k_rough_ratio * *middle);
  }
}

std::ptrdiff_t CreaseLooks::cell(int row, int col, const Beside& at) const {
  const int r = row + at.rows;
  if (r < 0 || r >= raster_.rows) return -1;
  const auto there = static_cast<std::ptrdiff_t>(raster_.at(r, raster_.near_col(col + at.cols)));
  return raster_.seen[static_cast<std::size_t>(there)] != 0 ? there : -1;
}

CreaseLooks::Flank CreaseLooks::flank(int row, int col, const std::vector<Beside>& places) const {
  float n = 0, x = 0, xx = 0, y = 0, xy = 0;
  for (const Beside& at : places) {
    const std::ptrdiff_t there = cell(row, col, at);
    if (there < 0) continue;
    const float o = o_mm(there, at);
    const float away = std::abs(at.away_mm);
    n += 1;
    x += away;
    xx += away * away;
    y += o;
    xy += away * o;
  }
  if (n < 0.6F * static_cast<float>(places.size())) return {};
  const float slope = (xy / n - x / n * y / n) / std::max(xx / n - x / n * x / n, 1e-3F);
  return {.at_mm = y / n - slope * x / n, .slope = slope, .seen = true};
}

float CreaseLooks::share_seen(int row, int col, const std::vector<Beside>& places) const {
  float count = 0;
  for (const Beside& at : places) count += cell(row, col, at) >= 0 ? 1.0F : 0.0F;
  return count / static_cast<float>(places.size());
}

CreaseSigns CreaseLooks::alone(int row, int col, std::size_t direction) const {
  constexpr float k_rad_per_mm = 0.35F, k_between_rad = 0.035F;  // 20 degrees, and 2
  constexpr float k_most_step_mm = 1.5F, k_rim_rad = 0.3F;
  constexpr float k_near_mm = 2.0F, k_overhang_mm = 0.5F, k_soft_mm = 0.1F;
  const std::size_t here = raster_.at(row, col);
  const std::size_t axis = direction % k_axes;
  CreaseSigns signs{};
  of(signs, CreaseSign::Always) = 1;
  if (!turns(here, direction)) return signs;
  const Ways& ways = ways_[direction];
  const float noise = noise_rad_[static_cast<std::size_t>(col)];
  const PooledVector<float>& fine = fine_rad_[axis];
  of(signs, CreaseSign::Turns) = 1;
  of(signs, CreaseSign::FineTurn) = plain(fine[here] - noise, k_crease_rad);
  of(signs, CreaseSign::WideTurn) = plain(wide_rad_[axis][here] - noise, k_wide_crease_rad);
  float crest = std::max(fine[here], 1e-3F), rim = 0;
  for (const Beside& at : ways.crest) {
    const std::ptrdiff_t there = cell(row, col, at);
    if (there >= 0) crest = std::max(crest, fine[static_cast<std::size_t>(there)]);
  }
  for (const Beside& at : ways.rim) {
    const std::ptrdiff_t there = cell(row, col, at);
    if (there >= 0) rim = std::max(rim, -fine[static_cast<std::size_t>(there)]);
  }
  of(signs, CreaseSign::Crest) = std::clamp(fine[here] / crest, 0.0F, 1.0F);
  of(signs, CreaseSign::RimRight) = plain(rim - noise, k_rim_rad);
  const Flank upper = flank(row, col, ways.upper), sole = flank(row, col, ways.sole);
  if (upper.seen && sole.seen) {
    const float turn_rad = quick_atan(upper.slope) + quick_atan(sole.slope);
    const float out_mm = upper.at_mm + k_near_mm * upper.slope - sole.at_mm - k_near_mm * sole.slope;
    of(signs, CreaseSign::FlanksSeen) = 1;
    const float between_rad = turn_rad + k_rad_per_mm * std::max(sole.at_mm - upper.at_mm, 0.0F);
    of(signs, CreaseSign::TwoSurfaces) =
        static_cast<float>(geometry::logistic(static_cast<double>(between_rad / k_between_rad)));
    of(signs, CreaseSign::FlankStep) = std::clamp((sole.at_mm - upper.at_mm) / k_most_step_mm, -1.0F, 1.0F);
    of(signs, CreaseSign::Overhang) =
        static_cast<float>(geometry::logistic(static_cast<double>((out_mm - k_overhang_mm) / k_soft_mm)));
  }
  of(signs, CreaseSign::WallLeft) = share_seen(row, col, ways.wall);
  of(signs, CreaseSign::SoleRight) = share_seen(row, col, ways.foot);
  const float ahead = fine_rad_[(axis + k_axes / 2) % k_axes][here];
  of(signs, CreaseSign::EdgeAhead) = plain(-ahead - noise, k_rim_rad);
  if (!usual_) return signs;
  const auto unlike = [&](CreaseSign sign) { return std::abs(value(signs, sign) - value(*usual_, sign)); };
  of(signs, CreaseSign::UnlikeTurn) = unlike(CreaseSign::FineTurn);
  if (of(signs, CreaseSign::FlanksSeen) != 0)
    of(signs, CreaseSign::UnlikeStep) = unlike(CreaseSign::FlankStep);
  return signs;
}

void CreaseLooks::look_beside(const CurveWeights& weights) {
  constexpr float k_nothing = -4, k_sure = 2;  // log odds: a faint crease counts, too
  weights_ = weights;
  turning_.assign(static_cast<std::size_t>((raster_.cols + k_block_cols - 1) / k_block_cols), {});
  std::array<PooledVector<float>, k_directions> like;
  for (PooledVector<float>& values : like) values.resize(raster_.size());
  tbb::parallel_for(std::size_t{0}, turning_.size(), [&](std::size_t block) {
    const int first = static_cast<int>(block) * k_block_cols;
    for (int col = first; col < std::min(first + k_block_cols, raster_.cols); ++col) {
      for (int row = 0; row < raster_.rows; ++row) {
        const std::size_t cell = raster_.at(row, col);
        for (std::size_t k = 0; k < k_directions; ++k) {
          like[k][cell] = 0;
          if (raster_.seen[cell] == 0 || !turns(cell, k)) continue;
          const CreaseSigns signs = alone(row, col, k);
          like[k][cell] =
              std::clamp((log_odds(weights.alone, signs) - k_nothing) / (k_sure - k_nothing), 0.0F, 1.0F);
          turning_[block].push_back({.cell = static_cast<std::uint32_t>(cell),
                                     .direction = static_cast<std::uint32_t>(k),
                                     .by_all = log_odds(weights.all, signs),
                                     .by_usual = log_odds(weights.usual, signs),
                                     .fine_turn = value(signs, CreaseSign::FineTurn),
                                     .step = value(signs, CreaseSign::FlanksSeen) != 0
                                                 ? value(signs, CreaseSign::FlankStep)
                                                 : k_unknown,
                                     .left = 0,
                                     .right = 0});
        }
      }
    }
  });
  std::array<PooledVector<float>, k_directions> alike;  // in this direction or one beside it
  tbb::parallel_for(std::size_t{0}, k_directions, [&](std::size_t k) {
    alike[k] = like[k];
    for (const std::size_t other : {k + 1, k - 1}) {
      if (other >= k_directions) continue;
      for (std::size_t i = 0; i < alike[k].size(); ++i) alike[k][i] = std::max(alike[k][i], like[other][i]);
    }
  });
  tbb::parallel_for(std::size_t{0}, turning_.size(), [&](std::size_t block) {
    for (Turning& at : turning_[block]) {
      at.left = most_beside(alike[at.direction], at.cell, ways_[at.direction].left);
      at.right = most_beside(alike[at.direction], at.cell, ways_[at.direction].right);
    }
  });
}

float CreaseLooks::odds(const Turning& at) const {
  const SignWeights& weights = usual_ ? weights_.usual : weights_.all;
  const auto weight = [&](CreaseSign sign) { return value(weights, sign); };
  float sum = usual_ ? at.by_usual : at.by_all;
  sum += weight(CreaseSign::LeftCrease) * at.left;
  sum += weight(CreaseSign::RightCrease) * at.right;
  if (!usual_) return sum;
  sum += weight(CreaseSign::UnlikeTurn) * std::abs(at.fine_turn - value(*usual_, CreaseSign::FineTurn));
  if (at.step < k_unknown)
    sum += weight(CreaseSign::UnlikeStep) * std::abs(at.step - value(*usual_, CreaseSign::FlankStep));
  return sum;
}

float CreaseLooks::most_beside(const PooledVector<float>& values, std::size_t cell,
                               const std::vector<Beside>& places) const {
  const int col = static_cast<int>(cell) / raster_.rows, row = static_cast<int>(cell) % raster_.rows;
  float most = 0;
  for (const Beside& at : places) {
    const int r = row + at.rows;
    if (r < 0 || r >= raster_.rows) continue;
    most = std::max(most, values[raster_.at(r, raster_.near_col(col + at.cols))]);
  }
  return most;
}

CreaseSigns CreaseLooks::all(int row, int col, std::size_t direction) const {
  CreaseSigns signs = alone(row, col, direction);
  if (signs[static_cast<std::size_t>(CreaseSign::Turns)] == 0) return signs;
  if (turning_.empty()) return signs;
  const std::vector<Turning>& block = turning_[static_cast<std::size_t>(col / k_block_cols)];
  const auto order = [](const Turning& at) { return std::pair{at.cell, at.direction}; };
  const std::pair here{static_cast<std::uint32_t>(raster_.at(row, col)),
                       static_cast<std::uint32_t>(direction)};
  const auto at = std::ranges::lower_bound(block, here, {}, order);
  if (at == block.end() || order(*at) != here) return signs;
  of(signs, CreaseSign::LeftCrease) = at->left;
  of(signs, CreaseSign::RightCrease) = at->right;
  return signs;
}

}  // namespace biteline::bite_line
