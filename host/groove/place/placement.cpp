// SPDX-License-Identifier: MIT
#include "host/groove/place/placement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <tbb/parallel_for.h>

#include "host/groove/place/path_curve.hpp"
#include "host/groove/place/ridge.hpp"
#include "host/groove/place/sections.hpp"

namespace biteline::groove {

namespace {

/// Replaces the rows of invisible stations by straight lines between visible ones; distance to the nearest
/// visible.
std::vector<double> bridge(std::vector<double>& row, std::span<const std::uint8_t> visible,
                           double station_mm) {
  const std::size_t count = row.size();
  std::vector<double> distance(count, 1e9);
  const auto first = static_cast<std::size_t>(std::find(visible.begin(), visible.end(), 1) - visible.begin());
  if (first == count) return distance;
  std::size_t last = first;
  distance[first] = 0;
  for (std::size_t k = 1; k <= count; ++k) {
    const std::size_t i = (first + k) % count;
    if (visible[i] == 0) continue;
    distance[i] = 0;
    std::size_t gap = (i + count - last) % count;
    if (gap == 0) gap = count;
    for (std::size_t j = 1; j < gap; ++j) {
      const std::size_t between = (last + j) % count;
      row[between] = row[last] + (row[i] - row[last]) * static_cast<double>(j) / static_cast<double>(gap);
      distance[between] = static_cast<double>(std::min(j, gap - j)) * station_mm;
    }
    last = i;
  }
  return distance;
}

/// Mean over `window_mm`, closed; fractional at the ends so that the window is exact.
std::vector<double> running_mean(std::span<const double> values, double window_mm, double step_mm) {
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  const double half = 0.5 * window_mm / step_mm;
  const auto whole = static_cast<std::ptrdiff_t>(half);
  const double edge = half - static_cast<double>(whole);
  std::vector<double> mean(values.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    double sum = 0;
    double weight = 0;
    for (std::ptrdiff_t j = -whole - 1; j <= whole + 1; ++j) {
      const double w = std::abs(j) <= whole ? 1.0 : edge;
      sum += w * values[static_cast<std::size_t>(((i + j) % count + count) % count)];
      weight += w;
    }
    mean[static_cast<std::size_t>(i)] = sum / weight;
  }
  return mean;
}

std::optional<double> o_at(const Sections& sections, int station, double row) {
  const int below = static_cast<int>(std::floor(row));
  if (below < 0 || below + 1 >= sections.rows) return std::nullopt;
  if (sections.known[sections.at(station, below)] == 0 ||
      sections.known[sections.at(station, below + 1)] == 0)
    return std::nullopt;
  const double fraction = row - below;
  return (1 - fraction) * static_cast<double>(sections.o_mm[sections.at(station, below)]) +
         fraction * static_cast<double>(sections.o_mm[sections.at(station, below + 1)]);
}

/// Normal of the surface above the line: slopes along and up from a plane fitted to the sections around.
std::optional<Vec3> normal_above(const Sections& sections, const Outline& outline, int station, double row,
                                 const PlacementConfig& config) {
  const auto rows_of = [&](double mm) { return static_cast<int>(std::lround(mm / sections.row_mm)); };
  const int from = static_cast<int>(std::lround(row)) + rows_of(config.normal_from_mm);
  const int to =
      std::min(sections.rows - 1, static_cast<int>(std::lround(row)) + rows_of(config.normal_to_mm));
  const int around = std::max(1, static_cast<int>(std::lround(0.5 / sections.station_mm)));
  const double s_here = station * sections.station_mm;
  const Vec2 out = outline.normal(s_here);
  const Vec2 along{-out.y(), out.x()};
  // Per height o = a + b s + c z over half a millimetre either way (the sections are weighted over more
  // already); normals of patches a millimetre high are averaged, as the surface bends within the 4 mm.
  const int patch = std::max(2, rows_of(1.0));
  Vec3 sum = Vec3::Zero();
  for (int low = from; low + patch / 2 <= to; low += patch) {
    Mat3 A = Mat3::Zero();
    Vec3 b = Vec3::Zero();
    double bend_o = 0;
    double count = 0;
    for (int j = -around; j <= around; ++j) {
      const int other = ((station + j) % sections.stations + sections.stations) % sections.stations;
      const double dz_path = sections.path_z_mm[static_cast<std::size_t>(other)] -
                             sections.path_z_mm[static_cast<std::size_t>(station)];
      for (int r = low; r < std::min(low + patch, to + 1); r += 2) {
        const std::size_t cell = sections.at(other, r);
        if (sections.known[cell] == 0) continue;
        const Vec3 x{1.0, j * sections.station_mm, (r - low) * sections.row_mm + dz_path};
        A += x * x.transpose();
        b += x * static_cast<double>(sections.o_mm[cell]);
        bend_o += static_cast<double>(sections.o_mm[cell]);
        count += 1;
      }
    }
    if (count < 0.5 * (2 * around + 1) * patch / 2) continue;
    A += 1e-9 * Mat3::Identity();
    const Vec3 x = A.ldlt().solve(b);
    const double stretch = std::max(0.3, 1.0 + outline.bend_per_mm(s_here) * bend_o / count);
    Vec3 normal{0, 0, -x[2]};
    normal.head<2>() = out - x[1] / stretch * along;
    sum += normal.normalized();
  }
  if (sum.norm() < 1e-6) return std::nullopt;
  return sum.normalized();
}

}  // namespace

std::vector<std::uint32_t> near_path(const SideField& field, const Crease& crease) {
  // The sections' own reach and the millimetre that the smoothed path may lie off its columns.
  const double below_mm = SectionConfig{}.below_mm + 1.0;
  const double above_mm = SectionConfig{}.above_mm + 1.0;
  std::vector<std::uint32_t> near;
  near.reserve(field.places.size() / 3);
  const SideGrid& grid = field.grid;
  for (std::size_t i = 0; i < field.places.size(); ++i) {
    const Place& place = field.places[i];
    if (place.s_mm < 0) continue;
    const int col = std::min(grid.cols - 1, static_cast<int>(static_cast<double>(place.s_mm) / grid.col_mm));
    const double path_z_mm = grid.z_mm(crease.row[static_cast<std::size_t>(col)]);
    const double above_path_mm = static_cast<double>(place.z_mm) - path_z_mm;
    if (above_path_mm > -below_mm && above_path_mm < above_mm)
      near.push_back(static_cast<std::uint32_t>(i));
  }
  return near;
}

Placement place_line(const PlacementInput& input, const PlacementConfig& config) {
  Placement placement;
  const PathCurve curve = curve_of(input.field, input.outline, input.crease);
  const Outline path_outline{curve.plan, {.spacing_mm = 0.5, .smoothing_mm = 4.0, .reach_mm = 18.0}};
  const auto stations =
      static_cast<std::size_t>(std::max(32.0, std::round(path_outline.length_mm() / config.spacing_mm)));
  const std::vector<double> path_z = heights_at_stations(curve, path_outline, stations);

  // About six points within the definition's Gaussian and these weights (areas 1.0 mm by 2.5 sigma), at least
  // two profiles of a usual scan.
  const double sigma_s = std::clamp(6.0 / (2.5 * std::max(input.points_per_mm2, 0.1)), 0.7, 2.0);
  const Sections sections = cut_sections(
      {.points = input.near, .outline = path_outline, .path_z_mm = path_z, .sigma_s_mm = sigma_s}, {});
  const std::vector<float> k = section_curvature(sections, config.smoothing_mm);
  Ridge ridge = follow_ridge(sections, k, config.search_mm);
  const std::vector<double> raw_row = ridge.row;
  const std::vector<double> to_visible = bridge(ridge.row, ridge.visible, sections.station_mm);
  const std::vector<double> row = running_mean(ridge.row, config.mean_mm, sections.station_mm);

  std::vector<double> o(stations, 0.0);
  std::vector<std::uint8_t> o_known(stations, 0);
  std::vector<std::optional<Vec3>> normals(stations);
  tbb::parallel_for(std::size_t{0}, stations, [&](std::size_t i) {
    if (const auto value = o_at(sections, static_cast<int>(i), row[i])) {
      o[i] = *value;
      o_known[i] = 1;
    }
    normals[i] = normal_above(sections, path_outline, static_cast<int>(i), row[i], config);
  });
  bridge(o, o_known, sections.station_mm);
  std::vector<std::vector<double>> n(3, std::vector<double>(stations, 0.0));
  std::vector<std::uint8_t> n_known(stations, 0);
  for (std::size_t i = 0; i < stations; ++i) {
    n_known[i] = normals[i] ? 1 : 0;
    for (int axis = 0; axis < 3; ++axis)
      n[static_cast<std::size_t>(axis)][i] = normals[i] ? (*normals[i])[axis] : 0.0;
  }
  for (auto& component : n) bridge(component, n_known, sections.station_mm);

  placement.points.resize(stations);
  for (std::size_t i = 0; i < stations; ++i) {
    PlacedPoint& point = placement.points[i];
    const double s = static_cast<double>(i) * sections.station_mm;
    const Vec2 out = path_outline.normal(s);
    const Vec2 plan = path_outline.point(s) + o[i] * out;
    point.position = {plan.x(), plan.y(), path_z[i] + sections.z_mm(row[i])};
    Vec3 normal{n[0][i], n[1][i], n[2][i]};
    if (normal.norm() < 0.1) normal = {out.x(), out.y(), 0};
    point.normal = normal.normalized();
    point.curvature_per_mm = ridge.k_per_mm[i];
    point.scatter_mm = std::abs(raw_row[i] - row[i]) * sections.row_mm;
    point.to_visible_mm = to_visible[i];
  }
  for (std::size_t i = 0; i < stations; ++i) {
    const double step = (placement.points[(i + 1) % stations].position - placement.points[i].position).norm();
    placement.length_mm += step;
    if (placement.points[i].to_visible_mm > 0) placement.bridged_mm += step;
  }
  return placement;
}

}  // namespace biteline::groove
