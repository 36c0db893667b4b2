// SPDX-License-Identifier: MIT
#include "host/robot/path/tool_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/contracts.hpp"
#include "host/geometry/closed_curve.hpp"
#include "host/robot/path/targets.hpp"
#include "host/robot/path/zones.hpp"

namespace biteline::path {
namespace {

// Standard deviations of the smoothing along the line.  A tool's contact is 8 mm wide or more: what turns
// within that it cannot follow anyway.  A standoff is a lever: a degree moves a tip 60 mm away by a
// millimetre.
constexpr double k_direction_sigma_mm = 8;
constexpr double k_direction_sigma_per_standoff = 0.2;
constexpr double k_tangent_sigma_mm = 3;
constexpr double k_approach_spacing_mm = 10;
// The line is sampled this much finer than the path, whose points are then picked along the tip's own way.
constexpr double k_finer = 4;
// A piece of its own begins and ends at a sample: within half of this.
constexpr double k_piece_step_mm = 0.1;
constexpr std::size_t k_seam_sectors = 8;
constexpr double k_seam_apart_mm = 20;
// So that a length of a whole number of steps is not cut into one more by its last digit.
constexpr double k_rounding = 1e-6;

struct PathSample {
  Vec3 position;
  Vec3 normal;
  Vec3 tangent;
  std::optional<double> u95_mm{};
};

/// Known where all are.
std::optional<double> larger(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b ? std::optional{std::max(*a, *b)} : std::nullopt;
}

/// A closed sequence at even arc lengths.
std::vector<PathSample> resampled(const cloud::ClosedLine& line, std::size_t count) {
  const std::vector<cloud::LinePoint>& points = line.points;
  const geometry::ArcLength along{points.size(), [&](std::size_t i) { return points[i].position; }};
  std::vector<PathSample> samples(count);
  for (std::size_t k = 0; k < count; ++k) {
    const geometry::OnCurve at = along.even(k, count);
    samples[k] = {.position = at.between(points[at.before].position, points[at.after].position),
                  .normal = at.between(points[at.before].normal, points[at.after].normal),
                  .tangent = Vec3::Zero(),
                  .u95_mm = larger(points[at.before].u95_mm, points[at.after].u95_mm)};
  }
  return samples;
}

/// Gaussian mean of one member round the closed sequence.
std::vector<Vec3> smoothed(const std::vector<PathSample>& samples, Vec3 PathSample::*member, double sigma_mm,
                           double spacing_mm) {
  std::vector<Vec3> values;
  for (const PathSample& sample : samples) values.push_back(sample.*member);
  return geometry::smooth_closed<Vec3>(values, sigma_mm / spacing_mm, Vec3::Zero());
}

std::vector<PathSample> with_directions(std::vector<PathSample> samples, double spacing_mm, double sigma_mm) {
  const std::size_t n = samples.size();
  const std::vector<Vec3> positions =
      smoothed(samples, &PathSample::position, k_tangent_sigma_mm, spacing_mm);
  for (std::size_t i = 0; i < n; ++i) {
    samples[i].tangent = (positions[(i + 1) % n] - positions[(i + n - 1) % n]).normalized();
  }
  const std::vector<Vec3> tangents = smoothed(samples, &PathSample::tangent, sigma_mm, spacing_mm);
  const std::vector<Vec3> normals = smoothed(samples, &PathSample::normal, sigma_mm, spacing_mm);
  for (std::size_t i = 0; i < n; ++i) {
    samples[i].tangent = tangents[i].normalized();
    samples[i].normal = (normals[i] - normals[i].dot(samples[i].tangent) * samples[i].tangent).normalized();
  }
  return samples;
}

/// Turning per length, from the tangents on either side.
double curvature_per_mm(const std::vector<PathSample>& samples, std::size_t i, double spacing_mm) {
  const std::size_t n = samples.size();
  const Vec3& before = samples[(i + n - 1) % n].tangent;
  const Vec3& after = samples[(i + 1) % n].tangent;
  return std::atan2(before.cross(after).norm(), before.dot(after)) / (2 * spacing_mm);
}

/// How much a seam at each sample harms: turning over the overlap, and nearness to the two ends of the
/// outline, where toe and heel show and the sole bends.
std::vector<double> harm(const std::vector<PathSample>& samples, double spacing_mm) {
  const std::size_t n = samples.size();
  Vec3 middle = Vec3::Zero();
  for (const PathSample& sample : samples) middle += sample.position / static_cast<double>(n);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const PathSample& sample : samples) {
    const Eigen::Vector2d d = (sample.position - middle).head<2>();
    spread += d * d.transpose();
  }
  const double angle_rad =
      0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));  // principal axis of 2 x 2
  const Vec3 axis{std::cos(angle_rad), std::sin(angle_rad), 0};
  double half_mm = 0;
  for (const PathSample& sample : samples)
    half_mm = std::max(half_mm, std::abs(axis.dot(sample.position - middle)));

  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) {
    double turning_rad = 0;  // over 20 mm
    for (std::size_t k = 0; k <= static_cast<std::size_t>(20 / spacing_mm); ++k) {
      turning_rad += curvature_per_mm(samples, (i + k) % n, spacing_mm) * spacing_mm;
    }
    const double along = std::abs(axis.dot(samples[i].position - middle)) / half_mm;
    out[i] = turning_rad + along * along;
  }
  return out;
}

/// Sampling of the line that path and seams share.
struct Sampling {
  std::vector<PathSample> samples;
  double fine_mm;
  double direction_sigma_mm;
};
Sampling sampled(const cloud::ClosedLine& line, const Process& process) {
  const double length_mm = cloud::length_mm(line);
  const double per_mm = process.only.empty() ? k_finer / process.motion.spacing_mm : 1 / k_piece_step_mm;
  const auto count = static_cast<std::size_t>(std::max(64.0, std::round(per_mm * length_mm)));
  const double fine_mm = length_mm / static_cast<double>(count);
  const double sigma_mm =
      k_direction_sigma_mm + k_direction_sigma_per_standoff * process.placement.standoff_mm;
  return {.samples = with_directions(resampled(line, count), fine_mm, sigma_mm),
          .fine_mm = fine_mm,
          .direction_sigma_mm = sigma_mm};
}

/// The line's U95 at a tip that stands `lever_mm` off it.  What the whole line shares shifts the tool as the
/// line. What one place has beyond that also turns it: two such places, apart by the smoothing of the
/// directions to either side.
std::optional<double> u95_at_tip(const std::optional<double>& u95_mm, double shared_mm, double lever_mm,
                                 double direction_sigma_mm) {
  if (!u95_mm) return std::nullopt;
  const double own_mm = std::sqrt(std::max(0.0, *u95_mm * *u95_mm - shared_mm * shared_mm));
  const double turn_rad = std::sqrt(2.0) * own_mm / (2 * direction_sigma_mm);
  return std::hypot(*u95_mm, lever_mm * turn_rad);
}

SE3 tool_frame(const PathSample& sample, const TipPlacement& placement) {
  const Vec3& t = sample.tangent;
  // Outwards of an anticlockwise line is to its right.
  const Vec3 n =
      placement.outwards == Outwards::Normal ? sample.normal : Vec3(t.cross(Vec3::UnitZ()).normalized());
  const Vec3 up = n.cross(t);
  const Vec3 upright_body = std::cos(placement.tilt_rad) * n + std::sin(placement.tilt_rad) * up;
  const Vec3 body =
      (std::cos(placement.lead_rad) * upright_body - std::sin(placement.lead_rad) * t).normalized();
  const Vec3 z = -body;
  const Vec3 x = (t - t.dot(z) * z).normalized();
  SE3 T = SE3::Identity();
  T.linear().col(0) = x;
  T.linear().col(1) = z.cross(x);
  T.linear().col(2) = z;
  T.translation() =
      sample.position + placement.outward_mm * n + placement.up_mm * up + placement.standoff_mm * body;
  return T;
}

/// Poses from `T_from` (left out) to `T_to` (taken) in a straight line.
void append_straight(std::vector<ToolPoint>& points, const SE3& T_from, const SE3& T_to, Segment segment,
                     const Vec3& line_base) {
  const double length_mm = (T_to.translation() - T_from.translation()).norm();
  const int count = std::max(1, static_cast<int>(std::ceil(length_mm / k_approach_spacing_mm - k_rounding)));
  for (int i = 1; i <= count; ++i) {
    points.push_back({.T_base_tcp = geometry::interpolate(T_from, T_to, static_cast<double>(i) / count),
                      .segment = segment,
                      .arc_mm = 0,
                      .curvature_per_mm = 0,
                      .line_base = line_base});
  }
}

SE3 shifted(const SE3& T, const Vec3& by_mm) {
  SE3 out = T;
  out.translation() += by_mm;
  return out;
}

/// Of the tip's way: 1 / radius of the circle through the points 6 mm before and after, wide against the
/// points' spacing.
void set_curvature(std::vector<ToolPoint>& points) {
  constexpr double k_arm_mm = 6;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i].T_base_tcp.translation();
    const auto far = [&](std::size_t k) {
      return (points[k].T_base_tcp.translation() - p).norm() >= k_arm_mm;
    };
    std::size_t a = i, b = i;
    while (a > 0 && !far(a)) --a;
    while (b + 1 < points.size() && !far(b)) ++b;
    const Vec3 in = p - points[a].T_base_tcp.translation(), out = points[b].T_base_tcp.translation() - p;
    const double sides = in.norm() * out.norm() * (in + out).norm();
    if (sides > 1e-9) points[i].curvature_per_mm = 2 * in.cross(out).norm() / sides;
  }
}

/// The line with what is done at each of its places.
struct Job {
  Sampling line;
  std::vector<PlaceWork> work;
  std::vector<double> round_ratio{};  ///< of a process with a force
  double shared_u95_mm{0};

  [[nodiscard]] std::size_t count() const { return line.samples.size(); }
  [[nodiscard]] const PathSample& sample(std::size_t i) const { return line.samples[i % count()]; }
  [[nodiscard]] SE3 frame(std::size_t i) const { return tool_frame(sample(i), work[i % count()].placement); }
};

/// The tip's way over one run, sample by sample.
struct FineWay {
  std::vector<SE3> frames;
  std::vector<Vec3> tips;
  double mm{0};
};

FineWay way_of(const Job& job, const Run& run) {
  FineWay way;
  for (std::size_t k = 0; k <= run.steps; ++k) {
    way.frames.push_back(job.frame(run.first + k));
    way.tips.emplace_back(way.frames[k].translation());
    if (k > 0) way.mm += (way.tips[k] - way.tips[k - 1]).norm();
  }
  return way;
}

/// How much faster a tip that stands off must go than its place on the line: round a toe more, along a hollow
/// less.  Over the turns that the tool's smoothed directions make, not over their noise.
constexpr double k_speed_arm_mm = 6, k_most_tip_ratio = 3;
double tip_ratio(const Job& job, const Run& run, const FineWay& way, std::size_t k) {
  if (!(job.work[(run.first + k) % job.count()].placement.standoff_mm > 0)) return 1;
  const auto arm = static_cast<std::size_t>(std::ceil(k_speed_arm_mm / job.line.fine_mm));
  const std::size_t from = k > arm ? k - arm : 0, to = std::min(k + arm, run.steps);
  double tip_mm = 0, line_mm = 0;
  for (std::size_t i = from; i < to; ++i) {
    tip_mm += (way.tips[i + 1] - way.tips[i]).norm();
    line_mm += (job.sample(run.first + i + 1).position - job.sample(run.first + i).position).norm();
  }
  return line_mm > 0 ? std::clamp(tip_mm / line_mm, k_least_tip_ratio, k_most_tip_ratio) : 1;
}

/// Straight between close points, whatever the turn.
SE3 pose_at(const FineWay& way, const FinePlace& place) {
  SE3 T = geometry::interpolate(way.frames[place.sample], way.frames[place.sample + 1], place.fraction);
  T.translation() = place.tip;
  return T;
}

/// One run's points, even along the way of the tip.
std::vector<ToolPoint> along_run(const Job& job, const Run& run, const FineWay& way, double spacing_mm) {
  const double fine_mm = job.line.fine_mm;
  std::vector<ToolPoint> points;
  for (const FinePlace& place : even_places(way.tips, spacing_mm)) {
    const std::size_t k = run.first + place.sample;
    const Vec3 &a = job.sample(k).position, &b = job.sample(k + 1).position;
    // The worst of what lies nearer to this point than to its neighbours.
    const auto half = static_cast<std::size_t>(std::ceil(0.5 * spacing_mm / fine_mm));
    std::optional<double> u95_mm = job.sample(k).u95_mm;
    for (std::size_t j = 0; j <= 2 * half; ++j)
      u95_mm = larger(u95_mm, job.sample(k + job.count() + j - half).u95_mm);
    const Vec3 line_base = (1 - place.fraction) * a + place.fraction * b;
    points.push_back({.T_base_tcp = pose_at(way, place),
                      .segment = Segment::Line,
                      .arc_mm = 0,
                      .curvature_per_mm = 0,
                      .line_base = line_base,
                      .u95_mm = u95_at_tip(u95_mm, job.shared_u95_mm, (place.tip - line_base).norm(),
                                           job.line.direction_sigma_mm),
                      .speed_ratio = std::min(k_most_speed_ratio, job.work[k % job.count()].speed_ratio *
                                                                      tip_ratio(job, run, way, place.sample)),
                      .press_base = -job.sample(k).normal,
                      .round_ratio = job.round_ratio.empty() ? 0 : job.round_ratio[k % job.count()]});
  }
  set_curvature(points);
  return points;
}

/// Drawn back along the tool's axis, slowly, then farther, and lifted from there.
SE3 drawn_back(const SE3& T, const Motion& motion) {
  return shifted(T, -motion.approach_mm * T.linear().col(2));
}
SE3 clear(const SE3& T, const Motion& motion) {
  return shifted(drawn_back(T, motion), -motion.draw_back_mm * T.linear().col(2));
}
SE3 lifted(const SE3& T, const Motion& motion) {
  return shifted(clear(T, motion), motion.lift_mm * Vec3::UnitZ());
}

/// From one run's end to another's beginning, the shorter way round.
struct WayRound {
  std::size_t steps{0};
  bool forwards{true};
};
WayRound way_round(const Job& job, const Run& before, const Run& next) {
  const std::size_t count = job.count();
  const std::size_t ahead = (next.first + count - (before.first + before.steps) % count) % count;
  const bool forwards = 2 * ahead <= count;
  return {.steps = forwards ? ahead : count - ahead, .forwards = forwards};
}

/// How the tool leaves one run for the next.  Between pieces of their own it only draws back where the way
/// is shorter than farther back and up, and down again.
Motion between(const Job& job, const Process& process, const Run& before, const Run& next) {
  Motion motion = process.motion;
  const double way_mm = job.line.fine_mm * static_cast<double>(way_round(job, before, next).steps);
  if (!process.only.empty() && way_mm < 2 * (motion.lift_mm + motion.draw_back_mm))
    motion.lift_mm = motion.draw_back_mm = 0;
  return motion;
}

/// From above one run's end to above another's beginning, the shorter way round; without its own beginning.
std::vector<ToolPoint> travel(const Job& job, const Run& before, const Run& next, const Motion& motion) {
  const std::size_t count = job.count(), from = before.first + before.steps;
  const auto [steps, forwards] = way_round(job, before, next);
  FineWay way;
  for (std::size_t k = 0; k <= steps; ++k) {
    way.frames.push_back(lifted(job.frame(forwards ? from + k : from + count - k), motion));
    way.tips.emplace_back(way.frames[k].translation());
    if (k > 0) way.mm += (way.tips[k] - way.tips[k - 1]).norm();
  }
  std::vector<ToolPoint> points;
  if (steps == 0) return points;  // the next way down begins there
  const double spacing_mm = std::max(k_approach_spacing_mm, target_spacing_mm(motion, way.mm));
  for (const FinePlace& place : even_places(way.tips, spacing_mm)) {
    const std::size_t k = forwards ? from + place.sample : from + count - place.sample;
    points.push_back({.T_base_tcp = pose_at(way, place),
                      .segment = Segment::Travel,
                      .arc_mm = 0,
                      .curvature_per_mm = 0,
                      .line_base = job.sample(k).position});
  }
  set_curvature(points);
  points.erase(points.begin());
  return points;
}

Job job_of(const cloud::ClosedLine& line, const Process& process) {
  Job job{.line = sampled(line, process), .work = {}};
  std::vector<Vec3> places;
  for (const PathSample& sample : job.line.samples) places.push_back(sample.position);
  job.work = work_along(places, job.line.fine_mm, process);
  if (process.force) job.round_ratio = round_ratios(places);
  job.shared_u95_mm = job.sample(0).u95_mm.value_or(0);
  for (const PathSample& sample : job.line.samples)
    job.shared_u95_mm = std::min(job.shared_u95_mm, sample.u95_mm.value_or(0));
  return job;
}

/// What is worked in one go, in order.
std::vector<Run> runs_in(const Job& job, const Process& process, std::size_t entry) {
  const auto overlap = static_cast<std::size_t>(std::ceil(process.motion.overlap_mm / job.line.fine_mm));
  std::vector<Run> runs = runs_along(job.work, process, entry, overlap);
  // check_zones() looks every millimetre: between two zones these finer places may meet a single one.
  std::erase_if(runs, [](const Run& run) { return run.steps == 0; });
  BITELINE_EXPECTS(!runs.empty());
  return runs;
}

/// Down to a run's first point, along it, and up again from its last.
void append_run(std::vector<ToolPoint>& points, const std::vector<ToolPoint>& along, const Motion& motion_in,
                const Motion& motion_out) {
  const SE3 &T_in = along.front().T_base_tcp, &T_out = along.back().T_base_tcp;
  const auto straight = [&](const SE3& T_from, const SE3& T_to, Segment segment, const Vec3& line_base) {
    if (!T_from.translation().isApprox(T_to.translation()))
      append_straight(points, T_from, T_to, segment, line_base);
  };
  straight(lifted(T_in, motion_in), clear(T_in, motion_in), Segment::Approach, along.front().line_base);
  straight(clear(T_in, motion_in), drawn_back(T_in, motion_in), Segment::Approach, along.front().line_base);
  append_straight(points, drawn_back(T_in, motion_in), T_in, Segment::Approach, along.front().line_base);
  points.back() = along.front();
  points.insert(points.end(), along.begin() + 1, along.end());
  append_straight(points, T_out, drawn_back(T_out, motion_out), Segment::Retreat, along.back().line_base);
  straight(drawn_back(T_out, motion_out), clear(T_out, motion_out), Segment::Retreat, along.back().line_base);
  straight(clear(T_out, motion_out), lifted(T_out, motion_out), Segment::Retreat, along.back().line_base);
}

/// Each piece's own beginning, the one first from which the ways between all of them are shortest.
std::vector<Seam> piece_beginnings(const Job& job, const Process& process) {
  // A way at the usual speed between places, against a turn of the joints to the beginning (entry.cpp).
  constexpr double k_harm_per_mm = 1e-3;
  const std::vector<Run> runs = runs_along(job.work, process, 0, 0);
  std::vector<Seam> out;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Run& before = runs[(i + runs.size() - 1) % runs.size()];
    const std::size_t hole = (runs[i].first + 2 * job.count() - before.first - before.steps) % job.count();
    out.push_back({.arc_mm = job.line.fine_mm * static_cast<double>(runs[i].first),
                   .harm = k_harm_per_mm * job.line.fine_mm * static_cast<double>(job.count() - hole),
                   .T_base_begins = lifted(job.frame(runs[i].first), process.motion)});
  }
  std::ranges::sort(out, {}, &Seam::harm);
  return out;
}

}  // namespace

const char* name_of(Segment segment) {
  static constexpr std::array k_names{"approach", "line", "retreat", "travel"};
  return k_names[static_cast<std::size_t>(segment)];
}

std::vector<Seam> seam_candidates(const cloud::ClosedLine& line, const Process& process) {
  const Job job = job_of(line, process);
  if (!process.only.empty()) return piece_beginnings(job, process);
  const std::vector<PathSample>& samples = job.line.samples;
  const double fine_mm = job.line.fine_mm;
  std::vector<double> cost(samples.size());
  if (process.start == Start::Auto) {
    cost = harm(samples, fine_mm);
  } else {
    const double sign = process.start == Start::Nearest ? 1 : -1;
    for (std::size_t i = 0; i < cost.size(); ++i) cost[i] = sign * samples[i].position.head<2>().norm();
  }
  // The best of each sector round the line: neighbours of the best one would fail for the same reason.
  const std::size_t sectors = process.start == Start::Auto ? k_seam_sectors : 1;
  std::vector<std::size_t> best;
  for (std::size_t sector = 0; sector < sectors; ++sector) {
    const auto from = cost.begin() + static_cast<std::ptrdiff_t>(sector * cost.size() / sectors);
    const auto to = cost.begin() + static_cast<std::ptrdiff_t>((sector + 1) * cost.size() / sectors);
    best.push_back(static_cast<std::size_t>(std::min_element(from, to) - cost.begin()));
  }
  std::ranges::sort(best, {}, [&](std::size_t i) { return cost[i]; });
  std::vector<Seam> out;
  for (const std::size_t i : best) {
    const double here_mm = fine_mm * static_cast<double>(i);
    // Two sectors may share one good place at their border.
    const bool taken = std::ranges::any_of(
        out, [&](const Seam& other) { return std::abs(other.arc_mm - here_mm) < k_seam_apart_mm; });
    if (taken) continue;
    const std::size_t first = runs_in(job, process, i).front().first;
    out.push_back(
        {.arc_mm = here_mm, .harm = cost[i], .T_base_begins = lifted(job.frame(first), process.motion)});
  }
  return out;
}

ToolPath make_tool_path(const cloud::ClosedLine& line, const Process& process, double seam_arc_mm,
                        double farther_back_mm) {
  const Motion& motion = process.motion;
  const Job job = job_of(line, process);
  const double fine_mm = job.line.fine_mm;
  const std::size_t entry = static_cast<std::size_t>(std::round(seam_arc_mm / fine_mm)) % job.count();
  const std::vector<Run> runs = runs_in(job, process, entry);
  std::vector<FineWay> ways;
  double way_mm = 0;
  for (const Run& run : runs) {
    ways.push_back(way_of(job, run));
    way_mm += ways.back().mm;
  }
  ToolPath path{.points = {},
                .seam_arc_mm = seam_arc_mm,
                .spacing_mm = target_spacing_mm(motion, way_mm),
                .standoff_mm = process.placement.standoff_mm};
  double done_mm = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ChordError error =
        chord_error(ways[i].tips, even_places(ways[i].tips, path.spacing_mm), motion.blend_mm);
    if (error.mm > path.chord_error_mm) {
      path.chord_error_mm = error.mm;
      path.chord_error_arc_mm = done_mm + error.arc_mm;
    }
    done_mm += ways[i].mm;
    const std::vector<ToolPoint> along = along_run(job, runs[i], ways[i], path.spacing_mm);
    const bool last = i + 1 == runs.size();
    const Motion motion_out = last ? motion : between(job, process, runs[i], runs[i + 1]);
    Motion motion_in = motion;
    if (i == 0) {
      motion_in.draw_back_mm += farther_back_mm;
      path.points.push_back({.T_base_tcp = lifted(along.front().T_base_tcp, motion_in),
                             .segment = Segment::Approach,
                             .arc_mm = 0,
                             .curvature_per_mm = 0,
                             .line_base = along.front().line_base});
    } else {
      motion_in = between(job, process, runs[i - 1], runs[i]);
      const std::vector<ToolPoint> way = travel(job, runs[i - 1], runs[i], motion_in);
      path.points.insert(path.points.end(), way.begin(), way.end());
    }
    append_run(path.points, along, motion_in, motion_out);
  }
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    path.points[i].arc_mm =
        path.points[i - 1].arc_mm +
        (path.points[i].T_base_tcp.translation() - path.points[i - 1].T_base_tcp.translation()).norm();
  }
  return path;
}

}  // namespace biteline::path
