// SPDX-License-Identifier: MIT
#include "host/groove/place/sections.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace biteline::groove {

namespace {

constexpr double k_longest_filled_mm = 1.5;  // a shadow longer than this hides the groove
constexpr double k_reach_o_mm = 14.0;

/// Sums of weight, s, s^2, o, s o of the points in one bin; s from the bin's middle.
struct Bin {
  float w{0}, s{0}, ss{0}, o{0}, so{0};
};

std::vector<float> gaussian(double sigma, double step) {
  const int reach = static_cast<int>(std::ceil(3.5 * sigma / step));
  std::vector<float> kernel;
  for (int j = -reach; j <= reach; ++j)
    kernel.push_back(static_cast<float>(std::exp(-0.5 * std::pow(j * step / sigma, 2))));
  return kernel;
}

/// Where one point falls.
struct Landing {
  std::int32_t cell{-1};
  float s_mm{0};
  float o_mm{0};
};

Landing land(const SectionInput& input, const SectionConfig& config, const Sections& sections,
             const Eigen::Vector3f& p) {
  const Outline::Foot foot = input.outline.locate(p.x(), p.y());
  if (!foot.valid || std::abs(static_cast<double>(foot.o_mm)) > k_reach_o_mm) return {};
  const double at = static_cast<double>(foot.s_mm) * sections.stations / input.outline.length_mm();
  const auto nearest = static_cast<int>(at + 0.5);
  // The path's height at the point's own s, so that a sloping path leaves the sections level.
  const int before = static_cast<int>(at);
  const double z0 = input.path_z_mm[static_cast<std::size_t>(before % sections.stations)];
  const double z1 = input.path_z_mm[static_cast<std::size_t>((before + 1) % sections.stations)];
  const double z = static_cast<double>(p.z()) - (z0 + (at - before) * (z1 - z0));
  const int row = static_cast<int>(std::floor(z / config.row_mm + 0.5)) + sections.zero_row;
  if (row < 0 || row >= sections.rows) return {};
  return {static_cast<std::int32_t>(sections.at(nearest % sections.stations, row)),
          static_cast<float>((at - nearest) * sections.station_mm), foot.o_mm};
}

std::vector<Bin> collect(const SectionInput& input, const SectionConfig& config, const Sections& sections) {
  std::vector<Landing> landings(input.points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, input.points.size(), 4096}, [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      landings[i] = land(input, config, sections, input.points[i]);
  });
  std::vector<Bin> bins(static_cast<std::size_t>(sections.stations) *
                        static_cast<std::size_t>(sections.rows));
  for (const Landing& landing : landings) {
    if (landing.cell < 0) continue;
    Bin& bin = bins[static_cast<std::size_t>(landing.cell)];
    bin.w += 1.0F;
    bin.s += landing.s_mm;
    bin.ss += landing.s_mm * landing.s_mm;
    bin.o += landing.o_mm;
    bin.so += landing.s_mm * landing.o_mm;
  }
  return bins;
}

/// Straight lines across gaps within the section; beyond its ends nothing.
void fill_gaps(Sections& sections, int station) {
  const int longest = static_cast<int>(k_longest_filled_mm / sections.row_mm);
  int last = -1;
  for (int row = 0; row < sections.rows; ++row) {
    const std::size_t cell = sections.at(station, row);
    if (sections.known[cell] == 0) continue;
    if (last >= 0 && row - last > 1 && row - last <= longest) {
      const float o0 = sections.o_mm[sections.at(station, last)];
      const float slope = (sections.o_mm[cell] - o0) / static_cast<float>(row - last);
      for (int r = last + 1; r < row; ++r) {
        sections.o_mm[sections.at(station, r)] = o0 + slope * static_cast<float>(r - last);
        sections.known[sections.at(station, r)] = 1;
      }
    }
    last = row;
  }
}

}  // namespace

Sections cut_sections(const SectionInput& input, const SectionConfig& config) {
  Sections sections;
  sections.stations = static_cast<int>(input.path_z_mm.size());
  sections.station_mm = input.outline.length_mm() / sections.stations;
  sections.row_mm = config.row_mm;
  sections.zero_row = static_cast<int>(std::lround(config.below_mm / config.row_mm));
  sections.rows = sections.zero_row + static_cast<int>(std::lround(config.above_mm / config.row_mm)) + 1;
  sections.path_z_mm.assign(input.path_z_mm.begin(), input.path_z_mm.end());
  sections.o_mm.assign(static_cast<std::size_t>(sections.stations) * static_cast<std::size_t>(sections.rows),
                       0.0F);
  sections.known.assign(sections.o_mm.size(), 0);

  const std::vector<Bin> bins = collect(input, config, sections);
  const std::vector<float> along = gaussian(input.sigma_s_mm, sections.station_mm);
  const std::vector<float> up = gaussian(config.sigma_z_mm, config.row_mm);
  const auto reach_s = static_cast<int>(along.size() / 2);
  const auto reach_z = static_cast<int>(up.size() / 2);
  const auto rows = static_cast<std::size_t>(sections.rows);
  constexpr float k_least_weight = 0.05F;
  tbb::parallel_for(tbb::blocked_range<int>{0, sections.stations, 16}, [&](const auto& range) {
    std::vector<Bin> column(rows);
    for (int station = range.begin(); station != range.end(); ++station) {
      std::fill(column.begin(), column.end(), Bin{});
      for (int j = -reach_s; j <= reach_s; ++j) {
        const int other = ((station + j) % sections.stations + sections.stations) % sections.stations;
        const Bin* source = bins.data() + sections.at(other, 0);
        const float g = along[static_cast<std::size_t>(j + reach_s)];
        const auto shift = static_cast<float>(j * sections.station_mm);
        for (std::size_t r = 0; r < rows; ++r) {
          const Bin& b = source[r];
          if (b.w == 0.0F) continue;
          column[r].w += g * b.w;
          column[r].s += g * (b.s + shift * b.w);
          column[r].ss += g * (b.ss + 2 * shift * b.s + shift * shift * b.w);
          column[r].o += g * b.o;
          column[r].so += g * (b.so + shift * b.o);
        }
      }
      for (int row = 0; row < sections.rows; ++row) {
        Bin sum;
        for (int j = -reach_z; j <= reach_z; ++j) {
          const int other = row + j;
          if (other < 0 || other >= sections.rows) continue;
          const float g = up[static_cast<std::size_t>(j + reach_z)];
          const Bin& b = column[static_cast<std::size_t>(other)];
          sum.w += g * b.w;
          sum.s += g * b.s;
          sum.ss += g * b.ss;
          sum.o += g * b.o;
          sum.so += g * b.so;
        }
        if (sum.w < k_least_weight) continue;
        // Straight line in s through the weighted points, taken at the station; where all lie on one profile,
        // their mean.
        const float det = sum.w * sum.ss - sum.s * sum.s;
        const float spread = det / (sum.w * sum.w);
        const std::size_t cell = sections.at(station, row);
        sections.o_mm[cell] = spread > 0.04F ? (sum.o * sum.ss - sum.so * sum.s) / det : sum.o / sum.w;
        sections.known[cell] = 1;
      }
      fill_gaps(sections, station);
    }
  });
  return sections;
}

}  // namespace biteline::groove
