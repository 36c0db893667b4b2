// SPDX-License-Identifier: MIT
#include "host/robot/path/flow_test.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/robot/path/checks/program_check.hpp"

namespace biteline::path {
namespace {

constexpr double k_slow_ratio = 0.4, k_middle_ratio = 0.7;
/// Of the plate's own line: its two long sides, so far apart, and round ends.
constexpr double k_end_radius_mm = 40, k_between_mm = 20, k_line_step_mm = 1, k_plate_step_mm = 2;
constexpr double k_least_film_mm = 100;
/// Delays up to this are seen: the film's end must come at an even speed.
constexpr double k_most_delay_s = 0.2;
constexpr double k_most_lag_s = 0.5;

/// What the strokes need of the way.
struct Lengths {
  double film_mm{0}, dry_mm{0};
  [[nodiscard]] double stroke_mm() const { return film_mm + dry_mm; }
  [[nodiscard]] double side_mm() const { return 2 * stroke_mm() + 3 * k_between_mm; }
};
Lengths lengths_for(const Motion& motion) {
  const double v = motion.speed_mm_s;
  // An arm that may not swing takes longer than its acceleration.
  const double ramp_mm = v * v / motion.acceleration_mm_s2 + 0.125 * v;
  return {.film_mm = std::max(k_least_film_mm, 6 * ramp_mm), .dry_mm = 5 + ramp_mm + k_most_delay_s * v};
}

/// Two sides along x and two round ends, anticlockwise, from the beginning of the first side.
cloud::ClosedLine plate_line(const FlowPlate& plate, double side_mm) {
  const double half_mm = side_mm / 2, turn_mm = std::numbers::pi * k_end_radius_mm;
  const auto place = [&](double mm) {
    const double side = std::fmod(mm, side_mm + turn_mm);
    Vec3 at{side - half_mm, -k_end_radius_mm, 0}, along = Vec3::UnitX();
    if (side > side_mm) {
      const double a = (side - side_mm) / k_end_radius_mm - std::numbers::pi / 2;
      at = Vec3{half_mm + k_end_radius_mm * std::cos(a), k_end_radius_mm * std::sin(a), 0};
      along = Vec3{-std::sin(a), std::cos(a), 0};
    }
    return mm >= side_mm + turn_mm ? std::pair{Vec3{-at}, Vec3{-along}} : std::pair{at, along};
  };
  const double all_mm = 2 * (side_mm + turn_mm);
  const auto count = static_cast<int>(std::lround(all_mm / k_line_step_mm));
  const Eigen::AngleAxisd turn{plate.turn_rad, Vec3::UnitZ()};
  cloud::ClosedLine line;
  for (int i = 0; i < count; ++i) {
    const auto [at, along] = place(all_mm * i / count);
    const Vec3 tangent = turn * along;
    line.points.push_back({.position = plate.middle + turn * at,
                           .normal = tangent.cross(Vec3::UnitZ()),
                           .tangent = tangent,
                           .confidence = 1,
                           .u95_mm = 0});
  }
  return line;
}

std::vector<Eigen::Vector3f> plate_points(const FlowPlate& plate, double side_mm) {
  const Eigen::AngleAxisd turn{plate.turn_rad, Vec3::UnitZ()};
  const double half_x = side_mm / 2 + k_end_radius_mm + 10, half_y = k_end_radius_mm + 10;
  std::vector<Eigen::Vector3f> points;
  for (double x = -half_x; x <= half_x; x += k_plate_step_mm)
    for (double y = -half_y; y <= half_y; y += k_plate_step_mm)
      points.push_back((plate.middle + turn * Vec3{x, y, 0}).cast<float>());
  return points;
}

/// A stroke's waypoints as a straight way in time.
class Way {
 public:
  Way(const PlannedPath& path, const PathRun& run) : path_{path}, run_{run} {}
  [[nodiscard]] double film_mm() const { return at_mm(run_.last) - path_.flow->dry_end_mm; }
  [[nodiscard]] Vec3 spot(double mm) const {
    const SE3& T = path_.waypoints[run_.first].T_base_tcp;
    const Vec3 way = path_.waypoints[run_.last].T_base_tcp.translation() - T.translation();
    return T.translation() + path_.standoff_mm * T.linear().col(2) + mm * way.normalized();
  }
  struct Here {
    double mm, mm_s;
  };
  /// So long after the tool set out; steady acceleration between waypoints.
  [[nodiscard]] Here after(double s) const {
    const auto& w = path_.waypoints;
    std::size_t i = run_.first;
    while (i + 2 <= run_.last && w[i + 1].time_s - w[run_.first].time_s <= s) ++i;
    const double step_s = w[i + 1].time_s - w[i].time_s;
    const double in_s = std::clamp(s - (w[i].time_s - w[run_.first].time_s), 0.0, step_s);
    const double a = (w[i + 1].speed_mm_s - w[i].speed_mm_s) / step_s;
    return {.mm = at_mm(i) + w[i].speed_mm_s * in_s + a * in_s * in_s / 2,
            .mm_s = w[i].speed_mm_s + a * in_s};
  }
  [[nodiscard]] double duration_s() const {
    return path_.waypoints[run_.last].time_s - path_.waypoints[run_.first].time_s;
  }
  /// From the slower of a step on; none: one speed all along.
  [[nodiscard]] std::optional<double> step_mm() const {
    for (std::size_t i = run_.first + 1; i <= run_.last; ++i)
      if (path_.waypoints[i].speed_ratio != path_.waypoints[i - 1].speed_ratio) return at_mm(i);
    return std::nullopt;
  }
  [[nodiscard]] double along_x() const {
    const auto& w = path_.waypoints;
    const Vec3 way = w[run_.last].T_base_tcp.translation() - w[run_.first].T_base_tcp.translation();
    return way.dot(reference()) > 0 ? 1 : -1;
  }

 private:
  [[nodiscard]] double at_mm(std::size_t i) const {
    return path_.waypoints[i].arc_mm - path_.waypoints[run_.first].arc_mm;
  }
  [[nodiscard]] Vec3 reference() const {
    const PathRun first = runs_of(path_, Segment::Line).front();
    return path_.waypoints[first.last].T_base_tcp.translation() -
           path_.waypoints[first.first].T_base_tcp.translation();
  }
  const PlannedPath& path_;
  PathRun run_;
};

std::vector<Way> ways_of(const PlannedPath& path) {
  std::vector<Way> ways;
  for (const PathRun& run : runs_of(path, Segment::Line)) ways.emplace_back(path, run);
  return ways;
}

double speed_at_end(const Way& way) {
  double s = 0;
  while (s < way.duration_s() && way.after(s).mm < way.film_mm()) s += 1e-3;
  return way.after(s).mm_s;
}

/// How much wider than in the end the film is where it is widest, behind the step of the speed, with this
/// lag: its width goes with the root of its cross-section.
double widest_ratio(const Way& way, double lag_s) {
  constexpr double k_step_s = 5e-4;
  double flow_mm_s = 0, widest = 1;
  for (double s = 0; s < way.duration_s(); s += k_step_s) {
    const Way::Here here = way.after(s);
    if (here.mm > way.film_mm()) break;
    // Exact over one step of a steady input.
    flow_mm_s += (here.mm_s - flow_mm_s) * (1 - std::exp(-k_step_s / std::max(lag_s, 1e-6)));
    // Before it the flow has long come to its own.
    if (here.mm > *way.step_mm() / 2) widest = std::max(widest, flow_mm_s / here.mm_s);
  }
  return std::sqrt(widest);
}

/// Where `rises(x)` comes to `wanted`, between 0 and `most`.
template <class Rises>
double solve(double wanted, double most, const Rises& rises) {
  double low = 0, high = most;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (rises(middle) < wanted ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

Result<void> ask_for_flow_test(PlanRequest& request, const FlowPlate& plate) {
  Process& process = request.process;
  if (process.digital_output < 0)
    return fail(Errc::InvalidArgument, "the process '%s' switches no output: it has no gun",
                process.name.c_str());
  const bool pumps = process.flow && process.flow->analog_output >= 0;
  const Lengths lengths = lengths_for(process.motion);
  Flow flow{.dry_end_mm = lengths.dry_mm};
  flow.full_mm_s = process.motion.speed_mm_s;
  if (process.flow) {
    flow.analog_output = process.flow->analog_output;
    flow.full_mm_s = process.flow->full_mm_s;
  }
  process.flow = flow;
  process.zones.clear();
  process.placement = {.standoff_mm = process.placement.standoff_mm, .tilt_rad = std::numbers::pi / 2};
  const double side_mm = lengths.side_mm();
  request.line = plate_line(plate, side_mm);
  request.cloud = plate_points(plate, side_mm);
  const double other_mm = side_mm + std::numbers::pi * k_end_radius_mm;
  const auto stroke = [&](double begin_mm, double ratio) {
    process.only.push_back(
        {.from_mm = begin_mm, .to_mm = begin_mm + lengths.stroke_mm(), .speed_ratio = ratio});
  };
  process.only.clear();
  const double second_mm = 2 * k_between_mm + lengths.stroke_mm();
  stroke(k_between_mm, k_slow_ratio);
  stroke(second_mm, 1);
  stroke(other_mm + k_between_mm, k_middle_ratio);
  stroke(other_mm + second_mm, 1);
  if (!pumps) return {};
  const Piece both = process.only.back();
  const double step_mm = both.from_mm + lengths.film_mm / 2;
  process.only.back().to_mm = step_mm;
  process.only.push_back({.from_mm = step_mm, .to_mm = both.to_mm, .speed_ratio = k_slow_ratio});
  return {};
}

std::vector<FlowStroke> flow_strokes(const PlannedPath& path) {
  std::vector<FlowStroke> strokes;
  for (const Way& way : ways_of(path))
    strokes.push_back({.begins_base = way.spot(0),
                       .ends_base = way.spot(way.film_mm()),
                       .speed_mm_s = speed_at_end(way),
                       .step_mm = way.step_mm()});
  return strokes;
}

Result<FlowFit> fit_flow(const PlannedPath& path, std::span<const MeasuredStroke> measured) {
  const std::vector<Way> ways = ways_of(path);
  const auto count = static_cast<double>(ways.size());
  if (ways.size() != measured.size())
    return fail(Errc::InvalidArgument, "%zu strokes were measured, %zu are planned", measured.size(),
                ways.size());
  // end_i = v_i off + s_i shift; least squares in two unknowns.
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Vec2 right = Vec2::Zero();
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Vec2 row{speed_at_end(ways[i]), ways[i].along_x()};
    normal += row * row.transpose();
    right += measured[i].end_mm * row;
  }
  const Vec2 found = normal.ldlt().solve(right);
  FlowFit fit{.gun_off_s = found[0], .shift_mm = found[1]};
  double begin_mm = 0;
  for (std::size_t i = 0; i < ways.size(); ++i)
    begin_mm += (measured[i].begin_mm - ways[i].along_x() * fit.shift_mm) / count;
  const auto begin_after = [&](double s) {
    double mm = 0;
    for (const Way& way : ways) mm += way.after(s).mm / count;
    return mm;
  };
  fit.gun_on_s = solve(begin_mm, k_most_delay_s, begin_after);
  double square = 0;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const double shift_mm = ways[i].along_x() * fit.shift_mm;
    square += std::pow(measured[i].end_mm - speed_at_end(ways[i]) * fit.gun_off_s - shift_mm, 2) +
              std::pow(measured[i].begin_mm - ways[i].after(fit.gun_on_s).mm - shift_mm, 2);
    if (!measured[i].widest_ratio || !ways[i].step_mm()) continue;
    fit.lag_s = solve(*measured[i].widest_ratio, k_most_lag_s,
                      [&](double lag_s) { return widest_ratio(ways[i], lag_s); });
  }
  fit.rms_mm = std::sqrt(square / (2 * count));
  if (fit.gun_off_s < -0.02 || fit.gun_off_s > k_most_delay_s || fit.gun_on_s > 0.99 * k_most_delay_s)
    return fail(Errc::InvalidArgument, "no gun has delays as these strokes have: on %.0f ms, off %.0f ms",
                1e3 * fit.gun_on_s, 1e3 * fit.gun_off_s);
  fit.gun_off_s = std::max(0.0, fit.gun_off_s);
  return fit;
}

}  // namespace biteline::path
