// SPDX-License-Identifier: MIT
#include "host/bite_line/side/seam.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <tbb/parallel_invoke.h>

#include "host/bite_line/side/plan_motion.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "host/geometry/fit.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::bite_line {
namespace {

constexpr double k_reach_mm = 10;  // of what is looked at, either side of the seam
constexpr double k_height_mm = 2;
constexpr std::size_t k_least_heights = 8;  // 16 mm

double away_mm(double from_s_mm, double to_s_mm, const Outline& outline) {
  return std::remainder(to_s_mm - from_s_mm, outline.length_mm());
}

struct WayRound {
  double from_s_mm{0};
  double covered_mm{0};  ///< from there to the scan's end; negative: clockwise
};

/// By the medians of short pieces of the scan: single points may lie on the far wall, seen over the collar.
WayRound way_round(const Shoe& shoe, const Outline& outline) {
  constexpr std::size_t k_pieces = 128, k_of_piece = 15;
  std::vector<Eigen::Vector3f> points;
  for (std::size_t k = 0; k < k_pieces * k_of_piece; ++k)
    points.push_back(shoe.points[k * (shoe.points.size() - 1) / (k_pieces * k_of_piece - 1)]);
  std::vector<OutlinePlace> places(points.size());
  outline.locate(points, places);
  WayRound way;
  double at_mm = static_cast<double>(places.front().s_mm);
  for (std::size_t piece = 0; piece < k_pieces; ++piece) {
    std::vector<double> on_mm;
    for (const OutlinePlace& place : std::span{places}.subspan(piece * k_of_piece, k_of_piece))
      if (place.s_mm >= 0) on_mm.push_back(away_mm(at_mm, static_cast<double>(place.s_mm), outline));
    if (on_mm.empty()) continue;
    const double step_mm = geometry::median_of(std::move(on_mm));
    at_mm += step_mm;
    if (piece == 0) {
      way.from_s_mm = at_mm;
    } else {
      way.covered_mm += step_mm;
    }
  }
  // From the first piece's middle to the last one's so far.
  const double piece_mm = way.covered_mm / (k_pieces - 1);
  way.from_s_mm -= piece_mm / 2;
  way.covered_mm += piece_mm;
  return way;
}

/// Straight line through what lies beside the seam at one height: how far out it is at the seam.
class BesideSeam {
 public:
  void add(double s_mm, double o_mm) {
    line_.add(s_mm, o_mm);
    s_sum_mm_ += s_mm;
    o_sum_mm_ += o_mm;
    least_s_mm_ = std::min(least_s_mm_, s_mm);
    most_s_mm_ = std::max(most_s_mm_, s_mm);
    nearest_mm_ = std::min(nearest_mm_, std::abs(s_mm));
  }
  [[nodiscard]] std::optional<double> at_seam_mm() const {
    constexpr double k_least_points = 6, k_least_length_mm = 3;
    const std::optional<double> slope = line_.slope();
    if (!slope || line_.count() < k_least_points || nearest_mm_ > k_reach_mm / 2 ||
        most_s_mm_ - least_s_mm_ < k_least_length_mm)
      return std::nullopt;
    return (o_sum_mm_ - *slope * s_sum_mm_) / line_.count();
  }

 private:
  geometry::LineSums line_;
  double s_sum_mm_{0}, o_sum_mm_{0};
  double least_s_mm_{k_reach_mm}, most_s_mm_{-k_reach_mm};
  double nearest_mm_{k_reach_mm};
};

using Heights = std::vector<BesideSeam>;

/// The overlap's places, either side of the seam.
struct Places {
  static constexpr double k_apart_mm = 10;
  int each_side{0};

  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(2 * each_side + 1); }
  [[nodiscard]] double from_seam_mm(std::size_t i) const {
    return k_apart_mm * (static_cast<double>(i) - each_side);
  }
  [[nodiscard]] double reach_mm() const { return k_apart_mm * each_side + k_reach_mm; }
};

/// What the points from `first` to `end` show beside each place.
std::vector<Heights> beside_places(const Shoe& shoe, const Outline& outline, double seam_s_mm,
                                   const Places& at, std::size_t first, std::size_t end) {
  constexpr double k_near_mm = 30;  // in plan, beyond the places' own reach
  constexpr std::size_t k_enough = 50'000;
  const Eigen::Vector2f seam = outline.point(seam_s_mm).cast<float>();
  const auto near_mm = static_cast<float>(at.reach_mm() + k_near_mm);
  std::vector<Eigen::Vector3f> near;
  const std::size_t step = (end - first) / k_enough + 1;
  for (std::size_t i = first; i < end; i += step) {
    const Eigen::Vector3f& point = shoe.points[i];
    if (shoe.alone[i] == 0 && (point.head<2>() - seam).squaredNorm() < near_mm * near_mm)
      near.push_back(point);
  }
  // Located anew: of two layers of a moved shoe the side's own places hold the outer one alone.
  std::vector<OutlinePlace> places(near.size());
  outline.locate(near, places);
  std::vector<Heights> beside(at.count());
  for (const OutlinePlace& place : places) {
    if (place.s_mm < 0 || place.z_mm < 0) continue;
    const double s_mm = away_mm(seam_s_mm, static_cast<double>(place.s_mm), outline);
    const auto height = static_cast<std::size_t>(static_cast<double>(place.z_mm) / k_height_mm);
    for (std::size_t i = 0; i < at.count(); ++i) {
      const double off_mm = s_mm - at.from_seam_mm(i);
      if (std::abs(off_mm) > k_reach_mm) continue;
      Heights& heights = beside[i];
      if (heights.size() <= height) heights.resize(height + 1);
      heights[height].add(off_mm, static_cast<double>(place.o_mm));
    }
  }
  return beside;
}

/// The median over the heights; nothing where hardly any shows both.
std::optional<double> step_mm(const Heights& begin, const Heights& end) {
  std::vector<double> steps_mm;
  for (std::size_t i = 0; i < std::min(begin.size(), end.size()); ++i) {
    const std::optional<double> before = begin[i].at_seam_mm(), after = end[i].at_seam_mm();
    if (before && after) steps_mm.push_back(*after - *before);
  }
  if (steps_mm.size() < k_least_heights) return std::nullopt;
  return geometry::median_of(std::move(steps_mm));
}

/// The largest of `value(place from the seam)` along the outline.
template <typename Value>
double largest_round(const Outline& outline, double seam_s_mm, const Value& value) {
  constexpr double k_step_mm = 10;
  const Vec2 seam = outline.point(seam_s_mm);
  double largest = 0;
  for (double s_mm = 0; s_mm < outline.length_mm(); s_mm += k_step_mm)
    largest = std::max(largest, value(Vec2{outline.point(s_mm) - seam}));
  return largest;
}

}  // namespace

std::optional<SeamStep> seam_step(const ScanPoints& scan, const Shoe& shoe, const Outline& outline) {
  constexpr std::size_t k_least_points = 4096;
  constexpr double k_most_lap_share = 0.4;  // more is no scan that goes round once
  constexpr int k_most_each_side = 4;
  const std::size_t count = shoe.points.size();
  if (!scan.in_scan_order || count < k_least_points) return std::nullopt;
  const WayRound way = way_round(shoe, outline);
  const double length_mm = outline.length_mm();
  const double lap_mm = std::abs(way.covered_mm) - length_mm;
  if (lap_mm < -k_reach_mm || lap_mm > k_most_lap_share * length_mm) return std::nullopt;
  double seam_s_mm = std::fmod(way.from_s_mm + std::copysign(lap_mm / 2, way.covered_mm), length_mm);
  if (seam_s_mm < 0) seam_s_mm += length_mm;
  const Places at{.each_side = std::clamp(static_cast<int>((lap_mm / 2 - k_reach_mm) / Places::k_apart_mm), 0,
                                          k_most_each_side)};
  std::vector<Heights> begin, end;
  tbb::parallel_invoke([&] { begin = beside_places(shoe, outline, seam_s_mm, at, 0, count / 2); },
                       [&] { end = beside_places(shoe, outline, seam_s_mm, at, count / 2, count); });
  PlanMotionFit fit{
      largest_round(outline, seam_s_mm, [](const Vec2& from_seam) { return from_seam.norm(); })};
  for (std::size_t i = 0; i < at.count(); ++i) {
    const std::optional<double> here_mm = step_mm(begin[i], end[i]);
    if (!here_mm) continue;
    const double s_mm = std::fmod(seam_s_mm + at.from_seam_mm(i) + length_mm, length_mm);
    fit.add(outline.point(s_mm) - outline.point(seam_s_mm), outline.normal(s_mm), *here_mm);
  }
  if (fit.count() == 0) return std::nullopt;
  const PlanMotion motion = fit.likeliest();
  return SeamStep{.out_mm = motion.shift_mm.dot(outline.normal(seam_s_mm)),
                  .moved_mm = largest_round(outline, seam_s_mm, [&](const Vec2& from_seam) {
                    return motion.of(from_seam).norm();
                  })};
}

std::optional<SeamStep> seam_step(const cloud::PointCloud& cloud) {
  const PointRuns runs = runs_of(cloud);
  const ScanPoints scan = runs.scan(cloud.points);
  if (!scan.in_scan_order) return std::nullopt;
  const OrRefusal<Shoe> shoe = find_shoe(scan.means);
  if (!shoe) return std::nullopt;
  return seam_step(scan, *shoe, side_outline(*shoe));
}

FixedText<240> does_not_close(const SeamStep& step) {
  return FixedText<240>::format(
      "the scan does not close: at its end the shoe lies up to %.1f mm from where it "
      "lay at its begin; shoe or head moved, or the calibration does not hold",
      step.moved_mm);
}

}  // namespace biteline::bite_line
