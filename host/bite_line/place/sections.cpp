// SPDX-License-Identifier: MIT
#include "host/bite_line/place/sections.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/bite_line/buckets.hpp"
#include "host/bite_line/simd_kernels.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::bite_line {

namespace {

// A shadow that is higher than this hides the groove, and so does one that is longer across a flat slope.
constexpr float k_highest_filled_mm = 1.5F;
constexpr float k_longest_filled_mm = 3.0F;
constexpr float k_reach_o_mm = 14.0F;

/// Per station, one after the other, for each row the sums of weight, s, s^2, o and s o; s from the bin's
/// middle.
enum Sum : std::size_t { k_w, k_s, k_ss, k_o, k_so, k_sums };

/// From one sum's rows to the next one's: whole cache lines, which vectors do not straddle.
std::size_t rows_apart(const Sections& sections) {
  constexpr std::size_t k_line = 16;
  return (static_cast<std::size_t>(sections.rows) + k_line - 1) / k_line * k_line;
}

std::vector<PathGrid::Step> steps_of(std::span<const double> path_z_mm) {
  std::vector<PathGrid::Step> steps(path_z_mm.size());
  for (std::size_t i = 0; i < steps.size(); ++i)
    steps[i] = {static_cast<float>(path_z_mm[i]),
                static_cast<float>(path_z_mm[(i + 1) % steps.size()] - path_z_mm[i])};
  return steps;
}

/// Per sum, what goes into it.
using Taps = std::array<std::vector<WeightedRow>, k_sums>;

/// Weighted sums over the stations around one, s counted from that station; `reach` empty rows at both ends
/// of each sum.
void sum_along(std::span<const float> bins, std::span<const float> weights, const Sections& sections,
               int station, std::size_t reach, Taps& taps, std::vector<float>& sums) {
  const auto rows = static_cast<std::size_t>(sections.rows);
  const std::size_t apart = rows_apart(sections);
  const auto half = static_cast<int>(weights.size() / 2);
  for (std::vector<WeightedRow>& of_sum : taps) of_sum.clear();
  for (int j = -half; j <= half; ++j) {
    const int other = ((station + j) % sections.stations + sections.stations) % sections.stations;
    const float* block = bins.data() + static_cast<std::size_t>(other) * k_sums * apart;
    const float g = weights[static_cast<std::size_t>(j + half)];
    const auto shift = static_cast<float>(j * sections.station_mm);
    const auto add = [&](Sum to, Sum from, float weight) {
      taps[to].push_back({block + from * apart, weight});
    };
    for (const Sum sum : {k_w, k_s, k_ss, k_o, k_so}) add(sum, sum, g);
    add(k_s, k_w, g * shift);
    add(k_ss, k_s, 2 * g * shift);
    add(k_ss, k_w, g * shift * shift);
    add(k_so, k_o, g * shift);
  }
  for (std::size_t sum = 0; sum < k_sums; ++sum)
    sum_rows({sums.data() + sum * (rows + 2 * reach) + reach, rows}, taps[sum]);
}

/// Straight line in s through the weighted points of each row, taken at the station; where all lie on one
/// profile, their mean.
void fit_station(std::span<const float> sums, Sections& sections, int station) {
  constexpr LineFit k_fit{.least_weight = 0.05F, .least_spread = 0.04F};
  const auto rows = static_cast<std::size_t>(sections.rows);
  const auto of = [&](Sum sum) { return sums.data() + sum * rows; };
  fit_lines({of(k_w), of(k_s), of(k_ss), of(k_o), of(k_so)}, k_fit,
            {sections.o_mm.data() + sections.at(station, 0), rows},
            sections.known.data() + sections.at(station, 0));
}

/// Straight lines across gaps within the section; beyond its ends nothing.
void fill_gaps(Sections& sections, int station) {
  int last = -1;
  for (int row = 0; row < sections.rows; ++row) {
    const std::size_t cell = sections.at(station, row);
    if (sections.known[cell] == 0) continue;
    if (last >= 0 && row - last > 1) {
      const float o0 = sections.o_mm[sections.at(station, last)];
      const float out_mm = sections.o_mm[cell] - o0;
      const auto up_mm = static_cast<float>((row - last) * sections.row_mm);
      if (up_mm > k_highest_filled_mm || std::hypot(out_mm, up_mm) > k_longest_filled_mm) {
        last = row;
        continue;
      }
      const float slope = out_mm / static_cast<float>(row - last);
      for (int r = last + 1; r < row; ++r) {
        sections.o_mm[sections.at(station, r)] = o0 + slope * static_cast<float>(r - last);
        sections.known[sections.at(station, r)] = Sections::k_filled;
      }
    }
    last = row;
  }
}

/// What lies below a row that hides it is another thing's, and so is what the weights along the line carry
/// from there to the stations beside it.
void take_out_hidden(std::span<const std::optional<int>> hidden_below, int beside, Sections& sections) {
  sections.ended.assign(hidden_below.size(), 0);
  for (int station = 0; station < sections.stations; ++station) {
    const std::optional<int> row = hidden_below[static_cast<std::size_t>(station)];
    if (!row) continue;
    const double z_mm = sections.path_z_mm[static_cast<std::size_t>(station)] + sections.z_mm(*row);
    for (int j = -beside; j <= beside; ++j) {
      const int other = ((station + j) % sections.stations + sections.stations) % sections.stations;
      const double up_mm = z_mm - sections.path_z_mm[static_cast<std::size_t>(other)];
      const int end = sections.zero_row + static_cast<int>(std::lround(up_mm / sections.row_mm));
      std::uint8_t* known = sections.known.data() + sections.at(other, 0);
      std::fill(known, known + std::clamp(end, 0, sections.rows), std::uint8_t{0});
      sections.ended[static_cast<std::size_t>(other)] = 1;
    }
  }
}

Sections frame_of(const SectionInput& input, const SectionConfig& config) {
  Sections frame;
  frame.stations = static_cast<int>(input.path_z_mm.size());
  frame.station_mm = input.outline.length_mm() / frame.stations;
  frame.row_mm = config.row_mm;
  frame.zero_row = static_cast<int>(std::lround(config.below_mm / config.row_mm));
  frame.rows = frame.zero_row + static_cast<int>(std::lround(config.above_mm / config.row_mm)) + 1;
  frame.path_z_mm.assign(input.path_z_mm.begin(), input.path_z_mm.end());
  return frame;
}

}  // namespace

SectionPoints::SectionPoints(const SectionInput& input, const SectionConfig& config)
    : config_{config},
      frame_{frame_of(input, config)},
      landings_{landings_of(input)},
      at_station_{landings_.size(), input.path_z_mm.size(),
                  [&](std::size_t i) { return landings_[i].station; }},
      bins_{bins_of_landings()} {}

PooledVector<Landing> SectionPoints::landings_of(const SectionInput& input) const {
  PooledVector<Landing> landings(input.points.size());
  const std::vector<PathGrid::Step> steps = steps_of(input.path_z_mm);
  const PathGrid grid{.steps = steps,
                      .rows = static_cast<float>(frame_.rows),
                      .zero_row = static_cast<float>(frame_.zero_row),
                      .station_mm = static_cast<float>(frame_.station_mm),
                      .per_row = static_cast<float>(1.0 / config_.row_mm),
                      .reach_o_mm = k_reach_o_mm};
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, input.points.size(), 4096}, [&](const auto& range) {
    std::vector<OutlinePlace> places(range.size());
    input.outline.locate(input.points.subspan(range.begin(), range.size()), places);
    land({landings.data() + range.begin(), range.size()}, places, grid);
  });
  return landings;
}

PooledVector<float> SectionPoints::bins_of_landings() const {
  const std::size_t stations = at_station_.size();
  const std::size_t rows = rows_apart(frame_);
  PooledVector<float> bins(stations * k_sums * rows);
  tbb::parallel_for(std::size_t{0}, stations, [&](std::size_t station) {
    const std::span block{bins.data() + station * k_sums * rows, k_sums * rows};
    std::fill(block.begin(), block.end(), 0.0F);
    for (const std::uint32_t i : at_station_[station]) {
      const Landing& landing = landings_[i];
      float* bin = block.data() + landing.row;
      bin[k_w * rows] += 1.0F;
      bin[k_s * rows] += landing.s_mm;
      bin[k_ss * rows] += landing.s_mm * landing.s_mm;
      bin[k_o * rows] += landing.o_mm;
      bin[k_so * rows] += landing.s_mm * landing.o_mm;
    }
  });
  return bins;
}

bool SectionPoints::seen_between(int station, int reach, int low_row, int end_row, float o_mm,
                                 float far_mm) const {
  std::vector<float> between{o_mm, far_mm};
  for (int j = -reach; j <= reach; ++j) {
    const int other = ((station + j) % frame_.stations + frame_.stations) % frame_.stations;
    for (const std::uint32_t i : at_station_[static_cast<std::size_t>(other)]) {
      const Landing& landing = landings_[i];
      if (landing.row >= low_row && landing.row < end_row && landing.o_mm > o_mm && landing.o_mm < far_mm)
        between.push_back(landing.o_mm);
    }
  }
  std::sort(between.begin(), between.end());
  for (std::size_t k = 1; k < between.size(); ++k)
    if (between[k] - between[k - 1] > k_longest_filled_mm) return false;
  return true;
}

std::optional<int> SectionPoints::hidden_below(int station, int reach, const Sections& sections) const {
  // The weights over the rows make a slope of a jump: so high at most.
  constexpr double k_slope_mm = 0.4;
  constexpr double k_beside_mm = 0.3;
  const int slope = static_cast<int>(std::lround(k_slope_mm / sections.row_mm));
  const int beside = static_cast<int>(std::lround(k_beside_mm / sections.row_mm));
  const float* o = sections.o_mm.data() + sections.at(station, 0);
  const std::uint8_t* known = sections.known.data() + sections.at(station, 0);
  for (int row = sections.rows - 1; row >= slope; --row) {
    const int below = row - slope;
    if (o[below] - o[row] <= k_longest_filled_mm || known[row] == 0 || known[below] == 0) continue;
    if (!seen_between(station, reach, below - beside, row + beside, o[row], o[below])) return row;
    row = below + 1;
  }
  return std::nullopt;
}

SectionPoints::Patch SectionPoints::patch(int station, int low_row, int end_row) const {
  const std::size_t rows = rows_apart(frame_);
  const float* block = bins_.data() + static_cast<std::size_t>(station) * k_sums * rows;
  Patch patch;
  for (int r = std::max(0, low_row); r < std::min(frame_.rows, end_row); ++r) {
    const auto row = static_cast<std::size_t>(r);
    const auto w = static_cast<double>(block[k_w * rows + row]);
    patch.points += w;
    patch.s_mm += static_cast<double>(block[k_s * rows + row]);
    patch.o_mm += static_cast<double>(block[k_o * rows + row]);
    patch.row += w * r;
  }
  if (patch.points == 0) return patch;
  patch.s_mm /= patch.points;
  patch.o_mm /= patch.points;
  patch.row /= patch.points;
  return patch;
}

double SectionPoints::sample_mm() const {
  // Bands about the path: a slanting profile has its points at one height in a few stations only.
  constexpr double k_band_mm = 0.5, k_reach_mm = 2.5, k_missing_mm = 10.0;
  constexpr double k_share = 0.75;
  const auto rows_of = [&](double mm) { return static_cast<int>(std::lround(mm / frame_.row_mm)); };
  const int low = frame_.zero_row - rows_of(k_reach_mm);
  const int height = rows_of(k_band_mm);
  const auto bands = static_cast<std::size_t>(2 * rows_of(k_reach_mm) / height);
  const auto stations = static_cast<std::size_t>(frame_.stations);
  std::vector<std::uint8_t> seen(stations * bands);
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, stations, 64}, [&](const auto& range) {
    for (std::size_t station = range.begin(); station != range.end(); ++station) {
      for (std::size_t band = 0; band < bands; ++band) {
        const int first = low + static_cast<int>(band) * height;
        seen[station * bands + band] = any_point(static_cast<int>(station), first, first + height) ? 1 : 0;
      }
    }
  });
  std::vector<int> steps;
  for (std::size_t band = 0; band < bands; ++band) {
    int last = -1;
    for (int station = 0; station < frame_.stations; ++station) {
      if (seen[static_cast<std::size_t>(station) * bands + band] == 0) continue;
      if (last >= 0 && (station - last) * frame_.station_mm < k_missing_mm) steps.push_back(station - last);
      last = station;
    }
  }
  if (steps.empty()) return frame_.station_mm;
  return geometry::quantile_of(std::span<int>{steps}, k_share) * frame_.station_mm;
}

bool SectionPoints::any_point(int station, int low_row, int end_row) const {
  const std::size_t rows = rows_apart(frame_);
  const float* points = bins_.data() + (static_cast<std::size_t>(station) * k_sums + k_w) * rows;
  return std::any_of(points + std::max(0, low_row), points + std::min(frame_.rows, end_row),
                     [](float count) { return count > 0; });
}

Sections SectionPoints::cut(double sigma_s_mm) const {
  Sections sections = frame_;
  sections.o_mm.resize(static_cast<std::size_t>(sections.stations) * static_cast<std::size_t>(sections.rows));
  sections.known.resize(sections.o_mm.size());
  const std::vector<float> along = gaussian(sigma_s_mm / sections.station_mm, 3.5);
  const std::vector<float> up = gaussian(config_.sigma_z_mm / config_.row_mm, 3.5);
  const std::size_t reach = up.size() / 2;
  const auto rows = static_cast<std::size_t>(sections.rows);
  const auto beside = static_cast<int>(along.size() / 2);
  std::vector<std::optional<int>> hidden(static_cast<std::size_t>(sections.stations));
  tbb::parallel_for(tbb::blocked_range<int>{0, sections.stations, 16}, [&](const auto& range) {
    Taps taps;
    std::vector<float> column(k_sums * (rows + 2 * reach));
    std::vector<float> sums(k_sums * rows);
    for (int station = range.begin(); station != range.end(); ++station) {
      sum_along(bins_, along, sections, station, reach, taps, column);
      for (std::size_t sum = 0; sum < k_sums; ++sum)
        convolve({sums.data() + sum * rows, rows}, column.data() + sum * (rows + 2 * reach), up);
      fit_station(sums, sections, station);
      hidden[static_cast<std::size_t>(station)] = hidden_below(station, beside, sections);
    }
  });
  take_out_hidden(hidden, beside, sections);
  tbb::parallel_for(0, sections.stations, [&](int station) { fill_gaps(sections, station); });
  return sections;
}

}  // namespace biteline::bite_line
