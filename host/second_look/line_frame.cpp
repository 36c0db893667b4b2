// SPDX-License-Identifier: MIT
#include "host/second_look/line_frame.hpp"

#include <algorithm>
#include <cmath>

#include "host/geometry/closed_curve.hpp"

namespace biteline::second_look {
namespace {

constexpr double k_bucket_mm = 4;
/// Ways outwards are averaged along the line, standard deviation.  Where they turned from station to station,
/// with a stitch or a line's grain, a profile between two of them would seem to lean: by the turn times its
/// height above the line.
constexpr double k_frame_along_mm = 4;
/// So near to the line, where its groove is, ways are straight up: what of a groove is seen differs from scan
/// to scan.  Beyond it the line's normals are taken, too.
constexpr double k_groove_mm = 2;
/// Ways on the surface are summed over chords of this height: a scan's grain does not lengthen them.
constexpr double k_chord_mm = 0.5;
/// The surface is averaged along the line, standard deviation.
constexpr double k_surface_along_mm = 2;

Vec3 unit_or(const Vec3& v, const Vec3& other) {
  const double norm = v.norm();
  return norm > 1e-6 ? Vec3{v / norm} : other;
}

/// Straight lines over what is not known; false where nothing is.
bool bridge(double* value, const double* weight, std::size_t rows) {
  std::size_t last = rows;
  for (std::size_t i = 0; i < rows; ++i) {
    if (weight[i] <= 0) continue;
    const std::size_t first = last == rows ? 0 : last + 1;
    for (std::size_t j = first; j < i; ++j) {
      const double share = last == rows ? 1 : static_cast<double>(j - last) / static_cast<double>(i - last);
      value[j] = last == rows ? value[i] : (1 - share) * value[last] + share * value[i];
    }
    last = i;
  }
  if (last == rows) return false;
  for (std::size_t j = last + 1; j < rows; ++j) value[j] = value[last];
  return true;
}

}  // namespace

LineFrame::LineFrame(const cloud::ClosedLine& line) {
  const auto& points = line.points;
  const geometry::ArcLength arc{points.size(), [&](std::size_t i) { return points[i].position; }};
  const std::size_t count = arc.count_for(k_station_mm);
  step_mm_ = arc.total_mm() / static_cast<double>(count);
  for (const geometry::OnCurve& on : arc.even(count)) {
    const Vec3 normal = on.between(points[on.before].normal, points[on.after].normal);
    stations_.push_back({.origin = on.between(points[on.before].position, points[on.after].position),
                         .along = Vec3::UnitX(),
                         .up = Vec3::UnitZ(),
                         .out = normal});
  }
  smooth_out();
  // A line's grain must not turn its frames: directions over 2 mm to either side.
  const auto beside = static_cast<std::ptrdiff_t>(std::lround(2 / step_mm_));
  for (std::size_t i = 0; i < count; ++i) {
    Station& s = stations_[i];
    s.along = unit_or(stations_[geometry::round_index(i, beside, count)].origin -
                          stations_[geometry::round_index(i, -beside, count)].origin,
                      Vec3::UnitX());
    const Vec3 level = unit_or(s.along.cross(Vec3::UnitZ()), Vec3::UnitX());
    s.out = unit_or(s.out - s.out.dot(s.along) * s.along, level);
    s.up = s.out.cross(s.along);
  }
  Vec2 low = stations_.front().origin.head<2>(), high = low;
  for (const Station& s : stations_) {
    low = low.cwiseMin(s.origin.head<2>());
    high = high.cwiseMax(s.origin.head<2>());
  }
  constexpr double k_around_mm = 30;
  corner_ = low.array() - k_around_mm;
  columns_ = static_cast<std::size_t>((high.x() - corner_.x() + k_around_mm) / k_bucket_mm) + 1;
  rows_ = static_cast<std::size_t>((high.y() - corner_.y() + k_around_mm) / k_bucket_mm) + 1;
  buckets_.resize(columns_ * rows_);
  for (std::size_t i = 0; i < count; ++i)
    buckets_[bucket(stations_[i].origin.x(), stations_[i].origin.y())].push_back(i);
}

void LineFrame::smooth_out() {
  for (int c = 0; c < 3; ++c) {
    std::vector<double> out;
    for (const Station& s : stations_) out.push_back(s.out[c]);
    out = geometry::smooth_closed(out, k_frame_along_mm / step_mm_);
    for (std::size_t i = 0; i < out.size(); ++i) stations_[i].out[c] = out[i];
  }
}

std::size_t LineFrame::bucket(double x, double y) const {
  const auto column = static_cast<std::size_t>((x - corner_.x()) / k_bucket_mm);
  const auto row = static_cast<std::size_t>((y - corner_.y()) / k_bucket_mm);
  return row * columns_ + column;
}

bool LineFrame::place(const Vec3& point, double reach_mm, Place& place) const {
  const double x = point.x() - corner_.x(), y = point.y() - corner_.y();
  if (x < 0 || y < 0 || x >= static_cast<double>(columns_) * k_bucket_mm ||
      y >= static_cast<double>(rows_) * k_bucket_mm)
    return false;
  const auto column = static_cast<std::ptrdiff_t>(x / k_bucket_mm);
  const auto row = static_cast<std::ptrdiff_t>(y / k_bucket_mm);
  const auto around = static_cast<std::ptrdiff_t>(std::ceil(reach_mm / k_bucket_mm));
  double best = reach_mm * reach_mm;
  bool found = false;
  for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(0, row - around);
       r <= std::min(static_cast<std::ptrdiff_t>(rows_) - 1, row + around); ++r) {
    for (std::ptrdiff_t c = std::max<std::ptrdiff_t>(0, column - around);
         c <= std::min(static_cast<std::ptrdiff_t>(columns_) - 1, column + around); ++c) {
      for (const std::size_t i :
           buckets_[static_cast<std::size_t>(r) * columns_ + static_cast<std::size_t>(c)]) {
        const double squared = (stations_[i].origin - point).squaredNorm();
        if (squared >= best) continue;
        best = squared;
        place.station = i;
        found = true;
      }
    }
  }
  if (!found) return false;
  const Station& s = stations_[place.station];
  place.along_mm = (point - s.origin).dot(s.along);
  place.up_mm = (point - s.origin).dot(s.up);
  place.out_mm = (point - s.origin).dot(s.out);
  return true;
}

SurfaceWays::SurfaceWays(const cloud::PointCloud& first, const LineFrame& frame, double reach_mm)
    : reach_mm_{reach_mm},
      zero_row_{static_cast<std::size_t>(std::ceil(reach_mm / k_chord_mm))},
      rows_{2 * zero_row_ + 1},
      out_mm_(frame.size() * rows_, 0.0),
      way_mm_(frame.size() * rows_, 0.0) {
  const double low_mm = -k_chord_mm * static_cast<double>(zero_row_);
  std::vector<double> count(out_mm_.size(), 0.0), sum(out_mm_.size(), 0.0);
  for (const Eigen::Vector3f& p : first.points) {
    LineFrame::Place place;
    if (!frame.place(p.cast<double>(), reach_mm, place)) continue;
    const double row = std::round((place.up_mm - low_mm) / k_chord_mm);
    if (row < 0 || row >= static_cast<double>(rows_)) continue;
    const std::size_t k = at(place.station, static_cast<std::size_t>(row));
    count[k] += 1;
    sum[k] += place.out_mm;
  }
  std::vector<double> column_count(frame.size()), column_sum(frame.size());
  const double sigma_steps = k_surface_along_mm / frame.step_mm();
  for (std::size_t row = 0; row < rows_; ++row) {
    for (std::size_t i = 0; i < frame.size(); ++i) {
      column_count[i] = count[at(i, row)];
      column_sum[i] = sum[at(i, row)];
    }
    const std::vector<double> counts = geometry::smooth_closed(column_count, sigma_steps),
                              sums = geometry::smooth_closed(column_sum, sigma_steps);
    for (std::size_t i = 0; i < frame.size(); ++i) {
      count[at(i, row)] = counts[i] > 1e-3 ? counts[i] : 0;
      out_mm_[at(i, row)] = counts[i] > 1e-3 ? sums[i] / counts[i] : 0;
    }
  }
  for (std::size_t i = 0; i < frame.size(); ++i) {
    double* out = &out_mm_[at(i, 0)];
    if (!bridge(out, &count[at(i, 0)], rows_)) continue;
    double* way = &way_mm_[at(i, 0)];
    for (std::size_t row = 1; row < rows_; ++row) {
      const double up_mm = low_mm + k_chord_mm * (static_cast<double>(row) - 0.5);
      const double step_out_mm = std::abs(up_mm) < k_groove_mm ? 0 : out[row] - out[row - 1];
      way[row] = way[row - 1] + std::hypot(k_chord_mm, step_out_mm);
    }
    const double zero_mm = way[zero_row_];
    for (std::size_t row = 0; row < rows_; ++row) way[row] -= zero_mm;
  }
}

double SurfaceWays::way_mm(std::size_t station, double up_mm) const {
  const double row = std::clamp(up_mm / k_chord_mm + static_cast<double>(zero_row_), 0.0,
                                static_cast<double>(rows_) - 1.001);
  const auto below = static_cast<std::size_t>(row);
  const double share = row - static_cast<double>(below);
  return (1 - share) * way_mm_[at(station, below)] + share * way_mm_[at(station, below + 1)];
}

void SurfaceWays::count_from(const std::vector<double>& by_mm) {
  for (std::size_t station = 0; station < by_mm.size(); ++station)
    for (std::size_t row = 0; row < rows_; ++row) way_mm_[at(station, row)] -= by_mm[station];
}

Vec3 SurfaceWays::point(const Station& frame, std::size_t station, double way_mm) const {
  const auto begin = way_mm_.begin() + static_cast<std::ptrdiff_t>(at(station, 0));
  const auto end = begin + static_cast<std::ptrdiff_t>(rows_);
  const auto above = std::clamp(std::upper_bound(begin, end, way_mm), begin + 1, end - 1);
  const double step_mm = std::max(*above - *(above - 1), 1e-9);
  const double share = std::clamp((way_mm - *(above - 1)) / step_mm, 0.0, 1.0);
  const auto row = static_cast<std::size_t>(above - begin) - 1;
  const double up_mm = k_chord_mm * (static_cast<double>(row) + share - static_cast<double>(zero_row_));
  const double out_mm = (1 - share) * out_mm_[at(station, row)] + share * out_mm_[at(station, row + 1)];
  return frame.origin + up_mm * frame.up + out_mm * frame.out;
}

}  // namespace biteline::second_look
