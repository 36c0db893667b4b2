// SPDX-License-Identifier: MIT
#include "host/robot/path/coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "host/robot/path/checks/program_check.hpp"

namespace biteline::path {
namespace {

constexpr double k_cell_mm = 5, k_bin_mm = 0.5;
/// A jet that misses its place by more lands on something else.
constexpr double k_depth_mm = 10;
/// Behind what is met first within a bin: the surface's own slope and noise.
constexpr double k_behind_mm = 1.5;
/// Waypoints apart before a point counts as come over once more.
constexpr std::size_t k_again = 5;

class Grid {
 public:
  explicit Grid(std::span<const Eigen::Vector3f> points) : points_{points} {
    for (std::uint32_t i = 0; i < points.size(); ++i)
      cells_[key(cell(points[i].cast<double>()))].push_back(i);
  }
  template <class Use>
  void each_near(const Vec3& place, double reach_mm, const Use& use) const {
    const Cell low = cell(place - Vec3::Constant(reach_mm)), high = cell(place + Vec3::Constant(reach_mm));
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z)
          if (const auto found = cells_.find(key({x, y, z})); found != cells_.end())
            for (const std::uint32_t i : found->second) use(i, Vec3{points_[i].cast<double>()});
  }

 private:
  using Cell = std::array<int, 3>;
  static Cell cell(const Vec3& p) {
    const auto of = [](double mm) { return static_cast<int>(std::floor(mm / k_cell_mm)); };
    return {of(p.x()), of(p.y()), of(p.z())};
  }
  static std::uint64_t key(const Cell& c) {
    const auto part = [](int i) { return static_cast<std::uint64_t>(i + (1 << 20)); };
    return part(c[0]) << 42U | part(c[1]) << 21U | part(c[2]);
  }
  std::span<const Eigen::Vector3f> points_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

/// What a tool at one waypoint meets.
struct Footprint {
  Vec3 tip, along, across, axis;
  double half_mm{0};      ///< along its way
  double standoff_mm{0};  ///< 0: a contact
  double half_width_mm{0};

  /// Where across it is met, at the place that is worked; beyond half_width_mm: not at all.  A contact lies
  /// against the surface, whichever way the tool stands.
  [[nodiscard]] double across_mm(const Vec3& off) const {
    const double depth_mm = off.dot(axis), aside_mm = off.dot(across);
    if (std::abs(off.dot(along)) > half_mm) return std::numeric_limits<double>::max();
    if (standoff_mm <= 0) return std::copysign(std::hypot(aside_mm, depth_mm), aside_mm);
    const bool near = depth_mm > 0 && std::abs(depth_mm - standoff_mm) <= k_depth_mm;
    return near ? aside_mm * standoff_mm / depth_mm : std::numeric_limits<double>::max();
  }
};

struct Met {
  std::uint32_t point;
  std::size_t bin;
  Vec3 off;
};

/// The first of each bin, and what lies right behind it.
std::vector<Met> met_first(std::vector<Met> met, const Vec3& axis, std::size_t bins) {
  std::vector<double> first_mm(bins, std::numeric_limits<double>::max());
  for (const Met& m : met) first_mm[m.bin] = std::min(first_mm[m.bin], m.off.dot(axis));
  std::erase_if(met, [&](const Met& m) { return m.off.dot(axis) > first_mm[m.bin] + k_behind_mm; });
  return met;
}

/// Over the bins' middles, and half a bin more at either end.
double width_mm(const std::vector<Met>& met, std::size_t bins) {
  std::vector<Vec3> sum(bins, Vec3::Zero());
  std::vector<double> count(bins, 0);
  for (const Met& m : met) sum[m.bin] += m.off, count[m.bin] += 1;
  std::optional<Vec3> last;
  double mm = 0, steps = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    if (count[bin] == 0) continue;
    const Vec3 here = sum[bin] / count[bin];
    if (last) mm += (here - *last).norm(), steps += 1;
    last = here;
  }
  return steps > 0 ? mm * (steps + 1) / steps : 0;
}

}  // namespace

CoveredSurface covered_surface(const PlannedPath& path, const Coverage& coverage,
                               std::span<const Eigen::Vector3f> points) {
  CoveredSurface covered{.times = std::vector<std::uint8_t>(points.size(), 0)};
  const bool sprays = coverage.cone_rad > 0;
  const double full_mm =
      sprays ? 2 * path.standoff_mm * std::tan(coverage.cone_rad / 2) : coverage.contact_width_mm;
  if (!(full_mm > 0)) return covered;
  const auto bins = static_cast<std::size_t>(std::ceil(full_mm / k_bin_mm));
  const Grid grid{points};
  std::vector<std::size_t> last(points.size(), 0);
  const auto& w = path.waypoints;
  for (const PathRun& run : runs_of(path, Segment::Line)) {
    for (std::size_t i = run.first; i <= run.last; ++i) {
      const std::size_t before = std::max(i, run.first + 1) - 1, behind = std::min(i + 1, run.last);
      const Vec3 way = w[behind].T_base_tcp.translation() - w[before].T_base_tcp.translation();
      const Vec3 axis = w[i].T_base_tcp.linear().col(2);
      const Vec3 along = (way - way.dot(axis) * axis).normalized();
      const Footprint tool{.tip = w[i].T_base_tcp.translation(),
                           .along = along,
                           .across = axis.cross(along),
                           .axis = axis,
                           .half_mm = 0.5 + 0.5 * path.motion.spacing_mm,
                           .standoff_mm = sprays ? path.standoff_mm : 0,
                           .half_width_mm = full_mm / 2};
      std::vector<Met> met;
      const Vec3 spot = tool.tip + tool.standoff_mm * axis;
      grid.each_near(spot, tool.half_width_mm + k_depth_mm, [&](std::uint32_t k, const Vec3& p) {
        const double across_mm = tool.across_mm(p - tool.tip);
        if (std::abs(across_mm) >= tool.half_width_mm) return;
        met.push_back({.point = k,
                       .bin = static_cast<std::size_t>((across_mm + tool.half_width_mm) / k_bin_mm),
                       .off = p - spot});
      });
      met = met_first(std::move(met), axis, bins);
      covered.sections.push_back({.arc_mm = w[i].arc_mm, .width_mm = width_mm(met, bins)});
      for (const Met& m : met) {
        std::uint8_t& times = covered.times[m.point];
        if (times == 0 || i - last[m.point] > k_again)
          times = static_cast<std::uint8_t>(std::min<int>(times + 1, 255));
        last[m.point] = i;
      }
    }
  }
  return covered;
}

}  // namespace biteline::path
