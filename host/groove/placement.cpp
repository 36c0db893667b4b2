// SPDX-License-Identifier: MIT
#include "host/groove/placement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "host/groove/closed_path.hpp"
#include "host/groove/sections.hpp"

namespace biteline::groove {

namespace {

/// The curve of a crease in plan, and the height along it.
struct PathCurve {
  std::vector<Vec2> plan;
  std::vector<double> z_mm;
};

/// Cubic between two points with given derivatives per step (Hermite), at `t` of `span` steps.
Vec3 hermite(const Vec3& p0, const Vec3& d0, const Vec3& p1, const Vec3& d1, double t, double span) {
  const double u = t / span;
  const double u2 = u * u;
  const double u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * p0 + (u3 - 2 * u2 + u) * span * d0 + (3 * u2 - 2 * u3) * p1 + (u3 - u2) * span * d1;
}

/// The path in 3-D; where its surface was not seen it goes on as a cubic that leaves both ends in their own directions,
/// since a chord would cut off the curve of a toe.
PathCurve curve_of(const SideField& field, const Outline& outline, const Crease& crease) {
  const SideGrid& grid = field.grid;
  const auto cols = static_cast<std::ptrdiff_t>(grid.cols);
  const auto wrap = [&](std::ptrdiff_t c) { return static_cast<std::size_t>((c % cols + cols) % cols); };
  std::vector<Vec3> points(static_cast<std::size_t>(cols), Vec3::Zero());
  std::vector<bool> seen(static_cast<std::size_t>(cols), false);
  for (std::ptrdiff_t c = 0; c < cols; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const int row = std::clamp(static_cast<int>(std::lround(crease.row[i])), 0, grid.rows - 1);
    const std::size_t cell = grid.at(row, static_cast<int>(c));
    seen[i] = field.seen[cell] != 0;
    const double s = (static_cast<double>(c) + 0.5) * grid.col_mm;
    const Vec2 plan = outline.point(s) + static_cast<double>(field.o_mm[cell]) * outline.normal(s);
    points[i] = {plan.x(), plan.y(), grid.z_mm(crease.row[i])};
  }
  // The columns beside a gap lean on points from one side only.
  const auto margin = static_cast<std::ptrdiff_t>(std::ceil(3.0 / grid.col_mm));
  std::vector<bool> known = seen;
  for (std::ptrdiff_t c = 0; c < cols; ++c) {
    if (seen[wrap(c)]) continue;
    for (std::ptrdiff_t j = -margin; j <= margin; ++j) known[wrap(c + j)] = false;
  }
  const auto lever = static_cast<std::ptrdiff_t>(std::ceil(12.0 / grid.col_mm));
  for (std::ptrdiff_t c = 0; c < cols; ++c) {
    if (!known[wrap(c)] || known[wrap(c + 1)]) continue;
    std::ptrdiff_t end = c + 1;
    while (end < c + cols && !known[wrap(end)]) ++end;
    if (end >= c + cols) break;
    // Directions over 12 mm outside the gap, turned on by the bend over those 12 mm to stand at the gap's edge.
    const auto direction = [&](std::ptrdiff_t at, std::ptrdiff_t away) {
      const Vec3 near = points[wrap(at)] - points[wrap(at + away * lever / 2)];
      const Vec3 far = points[wrap(at + away * lever / 2)] - points[wrap(at + away * lever)];
      return Vec3{(1.5 * near - 0.5 * far) / (0.5 * static_cast<double>(lever))};
    };
    const Vec3& p0 = points[wrap(c)];
    const Vec3& p1 = points[wrap(end)];
    Vec3 d0 = direction(c, -1);
    Vec3 d1 = -direction(end, +1);
    // Steps across the gap are as long as its chord asks for, not as those outside.
    const auto span = static_cast<double>(end - c);
    const double step = 1.05 * (p1 - p0).norm() / span;
    if (d0.norm() > 1e-9) d0 *= step / d0.norm();
    if (d1.norm() > 1e-9) d1 *= step / d1.norm();
    for (std::ptrdiff_t j = c + 1; j < end; ++j) points[wrap(j)] = hermite(p0, d0, p1, d1, static_cast<double>(j - c), span);
    c = end - 1;
  }
  PathCurve curve;
  for (const Vec3& p : points) {
    curve.plan.push_back(p.head<2>());
    curve.z_mm.push_back(p.z());
  }
  return curve;
}

/// Height of a path given at scattered s, at evenly spaced stations of its own outline.
std::vector<double> heights_at_stations(const PathCurve& curve, const Outline& path_outline, std::size_t stations) {
  struct Sample {
    double s, z;
  };
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < curve.plan.size(); ++i) {
    const auto foot = path_outline.locate(static_cast<float>(curve.plan[i].x()), static_cast<float>(curve.plan[i].y()));
    if (foot.valid) samples.push_back({static_cast<double>(foot.s_mm), curve.z_mm[i]});
  }
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.s < b.s; });
  const double length = path_outline.length_mm();
  samples.insert(samples.begin(), {samples.back().s - length, samples.back().z});
  samples.push_back({samples[1].s + length, samples[1].z});
  std::vector<double> z(stations);
  std::size_t k = 0;
  for (std::size_t i = 0; i < stations; ++i) {
    const double s = length * static_cast<double>(i) / static_cast<double>(stations);
    while (k + 2 < samples.size() && samples[k + 1].s <= s) ++k;
    const double span = std::max(samples[k + 1].s - samples[k].s, 1e-9);
    z[i] = samples[k].z + std::clamp((s - samples[k].s) / span, 0.0, 1.0) * (samples[k + 1].z - samples[k].z);
  }
  return smooth_closed(z, 3.0 / (length / static_cast<double>(stations)));
}

/// Curvature of every section at every row: o smoothed by the definition's Gaussian, then k = o'' / (1 + o'^2)^1.5.
/// Gaussian and its derivatives are folded into one pass; unknown rows leave k at 0.
std::vector<float> section_curvature(const Sections& sections, double sigma_mm) {
  std::vector<float> k(sections.o_mm.size(), 0.0F);
  const double h = sections.row_mm;
  const int reach = static_cast<int>(std::ceil(4 * sigma_mm / h));
  std::vector<float> g0;
  double sum = 0;
  for (int j = -reach; j <= reach; ++j) {
    g0.push_back(static_cast<float>(std::exp(-0.5 * std::pow(j * h / sigma_mm, 2))));
    sum += static_cast<double>(g0.back());
  }
  for (float& g : g0) g /= static_cast<float>(sum);
  const auto rows = static_cast<std::size_t>(sections.rows);
  tbb::parallel_for(tbb::blocked_range<int>{0, sections.stations, 16}, [&](const auto& range) {
    std::vector<float> padded(rows + 2 * static_cast<std::size_t>(reach));
    std::vector<float> smooth(rows);
    for (int station = range.begin(); station != range.end(); ++station) {
      const float* o = sections.o_mm.data() + sections.at(station, 0);
      const std::uint8_t* known = sections.known.data() + sections.at(station, 0);
      // The longest known run; outside it the end values go on.
      std::size_t begin = 0;
      std::size_t end = 0;
      for (std::size_t r = 0; r < rows;) {
        if (known[r] == 0) {
          ++r;
          continue;
        }
        std::size_t stop = r;
        while (stop < rows && known[stop] != 0) ++stop;
        if (stop - r > end - begin) {
          begin = r;
          end = stop;
        }
        r = stop;
      }
      if (end - begin < 2 * static_cast<std::size_t>(reach) / 2) continue;
      // Beyond the run's ends it goes on straight, with the slope of its last millimetre.
      const std::size_t lever = std::min<std::size_t>(end - begin - 1, static_cast<std::size_t>(1.0 / h));
      const float slope_low = (o[begin + lever] - o[begin]) / static_cast<float>(lever);
      const float slope_high = (o[end - 1] - o[end - 1 - lever]) / static_cast<float>(lever);
      for (std::size_t i = 0; i < padded.size(); ++i) {
        const auto r = static_cast<std::ptrdiff_t>(i) - reach;
        if (r < static_cast<std::ptrdiff_t>(begin)) padded[i] = o[begin] + slope_low * static_cast<float>(r - static_cast<std::ptrdiff_t>(begin));
        else if (r >= static_cast<std::ptrdiff_t>(end)) padded[i] = o[end - 1] + slope_high * static_cast<float>(r - static_cast<std::ptrdiff_t>(end - 1));
        else padded[i] = o[r];
      }
      std::fill(smooth.begin(), smooth.end(), 0.0F);
      for (std::size_t j = 0; j < g0.size(); ++j) {
        for (std::size_t r = 0; r < rows; ++r) smooth[r] += g0[j] * padded[r + j];
      }
      float* out = k.data() + sections.at(station, 0);
      const auto inverse_h = static_cast<float>(1.0 / h);
      for (std::size_t r = std::max<std::size_t>(begin, 1); r + 1 < std::min(end, rows); ++r) {
        const float d1 = 0.5F * inverse_h * (smooth[r + 1] - smooth[r - 1]);
        const float d2 = inverse_h * inverse_h * (smooth[r + 1] - 2 * smooth[r] + smooth[r - 1]);
        const float q = 1 + d1 * d1;
        out[r] = d2 / (q * std::sqrt(q));
      }
    }
  });
  return k;
}

// Flatter than a radius of 12 mm is the shape of the shoe, not a crease.
constexpr double k_least_curvature_per_mm = 0.08;

/// Typical size of the sections' curvature outside the search range: texture and noise.
double curvature_noise(const Sections& sections, std::span<const float> k, const PlacementConfig& config) {
  std::vector<double> values;
  const int reach = static_cast<int>(std::lround(config.search_mm / sections.row_mm));
  for (int station = 0; station < sections.stations; station += 7) {
    for (int row = sections.zero_row + reach + 10; row < sections.rows - 10; row += 5) {
      const std::size_t cell = sections.at(station, row);
      if (sections.known[cell] != 0) values.push_back(std::abs(static_cast<double>(k[cell])));
    }
  }
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Ridge {
  std::vector<double> row;        ///< per station, sub-row
  std::vector<double> k_per_mm;   ///< there
  std::vector<std::uint8_t> visible;
};

/// Follows the largest curvature within the search range; continuity keeps it from hopping to a stitch or a speck.
Ridge follow_ridge(const Sections& sections, std::span<const float> k, const PlacementConfig& config) {
  const int reach = static_cast<int>(std::lround(config.search_mm / sections.row_mm));
  const int low = sections.zero_row - reach;
  const int rows = 2 * reach + 1;
  const auto stations = static_cast<std::size_t>(sections.stations);
  std::vector<double> peaks(stations);
  for (std::size_t i = 0; i < stations; ++i) {
    const float* line = k.data() + sections.at(static_cast<int>(i), low);
    peaks[i] = static_cast<double>(*std::max_element(line, line + rows));
  }
  std::vector<double> sorted = peaks;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double usual = sorted[sorted.size() / 2];
  const double noise = curvature_noise(sections, k, config);

  // Each station counts by its own peak, so that a filled stretch's weak fillet is followed too; where nothing but noise
  // is left, continuity decides.
  const double floor = std::max({k_least_curvature_per_mm, 0.02 * usual, 2 * noise});
  std::vector<float> cost(static_cast<std::size_t>(rows) * stations);
  for (int r = 0; r < rows; ++r) {
    for (std::size_t i = 0; i < stations; ++i) {
      const double value = static_cast<double>(k[sections.at(static_cast<int>(i), low + r)]) / std::max(peaks[i], floor);
      cost[static_cast<std::size_t>(r) * stations + i] = static_cast<float>(1.0 - std::max(value, 0.0));
    }
  }
  const ClosedPath path = shortest_closed_path(cost, rows, sections.stations, {.max_step_rows = 3, .step_cost = 0.03});

  Ridge ridge;
  ridge.row.resize(stations);
  ridge.k_per_mm.resize(stations);
  ridge.visible.assign(stations, 0);
  for (std::size_t i = 0; i < stations; ++i) {
    // The path may cut a corner of the ridge: climb to the top next to it.
    int row = low + path.row[i];
    const auto value = [&](int r) { return static_cast<double>(k[sections.at(static_cast<int>(i), r)]); };
    const int most = static_cast<int>(0.4 / sections.row_mm);
    for (int step = 0; step < most; ++step) {
      if (row > low && value(row - 1) > value(row)) --row;
      else if (row < low + rows - 1 && value(row + 1) > value(row)) ++row;
      else break;
    }
    const double top = value(row);
    const double bow = value(row - 1) - 2 * top + value(row + 1);
    ridge.row[i] = row + (bow < -1e-9 ? std::clamp(0.5 * (value(row - 1) - value(row + 1)) / bow, -0.5, 0.5) : 0.0);
    ridge.k_per_mm[i] = top;
    ridge.visible[i] = top > std::max(k_least_curvature_per_mm, 2 * noise) && sections.known[sections.at(static_cast<int>(i), row)] != 0 ? 1 : 0;
  }
  return ridge;
}

/// Replaces the rows of invisible stations by straight lines between visible ones; distance to the nearest visible.
std::vector<double> bridge(std::vector<double>& row, std::span<const std::uint8_t> visible, double station_mm) {
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
  if (sections.known[sections.at(station, below)] == 0 || sections.known[sections.at(station, below + 1)] == 0) return std::nullopt;
  const double fraction = row - below;
  return (1 - fraction) * static_cast<double>(sections.o_mm[sections.at(station, below)]) +
         fraction * static_cast<double>(sections.o_mm[sections.at(station, below + 1)]);
}

/// Normal of the surface above the line: slopes along and up from a plane fitted to the sections around.
std::optional<Vec3> normal_above(const Sections& sections, const Outline& outline, int station, double row, const PlacementConfig& config) {
  const auto rows_of = [&](double mm) { return static_cast<int>(std::lround(mm / sections.row_mm)); };
  const int from = static_cast<int>(std::lround(row)) + rows_of(config.normal_from_mm);
  const int to = std::min(sections.rows - 1, static_cast<int>(std::lround(row)) + rows_of(config.normal_to_mm));
  const int around = std::max(1, static_cast<int>(std::lround(0.5 / sections.station_mm)));
  const double s_here = station * sections.station_mm;
  const Vec2 out = outline.normal(s_here);
  const Vec2 along{-out.y(), out.x()};
  // Per height o = a + b s + c z over half a millimetre either way (the sections are weighted over more already); normals of patches a millimetre high are averaged, as the surface
  // bends within the 4 mm.
  const int patch = std::max(2, rows_of(1.0));
  Vec3 sum = Vec3::Zero();
  for (int low = from; low + patch / 2 <= to; low += patch) {
    Mat3 A = Mat3::Zero();
    Vec3 b = Vec3::Zero();
    double bend_o = 0;
    double count = 0;
    for (int j = -around; j <= around; ++j) {
      const int other = ((station + j) % sections.stations + sections.stations) % sections.stations;
      const double dz_path = sections.path_z_mm[static_cast<std::size_t>(other)] - sections.path_z_mm[static_cast<std::size_t>(station)];
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
  // The sections' own 6.6 mm and what the path may lie off by.
  constexpr double k_reach_mm = 8.0;
  std::vector<std::uint32_t> near;
  near.reserve(field.places.size() / 3);
  const SideGrid& grid = field.grid;
  for (std::size_t i = 0; i < field.places.size(); ++i) {
    const Place& place = field.places[i];
    if (place.s_mm < 0) continue;
    const int col = std::min(grid.cols - 1, static_cast<int>(static_cast<double>(place.s_mm) / grid.col_mm));
    const double path_z_mm = grid.z_mm(crease.row[static_cast<std::size_t>(col)]);
    if (std::abs(static_cast<double>(place.z_mm) - path_z_mm) < k_reach_mm) near.push_back(static_cast<std::uint32_t>(i));
  }
  return near;
}

Placement place_line(const PlacementInput& input, const PlacementConfig& config) {
  Placement placement;
  const PathCurve curve = curve_of(input.field, input.outline, input.crease);
  const Outline path_outline{curve.plan, {.spacing_mm = 0.5, .smoothing_mm = 4.0, .reach_mm = 18.0}};
  const auto stations = static_cast<std::size_t>(std::max(32.0, std::round(path_outline.length_mm() / config.spacing_mm)));
  const std::vector<double> path_z = heights_at_stations(curve, path_outline, stations);

  // About six points within the definition's Gaussian and these weights (areas 1.0 mm by 2.5 sigma), at least two
  // profiles of a usual scan.
  const double sigma_s = std::clamp(6.0 / (2.5 * std::max(input.points_per_mm2, 0.1)), 0.7, 2.0);
  const Sections sections = cut_sections({.points = input.near, .outline = path_outline, .path_z_mm = path_z, .sigma_s_mm = sigma_s}, {});
  const std::vector<float> k = section_curvature(sections, config.smoothing_mm);
  Ridge ridge = follow_ridge(sections, k, config);
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
    for (int axis = 0; axis < 3; ++axis) n[static_cast<std::size_t>(axis)][i] = normals[i] ? (*normals[i])[axis] : 0.0;
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
