// SPDX-License-Identifier: MIT
#include "host/robot/path/force_told.hpp"

#include <algorithm>
#include <cmath>

#include "host/robot/path/checks/program_check.hpp"
#include "host/robot/path/force.hpp"
#include "host/robot/path/place.hpp"

namespace biteline::path {
namespace {

constexpr double k_told_lag_s = 0.05;

/// Of the run on the line that a waypoint is in; nothing: it is in none.
const PathRun* run_at(std::span<const PathRun> runs, std::size_t waypoint) {
  const auto found = std::ranges::find_if(
      runs, [&](const PathRun& run) { return run.first <= waypoint && waypoint < run.last; });
  return found == runs.end() ? nullptr : &*found;
}

double round_ratio_at(const PlannedPath& path, const PathPlace& place) {
  const double a = path.waypoints[place.segment].round_ratio,
               b = path.waypoints[place.segment + 1].round_ratio;
  const double step = b - a - std::round(b - a);  // over the heel's end
  const double ratio = a + place.fraction * step;
  return ratio - std::floor(ratio);
}

/// A reading that shakes, through a first-order lag.
class Smooth {
 public:
  double take(double newton, double time_s) {
    const double step_s = last_s_ ? std::max(0.0, time_s - *last_s_) : 0;
    value_ = last_s_ ? value_ + step_s / (step_s + k_told_lag_s) * (newton - value_) : newton;
    last_s_ = time_s;
    return value_;
  }
  void forget() { last_s_.reset(); }

 private:
  double value_{0};
  std::optional<double> last_s_{};
};

struct Figures {
  double inside{0}, sum{0}, squares{0}, along{0};
  void take(ForceTold& told, double newton, double set_newton, double along_mm) {
    told.least_newton = told.samples == 0 ? newton : std::min(told.least_newton, newton);
    told.largest_newton = told.samples == 0 ? newton : std::max(told.largest_newton, newton);
    ++told.samples;
    const double off = newton - set_newton;
    inside += std::abs(off) <= k_force_band_ratio * set_newton ? 1 : 0;
    sum += newton;
    squares += off * off;
    along += along_mm;
  }
  void tell(ForceTold& told) const {
    const auto n = static_cast<double>(told.samples);
    told.within = inside / n;
    told.mean_newton = sum / n;
    told.rms_off_newton = std::sqrt(squares / n);
    told.along_mm = along / n;
  }
};

}  // namespace

std::optional<ForceTold> force_told(const PlannedPath& path, std::span<const TrackSample> track,
                                    const ForceLearned& learned) {
  if (!presses(path)) return std::nullopt;
  const Force& force = *path.force;
  const std::vector<PathRun> runs = runs_of(path, Segment::Line);
  const std::span<const Vec3> errors{learned.error_tcp};
  const auto zero_of = [&](const PathRun& run) {
    return at_place(errors, path.waypoints[run.first].round_ratio);
  };
  ForceTold told;
  const Vec3 first_zero = zero_of(runs.front());
  Figures figures;
  Smooth smooth;
  AlongPath along{path};
  for (const TrackSample& sample : track) {
    const std::optional<PathPlace> place = along.next(sample.T_base_tcp.translation());
    const PathRun* run = place ? run_at(runs, place->segment) : nullptr;
    const double arc_mm = place ? arc_at(path, *place) : 0;
    const bool level = run != nullptr && arc_mm >= path.waypoints[run->first].arc_mm + force.ramp_mm &&
                       arc_mm <= path.waypoints[run->last].arc_mm - force.ramp_mm;
    const std::optional<Vec3> felt =
        place ? felt_newton(path, *place, sample.force_base_newton, sample.flange_ratio) : std::nullopt;
    if (!level || !sample.presses || !felt || !felt->allFinite()) {
      smooth.forget();
      continue;
    }
    const Mat3 R_tcp_base = sample.T_base_tcp.linear().transpose();
    const Vec3 press_base = press_at(path, *place);
    const double ratio = round_ratio_at(path, *place);
    const Vec3 zero = zero_of(*run);
    const ForceSample reading{ratio, R_tcp_base * *felt, R_tcp_base * press_base};
    const Vec3 error = at_place(errors, ratio) - zero;
    figures.take(told, smooth.take(-(reading.told_tcp - error).dot(reading.press_tcp), sample.time_s),
                 force.set_newton,
                 (sample.T_base_tcp.translation() - pose_at(path, *place).translation()).dot(press_base));
    told.learn.push_back({ratio, reading.told_tcp + zero - first_zero, reading.press_tcp});
  }
  if (told.samples == 0) return std::nullopt;
  figures.tell(told);
  double way_mm = 0;
  for (const PathRun& run : runs)
    way_mm += path.waypoints[run.last].arc_mm - path.waypoints[run.first].arc_mm;
  told.place = {.begin_ratio = path.waypoints[runs.front().first].round_ratio,
                .lead_ratio = way_mm > 0 ? k_force_lag_s * path.motion.speed_mm_s / way_mm : 0};
  return told;
}

std::vector<ForceSample> air_told(const PlannedPath& path, std::span<const TrackSample> track) {
  std::vector<ForceSample> samples;
  const std::vector<PathRun> runs = runs_of(path, Segment::Line);
  AlongPath along{path};
  for (const TrackSample& sample : track) {
    const std::optional<PathPlace> place = along.next(sample.T_base_tcp.translation());
    if (!place || run_at(runs, place->segment) == nullptr || !sample.force_base_newton) continue;
    const Mat3 R_tcp_base = sample.T_base_tcp.linear().transpose();
    samples.push_back({round_ratio_at(path, *place), R_tcp_base * *sample.force_base_newton,
                       R_tcp_base * press_at(path, *place)});
  }
  return samples;
}

}  // namespace biteline::path
