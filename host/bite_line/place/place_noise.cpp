// SPDX-License-Identifier: MIT
#include "host/bite_line/place/place_noise.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/geometry/closed_curve.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::bite_line {
namespace {

// Second differences over this height: more than three deviations of the sections' own smoothing.
constexpr double k_lag_mm = 0.2;
// The crease itself turns; beside it the surface is nearly straight over the lag.
constexpr double k_beside_crease_mm = 1.0;
// Median of |x| over its standard deviation, and the variance of a second difference.
constexpr double k_median_of_normal = 0.6745;
constexpr double k_second_difference = 6;
// A round bottom lies half-way down, a sharp one lower: nineteen of twenty within seven tenths.
constexpr double k_of_depth = 0.35;
// A section takes its neighbours' points in, so a place beside a filled one is off, too.
constexpr double k_beside_filled_mm = 2;

int rows_of(const Sections& sections, double mm) {
  return std::max(1, static_cast<int>(std::lround(mm / sections.row_mm)));
}

/// Variance of the sections' o at a station, from second differences beside the crease; 0 where too little
/// was seen.
double noise_mm2(const Sections& sections, int station, double line_row, std::vector<float>& room) {
  const int lag = rows_of(sections, k_lag_mm);
  const int beside = rows_of(sections, k_beside_crease_mm);
  const auto crease = static_cast<int>(std::lround(line_row));
  room.clear();
  for (int row = lag; row + lag < sections.rows; row += lag / 2 + 1) {
    if (std::abs(row - crease) < beside) continue;
    const std::size_t at = sections.at(station, row);
    const auto step = static_cast<std::size_t>(lag);
    if (sections.known[at] != Sections::k_seen || sections.known[at - step] != Sections::k_seen ||
        sections.known[at + step] != Sections::k_seen)
      continue;
    room.push_back(std::abs(sections.o_mm[at - step] - 2 * sections.o_mm[at] + sections.o_mm[at + step]));
  }
  constexpr std::size_t k_least = 8;
  if (room.size() < k_least) return 0;
  const double sigma = static_cast<double>(geometry::median_of(std::span<float>{room})) / k_median_of_normal;
  return sigma * sigma / k_second_difference;
}

/// Over half a millimetre to either side of the line.
double slope_at(const Sections& sections, int station, double line_row) {
  const int reach = rows_of(sections, 0.5);
  const auto row = static_cast<int>(std::lround(line_row));
  const int low = std::clamp(row - reach, 0, sections.rows - 1);
  const int high = std::clamp(row + reach, 0, sections.rows - 1);
  const std::size_t a = sections.at(station, low);
  const std::size_t b = sections.at(station, high);
  if (high <= low || sections.known[a] == 0 || sections.known[b] == 0) return 0;
  return static_cast<double>(sections.o_mm[b] - sections.o_mm[a]) / ((high - low) * sections.row_mm);
}

/// A smoothed hollow is shallower, by half its second derivative times the variance of what smooths it: the
/// sections' Gaussian, and a row's height.  0 where it was not seen.
double round_at(const Sections& sections, int station, double line_row) {
  const int lag = rows_of(sections, 0.1);
  const auto row = static_cast<int>(std::lround(line_row));
  if (row < lag || row + lag >= sections.rows) return 0;
  const std::size_t at = sections.at(station, row);
  const auto step = static_cast<std::size_t>(lag);
  if (sections.known[at] != Sections::k_seen || sections.known[at - step] != Sections::k_seen ||
      sections.known[at + step] != Sections::k_seen)
    return 0;
  const double bend_mm =
      static_cast<double>(sections.o_mm[at - step] - 2 * sections.o_mm[at] + sections.o_mm[at + step]);
  const double sigma_rows = SectionConfig{}.sigma_z_mm / sections.row_mm;
  return 0.5 * bend_mm / (lag * lag) * (sigma_rows * sigma_rows + 1.0 / 12);
}

/// Slope of what was seen from `row` on, in steps of `step` rows: outwards per row.
std::optional<double> flank_slope(const Sections& sections, int station, int row, int step) {
  const int length = rows_of(sections, 0.15);
  const int end = row + step * length;
  if (end < 0 || end >= sections.rows) return std::nullopt;
  const std::size_t a = sections.at(station, row);
  const std::size_t b = sections.at(station, end);
  if (sections.known[a] != Sections::k_seen || sections.known[b] != Sections::k_seen) return std::nullopt;
  return static_cast<double>(sections.o_mm[b] - sections.o_mm[a]) / (end - row);
}

/// A glare or a shadow hides a hollow's bottom: it lies between the straight line that fills the gap and its
/// two flanks, drawn on.  0 where it was seen.
double filled_at(const Sections& sections, int station, double line_row) {
  const auto row = static_cast<int>(std::lround(line_row));
  const auto filled = [&](int at) {
    return at >= 0 && at < sections.rows && sections.known[sections.at(station, at)] == Sections::k_filled;
  };
  if (!filled(row)) return 0;
  int below = row;
  while (filled(below)) --below;
  int above = row;
  while (filled(above)) ++above;
  if (below < 0 || above >= sections.rows) return 0;
  const std::optional<double> from_below = flank_slope(sections, station, below, -1);
  const std::optional<double> from_above = flank_slope(sections, station, above, 1);
  if (!from_below || !from_above) return 0;
  const double o_mm = static_cast<double>(sections.o_mm[sections.at(station, row)]);
  const double deepest_mm =
      std::max(static_cast<double>(sections.o_mm[sections.at(station, below)]) + *from_below * (row - below),
               static_cast<double>(sections.o_mm[sections.at(station, above)]) + *from_above * (row - above));
  return k_of_depth * std::max(o_mm - deepest_mm, 0.0);
}

}  // namespace

std::vector<PlaceNoise> place_noise(const Sections& sections, std::span<const double> row,
                                    std::span<const std::uint8_t> visible, double mean_mm) {
  const auto stations = static_cast<std::size_t>(sections.stations);
  std::vector<double> mm2(stations), counted(stations), round_mm(stations), filled_mm(stations);
  std::vector<PlaceNoise> noise(stations);
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, stations, 64}, [&](const auto& range) {
    std::vector<float> room;
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      counted[i] = visible[i] != 0 ? 1 : 0;
      mm2[i] = counted[i] * noise_mm2(sections, static_cast<int>(i), row[i], room);
      round_mm[i] = round_at(sections, static_cast<int>(i), row[i]);
      filled_mm[i] = filled_at(sections, static_cast<int>(i), row[i]);
      noise[i].slope = slope_at(sections, static_cast<int>(i), row[i]);
    }
  });
  const double steps = mean_mm / sections.station_mm;
  mm2 = geometry::running_mean(mm2, steps);
  counted = geometry::running_mean(counted, steps);
  round_mm = geometry::running_mean(round_mm, steps);
  const auto beside = static_cast<std::size_t>(std::lround(k_beside_filled_mm / sections.station_mm));
  for (std::size_t i = 0; i < stations; ++i) {
    for (std::size_t k = 0; k <= 2 * beside; ++k)
      noise[i].filled_mm = std::max(noise[i].filled_mm, filled_mm[(i + stations + k - beside) % stations]);
    noise[i].outward_mm = std::sqrt(std::max(mm2[i], 0.0) / std::max(counted[i], 1 / steps));
    noise[i].round_mm = round_mm[i];
  }
  return noise;
}

}  // namespace biteline::bite_line
