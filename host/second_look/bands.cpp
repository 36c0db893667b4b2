// SPDX-License-Identifier: MIT
#include "host/second_look/bands.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/geometry/robust.hpp"

namespace biteline::second_look {
namespace {

/// What the work changes in a row is the median of so many rows beside it that show a change, 60 mm of a fast
/// scan's: materials change along a shoe, and what was worked twice is shorter than half of that.
constexpr std::size_t k_lenders = 60;
/// A row shows a change from here on: by chance one of a thousand does.  Not more is asked for, or only the
/// most changed ones would say what the work changes.
constexpr double k_shown_squared = 16;
/// Values farther out than this do not count as more.
constexpr double k_most_sigmas = 4;

std::size_t channels_of(const Change& change) {
  return change.stripe ? std::size_t{k_channels} : 1;
}

/// Mean change of a row's plan, its middle half: edges may lie off.
struct PlanMean {
  Values value{}, variance{};
  bool known{false};
};

PlanMean plan_mean(const Change& change, const Zones& zones, std::size_t row) {
  PlanMean mean;
  const std::size_t quarter = (zones.end_cell - zones.low_cell) / 4;
  for (std::size_t c = 0; c < channels_of(change); ++c) {
    double weight = 0;
    for (std::size_t j = zones.low_cell + quarter; j < zones.end_cell - quarter; ++j) {
      const std::size_t k = change.at(row, j);
      if (!change.known(k)) continue;
      mean.known = true;
      weight += 1 / change.variance[k][c];
      mean.value[c] += change.value[k][c] / change.variance[k][c];
    }
    mean.variance[c] = weight > 0 ? 1 / weight : k_says_nothing;
    if (weight > 0) mean.value[c] /= weight;
  }
  return mean;
}

double squared_sigmas(const Change& change, const PlanMean& mean) {
  double sum = 0;
  for (std::size_t c = 0; c < channels_of(change); ++c)
    sum += mean.value[c] * mean.value[c] / mean.variance[c];
  return sum;
}

/// The piece of the largest sum.  Sign -1: of the least.
Piece best_within(std::span<const double> values, const Piece& within, double sign) {
  Piece best{.first = within.first, .end = within.first};
  double sum = 0;
  std::size_t first = within.first;
  for (std::size_t j = within.first; j < within.end; ++j) {
    if (sum <= 0) {
      sum = 0;
      first = j;
    }
    sum += sign * values[j];
    if (sum > best.told) best = {.first = first, .end = j + 1, .told = sum};
  }
  return best;
}

void collect(std::span<const double> likelihood, const Piece& within, std::vector<Piece>& pieces) {
  const Piece best = best_within(likelihood, within, 1);
  if (best.told < k_told) return;
  const Piece hole = best_within(likelihood, best, -1);
  if (hole.told >= k_told) {
    collect(likelihood, {.first = best.first, .end = hole.first}, pieces);
    collect(likelihood, {.first = hole.end, .end = best.end}, pieces);
  } else {
    pieces.push_back(best);
  }
  collect(likelihood, {.first = within.first, .end = best.first}, pieces);
  collect(likelihood, {.first = best.end, .end = within.end}, pieces);
}

}  // namespace

Expected expected_change(const Change& change, const Zones& zones, std::span<const std::uint8_t> planned) {
  Expected expected{.change = std::vector<Values>(change.rows(), Values{}),
                    .evidence = std::vector<double>(change.rows(), 0.0)};
  std::vector<PlanMean> shown;
  std::vector<std::size_t> where;
  for (std::size_t i = 0; i < change.rows(); ++i) {
    const PlanMean mean = plan_mean(change, zones, i);
    if (planned[i] == 0 || !mean.known || squared_sigmas(change, mean) < k_shown_squared) continue;
    shown.push_back(mean);
    where.push_back(i);
  }
  if (shown.size() < k_least_shown) return expected;
  const std::size_t lenders = std::min(k_lenders, shown.size());
  std::vector<double> values;
  for (std::size_t i = 0; i < change.rows(); ++i) {
    const auto behind = static_cast<std::size_t>(std::ranges::lower_bound(where, i) - where.begin());
    for (std::size_t c = 0; c < channels_of(change); ++c) {
      values.clear();
      for (std::size_t k = 0; k < lenders; ++k) {
        const PlanMean& lent = shown[(behind + k + shown.size() - lenders / 2) % shown.size()];
        if (std::isfinite(lent.variance[c])) values.push_back(lent.value[c]);
      }
      if (!values.empty()) expected.change[i][c] = geometry::median_of(std::span<double>{values});
    }
    for (std::size_t j = zones.low_cell; j < zones.end_cell; ++j) {
      const std::size_t k = change.at(i, j);
      if (!change.known(k)) continue;
      for (std::size_t c = 0; c < channels_of(change); ++c)
        expected.evidence[i] += expected.change[i][c] * expected.change[i][c] / (2 * change.variance[k][c]);
    }
  }
  return expected;
}

std::vector<double> likelihood_of(const Change& change, const Values& expected, std::size_t row,
                                  SumOver sum) {
  std::vector<double> likelihood(change.across.cells, 0.0);
  for (std::size_t j = 0; j < change.across.cells; ++j) {
    const std::size_t k = change.at(row, j);
    if (!change.known(k)) continue;
    for (std::size_t c = 0; c < channels_of(change); ++c) {
      const double worked = expected[c];
      const double variance = change.variance[k][c] * (sum == SumOver::Piece ? change.patch_ratio[c] : 1);
      const double far = k_most_sigmas * std::sqrt(variance);
      const double value =
          std::clamp(change.value[k][c], std::min(0.0, worked) - far, std::max(0.0, worked) + far);
      likelihood[j] += worked * (value - worked / 2) / variance;
    }
  }
  return likelihood;
}

Piece best_piece(std::span<const double> likelihood) {
  return best_within(likelihood, {.first = 0, .end = likelihood.size()}, 1);
}

std::vector<Piece> worked_pieces(std::span<const double> likelihood) {
  std::vector<Piece> pieces;
  collect(likelihood, {.first = 0, .end = likelihood.size()}, pieces);
  std::ranges::sort(pieces, std::ranges::greater{}, &Piece::told);
  return pieces;
}

Multiple multiple_of(const Change& change, const Values& expected, std::size_t row, const Piece& piece) {
  Values sum{}, weight{};
  for (std::size_t j = piece.first; j < piece.end; ++j) {
    const std::size_t k = change.at(row, j);
    if (!change.known(k)) continue;
    for (std::size_t c = 0; c < channels_of(change); ++c) {
      sum[c] += expected[c] * change.value[k][c] / change.variance[k][c];
      weight[c] += expected[c] * expected[c] / change.variance[k][c];
    }
  }
  // Two layers are twice as high; what they do to the light need not double.
  const bool high = weight[k_height] >= 2 * k_told;
  const double all = high ? weight[k_height] : std::accumulate(weight.begin(), weight.end(), 0.0);
  if (all <= 0) return {};
  return {.ratio = (high ? sum[k_height] : std::accumulate(sum.begin(), sum.end(), 0.0)) / all,
          .sigma = 1 / std::sqrt(all)};
}

End end_of(std::span<const double> likelihood, const EndSearch& search) {
  const bool down = search.limit < search.middle;
  // The sum from the middle to each possible end; its largest is the likeliest end.
  std::vector<double> sums{0.0};
  if (down) {
    for (std::size_t j = search.middle; j-- > search.limit;) sums.push_back(sums.back() + likelihood[j]);
  } else {
    for (std::size_t j = search.middle; j < search.limit; ++j) sums.push_back(sums.back() + likelihood[j]);
  }
  const double largest = *std::ranges::max_element(sums);
  double weight = 0, mean = 0, square = 0;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    constexpr double k_nothing = -40;
    if (sums[k] - largest < k_nothing) continue;
    const double w = std::exp(sums[k] - largest), at = static_cast<double>(k);
    weight += w;
    mean += w * at;
    square += w * at * at;
  }
  mean /= weight;
  const double off_cells = std::sqrt(std::max(0.0, square / weight - mean * mean) + 1.0 / 12);
  const auto middle = static_cast<double>(search.middle);
  return {.cell = down ? middle - mean : middle + mean, .sigma_cells = off_cells};
}

}  // namespace biteline::second_look
