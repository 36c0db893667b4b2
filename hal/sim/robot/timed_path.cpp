// SPDX-License-Identifier: MIT
#include "hal/sim/robot/timed_path.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::sim {

namespace {

/// Way between two samples of the path; speed is taken as changing evenly between them.
constexpr double k_sample_mm = 0.5;
/// A turn counts as this much way: a process path turning round a toe of 35 mm radius is not slowed by it.
constexpr double k_turn_mm_per_rad = 20;
constexpr int k_blend_samples = 8;

double way_mm(const SE3& from, const SE3& to) {
  const double turn_rad = geometry::angle_between_rad(from.linear(), to.linear());
  return std::max((to.translation() - from.translation()).norm(), k_turn_mm_per_rad * turn_rad);
}

/// Translation along the straight line, rotation along the geodesic.
SE3 between(const SE3& from, const SE3& to, double part) {
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(from.linear()).slerp(part, Eigen::Quaterniond(to.linear()));
  return geometry::make_se3(rotation, from.translation() + part * (to.translation() - from.translation()));
}

}  // namespace

TimedPath::TimedPath(const SE3& T_base_tcp_start, const std::vector<StraightMove>& moves) {
  if (moves.empty()) return;
  SE3 from = T_base_tcp_start;
  add(from, moves.front());
  samples_.front().limit_mm_s = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const StraightMove& move = moves[i];
    const bool last = i + 1 == moves.size();
    // Half of each side at most, so that the blends at its two ends do not overlap.
    const SE3 before = i == 0 ? T_base_tcp_start : moves[i - 1].T_base_tcp;
    const double in_mm = way_mm(before, move.T_base_tcp);
    const double out_mm = last ? 0 : way_mm(move.T_base_tcp, moves[i + 1].T_base_tcp);
    const double cut_mm = last ? 0 : std::min({move.blend_mm, in_mm / 2, out_mm / 2});
    if (cut_mm <= 1e-9) {
      add_line(from, move.T_base_tcp, move);
      if (last || move.blend_mm <= 0) samples_.back().limit_mm_s = 0;
      from = move.T_base_tcp;
      continue;
    }
    const SE3 enter = between(before, move.T_base_tcp, 1 - cut_mm / in_mm);
    const SE3 leave = between(move.T_base_tcp, moves[i + 1].T_base_tcp, cut_mm / out_mm);
    add_line(from, enter, move);
    for (int k = 1; k <= k_blend_samples; ++k) {
      const double u = static_cast<double>(k) / k_blend_samples;
      add(between(between(enter, move.T_base_tcp, u), between(move.T_base_tcp, leave, u), u), move);
    }
    from = leave;
  }
  set_speeds();
  set_times();
}

void TimedPath::add(const SE3& T_base_tcp, const StraightMove& move) {
  const double step_mm = samples_.empty() ? 0 : way_mm(samples_.back().T_base_tcp, T_base_tcp);
  if (!samples_.empty() && step_mm < 1e-9) return;
  samples_.push_back({.T_base_tcp = T_base_tcp,
                      .limit_mm_s = move.speed_mm_s,
                      .acceleration_mm_s2 = move.acceleration_mm_s2,
                      .way_mm = step_mm});
}

void TimedPath::add_line(const SE3& from, const SE3& to, const StraightMove& move) {
  const int steps = std::max(1, static_cast<int>(std::ceil(way_mm(from, to) / k_sample_mm)));
  for (int k = 1; k <= steps; ++k) add(between(from, to, static_cast<double>(k) / steps), move);
}

void TimedPath::set_speeds() {
  // v^2 may change by 2 a ds from sample to sample, in either direction of time.
  samples_.back().limit_mm_s = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    Sample& sample = samples_[i];
    sample.speed_mm_s = sample.limit_mm_s;
    if (i == 0) continue;
    const double before = samples_[i - 1].speed_mm_s;
    sample.speed_mm_s = std::min(sample.speed_mm_s,
                                 std::sqrt(before * before + 2 * sample.acceleration_mm_s2 * sample.way_mm));
  }
  for (std::size_t i = samples_.size() - 1; i > 0; --i) {
    const double after = samples_[i].speed_mm_s;
    Sample& sample = samples_[i - 1];
    sample.speed_mm_s =
        std::min(sample.speed_mm_s,
                 std::sqrt(after * after + 2 * samples_[i].acceleration_mm_s2 * samples_[i].way_mm));
  }
}

void TimedPath::set_times() {
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    Sample& sample = samples_[i];
    const double mean_mm_s = 0.5 * (sample.speed_mm_s + samples_[i - 1].speed_mm_s);
    // Between two stops only one sample apart: there and still, half the way each.
    const double step_s = mean_mm_s > 1e-9 ? sample.way_mm / mean_mm_s
                                           : 2 * std::sqrt(sample.way_mm / sample.acceleration_mm_s2);
    sample.time_s = samples_[i - 1].time_s + step_s;
  }
}

SE3 TimedPath::T_base_tcp_at(double time_s) const {
  if (time_s <= 0 || samples_.size() == 1) return samples_.front().T_base_tcp;
  if (time_s >= duration_s()) return samples_.back().T_base_tcp;
  const auto after = std::upper_bound(samples_.begin(), samples_.end(), time_s,
                                      [](double t, const Sample& s) { return t < s.time_s; });
  const Sample& to = *after;
  const Sample& from = *(after - 1);
  const double whole_s = to.time_s - from.time_s, part_s = time_s - from.time_s;
  const double change = (to.speed_mm_s - from.speed_mm_s) / whole_s;
  const double way = from.speed_mm_s + to.speed_mm_s > 1e-9
                         ? (from.speed_mm_s + 0.5 * change * part_s) * part_s / to.way_mm
                         : part_s / whole_s;
  return between(from.T_base_tcp, to.T_base_tcp, std::clamp(way, 0.0, 1.0));
}

}  // namespace biteline::sim
