// SPDX-License-Identifier: MIT
#pragma once
/// \file Straight moves with blends, as a controller makes them of movel and movep, with a time for every
/// place.

#include <vector>

#include "common/geometry/se3.hpp"

namespace biteline::sim {

struct StraightMove {
  SE3 T_base_tcp{SE3::Identity()};
  double speed_mm_s{250};
  double acceleration_mm_s2{1200};
  double blend_mm{0};  ///< 0: stops there
};

/// Corners are cut by a parabola that leaves the incoming line `blend_mm` before the corner and joins the
/// outgoing one as far behind it (less where a side is short); speed changes by the acceleration told,
/// forwards and backwards in time. Turning counts as way too, so that a move that only turns takes time.
class TimedPath {
 public:
  TimedPath(const SE3& T_base_tcp_start, const std::vector<StraightMove>& moves);

  [[nodiscard]] double duration_s() const { return samples_.empty() ? 0 : samples_.back().time_s; }
  /// Clamped to the path's ends.
  [[nodiscard]] SE3 T_base_tcp_at(double time_s) const;

 private:
  struct Sample {
    SE3 T_base_tcp{SE3::Identity()};
    double limit_mm_s{0};
    double acceleration_mm_s2{1000};
    double way_mm{0};  ///< from the sample before
    double speed_mm_s{0};
    double time_s{0};
  };
  void add(const SE3& T_base_tcp, const StraightMove& move);
  void add_line(const SE3& from, const SE3& to, const StraightMove& move);
  void set_speeds();
  void set_times();

  std::vector<Sample> samples_;
};

}  // namespace biteline::sim
