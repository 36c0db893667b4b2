// SPDX-License-Identifier: MIT
#include "host/second_look/raster.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace biteline::second_look {
namespace {

/// A point of a scan on the raster's ways.
struct Landed {
  std::size_t point;
  double along_mm, across_mm, out_mm;
};

std::vector<Landed> landed_points(const cloud::PointCloud& cloud, const LineFrame& frame,
                                  const SurfaceWays& ways, const RasterWish& wish) {
  std::vector<Landed> landed;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (wish.stripe && (cloud.amplitude[i] <= 0 || cloud.width_px[i] <= 0)) continue;
    LineFrame::Place place;
    if (!frame.place(cloud.points[i].cast<double>(), wish.reach_mm, place)) continue;
    const double across_mm = ways.way_mm(place.station, place.up_mm);
    const double cell = std::floor((across_mm - wish.across.low_mm) / k_cell_mm);
    if (cell < 0 || cell >= static_cast<double>(wish.across.cells)) continue;
    landed.push_back({.point = i,
                      .along_mm = static_cast<double>(place.station) * frame.step_mm() + place.along_mm,
                      .across_mm = across_mm,
                      .out_mm = place.out_mm});
  }
  return landed;
}

/// Rows by profile: which one each profile is, and where.  Where profiles are too far apart, empty rows are
/// between.
struct ProfileRows {
  std::map<std::uint32_t, std::size_t> row{};
  std::vector<double> along_mm{};
};

ProfileRows profile_rows(const cloud::PointCloud& cloud, const std::vector<Landed>& landed,
                         double length_mm) {
  struct Mean {
    double first_mm{0}, sum_mm{0}, count{0};
  };
  std::map<std::uint32_t, Mean> means;
  for (const Landed& p : landed) {
    Mean& mean = means[cloud.profile[p.point]];
    if (mean.count == 0) mean.first_mm = p.along_mm;
    mean.sum_mm += std::remainder(p.along_mm - mean.first_mm, length_mm);
    mean.count += 1;
  }
  std::vector<std::pair<double, std::uint32_t>> sorted;
  for (const auto& [profile, mean] : means)
    sorted.emplace_back(std::fmod(mean.first_mm + mean.sum_mm / mean.count + length_mm, length_mm), profile);
  std::ranges::sort(sorted);
  ProfileRows rows;
  const auto fill_up_to = [&](double next_mm) {
    const double last_mm = rows.along_mm.empty() ? 0 : rows.along_mm.back();
    if (next_mm - last_mm <= k_most_apart_mm) return;
    for (double mm = last_mm + k_station_mm; mm < next_mm - k_station_mm / 2; mm += k_station_mm)
      rows.along_mm.push_back(mm);
  };
  for (const auto& [along_mm, profile] : sorted) {
    fill_up_to(along_mm);
    rows.row[profile] = rows.along_mm.size();
    rows.along_mm.push_back(along_mm);
  }
  fill_up_to(length_mm);
  return rows;
}

}  // namespace

Raster raster_of(const cloud::PointCloud& cloud, const LineFrame& frame, const SurfaceWays& ways,
                 const RasterWish& wish) {
  const std::vector<Landed> landed = landed_points(cloud, frame, ways, wish);
  Raster raster{.across = wish.across};
  ProfileRows profiles;
  if (wish.by_profile) {
    profiles = profile_rows(cloud, landed, frame.length_mm());
    raster.along_mm = profiles.along_mm;
  } else {
    for (std::size_t i = 0; i < frame.size(); ++i)
      raster.along_mm.push_back(static_cast<double>(i) * frame.step_mm());
  }
  const std::size_t cells = raster.rows() * wish.across.cells;
  raster.count.assign(cells, 0.0F);
  raster.sum.assign(cells, {});
  raster.clipped.assign(cells, 0.0F);
  raster.square_sum.assign(cells, {});
  raster.across_sum_mm.assign(cells, 0.0F);
  raster.along_sum_mm.assign(cells, 0.0F);
  const float brightest = wish.stripe && !landed.empty() ? *std::ranges::max_element(cloud.amplitude) : 0;
  for (const Landed& p : landed) {
    const std::size_t row =
        wish.by_profile ? profiles.row[cloud.profile[p.point]] : frame.nearest(std::max(0.0, p.along_mm));
    const double cell = std::floor((p.across_mm - wish.across.low_mm) / k_cell_mm);
    const std::size_t k = raster.at(row, static_cast<std::size_t>(cell));
    raster.count[k] += 1;
    raster.across_sum_mm[k] += static_cast<float>(p.across_mm - wish.across.mm(cell + 0.5));
    raster.along_sum_mm[k] +=
        static_cast<float>(std::remainder(p.along_mm - raster.along_mm[row], frame.length_mm()));
    const auto add = [&](Channel c, float value) {
      raster.sum[k][c] += value;
      raster.square_sum[k][c] += value * value;
    };
    add(k_height, static_cast<float>(p.out_mm));
    if (!wish.stripe) continue;
    raster.clipped[k] += cloud.amplitude[p.point] >= brightest ? 1 : 0;
    add(k_log_amplitude, std::log(cloud.amplitude[p.point]));
    add(k_log_width, std::log(cloud.width_px[p.point]));
  }
  return raster;
}

}  // namespace biteline::second_look
