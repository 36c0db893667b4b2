// SPDX-License-Identifier: MIT
#include "host/cloud/nothing_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "common/core/fixed_text.hpp"

namespace biteline::cloud {
namespace {

using Place = Eigen::Vector3d;
using Places = std::span<const Place>;

constexpr std::size_t k_sample = 20'000;
/// Once or twice may be chance.
constexpr std::size_t k_least_copies = 3;
/// Rarer ones are strays, which nobody needs to be told of.
constexpr double k_least_share = 0.001;
constexpr int k_most_values = 4;
constexpr double k_never = std::numeric_limits<double>::infinity();

bool before(const Place& a, const Place& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

template <class Value>
struct Common {
  Value value{};
  std::size_t count{0};
  std::size_t usual{0};  ///< copies that nine of ten different values have at most
};

/// The commonest of sorted values.
template <class Value>
Common<Value> commonest(const std::vector<Value>& sorted) {
  Common<Value> common;
  std::vector<std::size_t> counts;
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    while (end < sorted.size() && sorted[end] == sorted[begin]) ++end;
    counts.push_back(end - begin);
    if (counts.back() > common.count) common = {.value = sorted[begin], .count = counts.back(), .usual = 0};
  }
  if (counts.empty()) return common;
  const auto at = counts.begin() + static_cast<std::ptrdiff_t>((counts.size() - 1) * 9 / 10);
  std::ranges::nth_element(counts, at);
  common.usual = *at;
  return common;
}

bool often_enough(std::size_t count, std::size_t all) {
  return count >= k_least_copies && static_cast<double>(count) >= k_least_share * static_cast<double>(all);
}

std::string number_text(double value) {
  return std::string(FixedText<40>::format("%.6g", value == 0 ? 0.0 : value).view());
}

/// Kept points of the sample.
std::vector<std::size_t> sample_of(const std::vector<std::uint8_t>& keep) {
  std::vector<std::size_t> sample = spread_numbers(keep.size(), k_sample);
  std::erase_if(sample, [&](std::size_t i) { return keep[i] == 0; });
  return sample;
}

double nearest(Places places, const std::vector<std::uint8_t>& keep, const Place& to) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (keep[i] != 0 && places[i] != to) least = std::min(least, (places[i] - to).squaredNorm());
  }
  return std::sqrt(least);
}

/// A point could be there: the next one is as near as from other points.
bool has_neighbours(Places places, const std::vector<std::uint8_t>& keep, const Place& place) {
  constexpr std::size_t k_probes = 15;
  std::vector<double> usual;
  for (const std::size_t i : spread_numbers(places.size(), 4 * k_probes)) {
    if (keep[i] != 0 && places[i] != place && usual.size() < k_probes)
      usual.push_back(nearest(places, keep, places[i]));
  }
  if (usual.empty()) return false;
  std::ranges::nth_element(usual, usual.begin() + static_cast<std::ptrdiff_t>(usual.size() / 2));
  return nearest(places, keep, place) <= 2 * usual[usual.size() / 2];
}

/// One place that many points have.
bool leave_out_place(Places places, std::vector<std::uint8_t>& keep, std::vector<NothingValue>& found) {
  std::vector<Place> sorted;
  for (const std::size_t i : sample_of(keep)) sorted.push_back(places[i]);
  std::ranges::sort(sorted, before);
  const Common<Place> common = commonest(sorted);
  // Where places come twice or more as a rule, many copies of one are less of a sign.
  const std::size_t outstanding = common.usual == 1 ? 3 : 10 * common.usual;
  if (!often_enough(common.count, sorted.size()) || common.count < outstanding) return false;
  bool one_stays = has_neighbours(places, keep, common.value);
  NothingValue nothing{.value = number_text(common.value.x()) + " " + number_text(common.value.y()) + " " +
                                number_text(common.value.z())};
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (keep[i] == 0 || places[i] != common.value || std::exchange(one_stays, false)) continue;
    keep[i] = 0;
    ++nothing.points;
  }
  found.push_back(std::move(nothing));
  return true;
}

/// What writers mean by nothing; any other z must stand alone, too.
bool is_usual_nothing(double value) {
  constexpr std::array k_usual{999.0,   9999.0, 99999.0, 32767.0,      32768.0,
                               65535.0, 1000.0, 10000.0, 2147483648.0, 2147483647.0};
  return std::abs(value) >= 1e9 || std::ranges::find(k_usual, std::abs(value)) != k_usual.end();
}

/// One height that many points have, far from all others.
bool leave_out_height(Places places, std::vector<std::uint8_t>& keep, std::vector<NothingValue>& found) {
  std::vector<double> sorted;
  for (const std::size_t i : sample_of(keep)) sorted.push_back(places[i].z());
  std::ranges::sort(sorted);
  const std::size_t all = sorted.size();
  // The commonest of all, or of the outermost two, which a table's z could outnumber.
  std::vector<double> candidates{commonest(sorted).value};
  if (!sorted.empty()) candidates.insert(candidates.end(), {sorted.front(), sorted.back()});
  for (const double value : candidates) {
    const auto [begin, end] = std::equal_range(sorted.begin(), sorted.end(), value);
    const auto count = static_cast<std::size_t>(end - begin);
    std::vector<double> rest(sorted.begin(), begin);
    rest.insert(rest.end(), end, sorted.end());
    if (!often_enough(count, all) || rest.size() < 2) continue;
    const std::size_t cut = rest.size() / 100;
    const double range = rest[rest.size() - 1 - cut] - rest[cut];
    const double below = begin == sorted.begin() ? k_never : value - *(begin - 1);
    const double above = end == sorted.end() ? k_never : *end - value;
    const bool alone = std::min(below, above) > range;
    // Two planes of a drawn part stand apart, too: measured heights have many values.
    const bool measured = 5 * commonest(rest).count < rest.size();
    if (!alone || (!measured && !is_usual_nothing(value))) continue;
    NothingValue nothing{.value = "z " + number_text(value)};
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (keep[i] == 0 || places[i].z() != value) continue;
      keep[i] = 0;
      ++nothing.points;
    }
    found.push_back(std::move(nothing));
    return true;
  }
  return false;
}

}  // namespace

std::vector<std::size_t> spread_numbers(std::size_t count, std::size_t most) {
  std::vector<std::size_t> numbers;
  if (count <= most) {
    numbers.resize(count);
    for (std::size_t i = 0; i < count; ++i) numbers[i] = i;
    return numbers;
  }
  // One by chance out of each of `most` stretches of the same length; the same ones each time.
  std::mt19937_64 random{4711};
  const double stretch = static_cast<double>(count) / static_cast<double>(most);
  for (std::size_t i = 0; i < most; ++i) {
    const double within = static_cast<double>(random() >> 11U) * 0x1p-53;
    numbers.push_back(
        std::min(count - 1, static_cast<std::size_t>((static_cast<double>(i) + within) * stretch)));
  }
  return numbers;
}

std::vector<NothingValue> leave_out_nothing(Places places, std::vector<std::uint8_t>& keep) {
  std::vector<NothingValue> found;
  for (int i = 0; i < k_most_values && leave_out_place(places, keep, found); ++i) continue;
  for (int i = 0; i < k_most_values && leave_out_height(places, keep, found); ++i) continue;
  return found;
}

}  // namespace biteline::cloud
