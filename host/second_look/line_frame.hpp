// SPDX-License-Identifier: MIT
#pragma once
/// \file Frames along a line, and ways across it on a scan's surface.

#include <cmath>
#include <cstddef>
#include <vector>

#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::second_look {

inline constexpr double k_station_mm = 0.5;  ///< profiles of a fast scan stand 1 mm apart

/// One station of the line: a frame of its own, and its surface across.
struct Station {
  Vec3 origin, along, up, out;  ///< base; unit, square to each other
};

/// Stations round the line.
class LineFrame {
 public:
  explicit LineFrame(const cloud::ClosedLine& line);

  [[nodiscard]] std::size_t size() const { return stations_.size(); }
  [[nodiscard]] double step_mm() const { return step_mm_; }
  [[nodiscard]] double length_mm() const { return step_mm_ * static_cast<double>(stations_.size()); }
  [[nodiscard]] std::size_t nearest(double along_mm) const {
    return static_cast<std::size_t>(std::lround(along_mm / step_mm_)) % stations_.size();
  }
  [[nodiscard]] const Station& at(std::size_t i) const { return stations_[i]; }

  /// A point beside the line, in the frame of its nearest station.
  struct Place {
    std::size_t station{0};
    double along_mm{0};  ///< from the station
    double up_mm{0}, out_mm{0};
  };
  /// False: it lies farther than `reach_mm` from the line.
  [[nodiscard]] bool place(const Vec3& point, double reach_mm, Place& place) const;

 private:
  void smooth_out();
  [[nodiscard]] std::size_t bucket(double x, double y) const;

  std::vector<Station> stations_;
  double step_mm_{0};
  Vec2 corner_{0, 0};
  std::size_t columns_{0}, rows_{0};
  std::vector<std::vector<std::size_t>> buckets_;
};

/// The first scan's surface across each station: ways on it against heights in the station's frame.
class SurfaceWays {
 public:
  SurfaceWays(const cloud::PointCloud& first, const LineFrame& frame, double reach_mm);
  [[nodiscard]] double way_mm(std::size_t station, double up_mm) const;
  /// From now on ways are counted from a place that lies so much farther up at each station.
  void count_from(const std::vector<double>& by_mm);
  [[nodiscard]] Vec3 point(const Station& frame, std::size_t station, double way_mm) const;

 private:
  [[nodiscard]] std::size_t at(std::size_t station, std::size_t row) const { return station * rows_ + row; }

  double reach_mm_;
  std::size_t zero_row_;  ///< at the line
  std::size_t rows_;
  std::vector<double> out_mm_, way_mm_;  ///< station by station, by height
};

}  // namespace biteline::second_look
