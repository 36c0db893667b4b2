// SPDX-License-Identifier: MIT
#include "host/bite_line/place/ridge.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "common/core/contracts.hpp"
#include "host/bite_line/place/closed_path.hpp"
#include "host/bite_line/simd_kernels.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::bite_line {

namespace {

/// Weights that add up to 1.
std::vector<float> unit_gaussian(double sigma) {
  std::vector<float> kernel = gaussian(sigma, 4);
  const float sum = std::accumulate(kernel.begin(), kernel.end(), 0.0F);
  for (float& weight : kernel) weight /= sum;
  return kernel;
}

/// Typical size of the sections' curvature outside the search range: texture and noise.
double curvature_noise(const Sections& sections, std::span<const float> k, double search_mm) {
  std::vector<double> values;
  const int reach = static_cast<int>(std::lround(search_mm / sections.row_mm));
  for (int station = 0; station < sections.stations; station += 7) {
    for (int row = sections.zero_row + reach + 10; row < sections.rows - 10; row += 5) {
      const std::size_t cell = sections.at(station, row);
      if (sections.known[cell] != 0) values.push_back(std::abs(static_cast<double>(k[cell])));
    }
  }
  if (values.empty()) return 0;
  return geometry::median_of(std::span<double>{values});
}

/// The surface is known at a crease and a millimetre either way: where a section ends, its curvature is that
/// of nothing.
bool seen_both_sides(const Sections& sections, int station, int row) {
  const int reach = static_cast<int>(std::lround(1.0 / sections.row_mm));
  for (const int r : {row - reach, row - reach / 2, row, row + reach / 2, row + reach}) {
    if (r < 0 || r >= sections.rows || sections.known[sections.at(station, r)] == 0) return false;
  }
  return true;
}

/// What stands out above a hollow by more than it is high hides it: points in it are another layer's.
bool hidden(const Sections& sections, int station, int row) {
  constexpr float k_above_mm = 1.0F;
  const int above = row + static_cast<int>(std::lround(k_above_mm / static_cast<float>(sections.row_mm)));
  return sections.o_mm[sections.at(station, above)] - sections.o_mm[sections.at(station, row)] > k_above_mm;
}

/// Room for one run of rows.
struct Smoothed {
  std::vector<float> padded, rows;
};

/// Of rows that are all known, but for the first and the last one, which are left as they are.  Beyond its
/// ends the run goes on straight, with the slope of its last millimetre.  `h`: from row to row, mm.
void curvatures_of_run(std::span<const float> o, std::span<const float> kernel, double h, Smoothed& smoothed,
                       float* k) {
  const std::size_t beyond = kernel.size() / 2;
  const std::size_t count = o.size();
  const std::size_t lever = std::min(count - 1, static_cast<std::size_t>(1.0 / h));
  const float slope_low = (o[lever] - o[0]) / static_cast<float>(lever);
  const float slope_high = (o[count - 1] - o[count - 1 - lever]) / static_cast<float>(lever);
  smoothed.padded.resize(count + 2 * beyond);
  smoothed.rows.resize(count);
  for (std::size_t i = 0; i < beyond; ++i) {
    smoothed.padded[i] = o[0] - slope_low * static_cast<float>(beyond - i);
    smoothed.padded[beyond + count + i] = o[count - 1] + slope_high * static_cast<float>(i + 1);
  }
  std::copy(o.begin(), o.end(), smoothed.padded.begin() + static_cast<std::ptrdiff_t>(beyond));
  convolve(smoothed.rows, smoothed.padded.data(), kernel);
  curvatures({k + 1, count - 2}, smoothed.rows.data(), static_cast<float>(1.0 / h));
}

struct Other {
  double k_per_mm{0};
  double away_mm{0};
};

/// The sharpest top of a section's curvature from row `low` to `end`, away from that at `own`.
Other other_hollow(const Sections& sections, std::span<const float> k, int station, int own, int low,
                   int end) {
  constexpr double k_apart_mm = 1.0;
  const int apart = static_cast<int>(std::lround(k_apart_mm / sections.row_mm));
  const auto value = [&](int row) { return k[sections.at(station, row)]; };
  int best = -1;
  for (int row = std::max(low, 1); row < std::min(end, sections.rows - 1); ++row) {
    if (std::abs(row - own) < apart || value(row) < value(row - 1) || value(row) < value(row + 1)) continue;
    if (value(row) > (best < 0 ? 0.0F : value(best)) && seen_both_sides(sections, station, row) &&
        !hidden(sections, station, row))
      best = row;
  }
  if (best < 0) return {};
  const auto out_mm = static_cast<double>(sections.o_mm[sections.at(station, best)] -
                                          sections.o_mm[sections.at(station, own)]);
  return {.k_per_mm = static_cast<double>(value(best)),
          .away_mm = std::hypot(out_mm, (best - own) * sections.row_mm)};
}

}  // namespace

PooledVector<float> section_curvature(const Sections& sections, double sigma_mm,
                                      std::span<const double> upright_ratio) {
  BITELINE_EXPECTS(upright_ratio.empty() ||
                   upright_ratio.size() == static_cast<std::size_t>(sections.stations));
  PooledVector<float> k(sections.o_mm.size());
  const auto rows = static_cast<std::size_t>(sections.rows);
  tbb::parallel_for(tbb::blocked_range<int>{0, sections.stations, 16}, [&](const auto& range) {
    Smoothed smoothed;
    for (int station = range.begin(); station != range.end(); ++station) {
      const double h =
          sections.row_mm / (upright_ratio.empty() ? 1.0 : upright_ratio[static_cast<std::size_t>(station)]);
      const std::vector<float> kernel = unit_gaussian(sigma_mm / h);
      const std::size_t first = sections.at(station, 0);
      const std::span o{sections.o_mm.data() + first, rows};
      const std::uint8_t* known = sections.known.data() + first;
      std::fill_n(k.data() + first, rows, 0.0F);
      // A shadow parts a section; the crease may lie in any of its parts.
      for (std::size_t begin = 0, end = 0; begin < rows; begin = end + 1) {
        for (end = begin; end < rows && known[end] != 0;) ++end;
        if (end - begin > kernel.size() / 2)
          curvatures_of_run(o.subspan(begin, end - begin), kernel, h, smoothed, k.data() + first + begin);
      }
    }
  });
  return k;
}

Ridge follow_ridge(const Sections& sections, std::span<const float> k, double search_mm) {
  const int reach = static_cast<int>(std::lround(search_mm / sections.row_mm));
  const int low = sections.zero_row - reach;
  const int rows = 2 * reach + 1;
  const auto stations = static_cast<std::size_t>(sections.stations);
  const auto for_stations = [&](auto&& work) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>{0, stations, 64}, [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) work(i);
    });
  };
  std::vector<double> peaks(stations);
  for_stations([&](std::size_t i) {
    const float* line = k.data() + sections.at(static_cast<int>(i), low);
    peaks[i] = static_cast<double>(*std::max_element(line, line + rows));
  });
  const double usual = geometry::median_of(peaks);
  const double noise = curvature_noise(sections, k, search_mm);

  // Each station counts by its own peak, so that a filled stretch's weak fillet is followed too; where
  // nothing but noise is left, continuity decides.
  const double floor = std::max({k_least_curvature_per_mm, 0.02 * usual, 2 * noise});
  PooledVector<float> cost(static_cast<std::size_t>(rows) * stations);
  for_stations([&](std::size_t i) {
    const auto per_peak = static_cast<float>(1 / std::max(peaks[i], floor));
    const float* line = k.data() + sections.at(static_cast<int>(i), low);
    std::transform(line, line + rows, cost.begin() + static_cast<std::ptrdiff_t>(i) * rows,
                   [&](float value) { return 1.0F - std::max(value * per_peak, 0.0F); });
  });
  const ClosedPath path =
      shortest_closed_path(cost, rows, sections.stations, {.max_step_rows = 3, .step_cost = 0.03});

  Ridge ridge;
  ridge.row.resize(stations);
  ridge.k_per_mm.resize(stations);
  ridge.visible.assign(stations, 0);
  ridge.other_k_per_mm.assign(stations, 0);
  ridge.other_mm.assign(stations, 0);
  for_stations([&](std::size_t i) {
    // The path may cut a corner of the ridge: climb to the top next to it.
    int row = low + path.row[i];
    const auto value = [&](int r) { return static_cast<double>(k[sections.at(static_cast<int>(i), r)]); };
    const int most = static_cast<int>(0.4 / sections.row_mm);
    for (int step = 0; step < most; ++step) {
      if (row > low && value(row - 1) > value(row))
        --row;
      else if (row < low + rows - 1 && value(row + 1) > value(row))
        ++row;
      else
        break;
    }
    const double top = value(row);
    const double bow = value(row - 1) - 2 * top + value(row + 1);
    ridge.row[i] =
        row + (bow < -1e-9 ? std::clamp(0.5 * (value(row - 1) - value(row + 1)) / bow, -0.5, 0.5) : 0.0);
    ridge.k_per_mm[i] = top;
    ridge.visible[i] = top > std::max(k_least_curvature_per_mm, 2 * noise) &&
                               seen_both_sides(sections, static_cast<int>(i), row)
                           ? 1
                           : 0;
    if (ridge.visible[i] == 0) return;
    const Other other = other_hollow(sections, k, static_cast<int>(i), row, low, low + rows);
    ridge.other_k_per_mm[i] = other.k_per_mm;
    ridge.other_mm[i] = other.away_mm;
  });
  return ridge;
}

}  // namespace biteline::bite_line
