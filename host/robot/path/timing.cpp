// SPDX-License-Identifier: MIT
#include "host/robot/path/timing.hpp"

#include <algorithm>
#include <cmath>

#include "host/robot/path/even_ramps.hpp"
#include "host/robot/path/give.hpp"

namespace biteline::path {
namespace {

using kinematics::Joints;

// Of each joint's acceleration limit: following the path's bends takes at most this share; what it leaves at
// the speed there is for speeding up.
constexpr double k_bend_share = 0.9;
// Where a straight way bends by more than this the tip stops; below, the blend rounds it.
constexpr double k_corner_cosine = 0.94;  // 20 degrees

double step_mm(const ToolPath& path, std::size_t i) {
  return path.points[i + 1].arc_mm - path.points[i].arc_mm;
}

/// Of a tip on its way in or out: the way to where it works, and how far it stands off there.
double from_work_mm(const ToolPath& path, std::size_t i) {
  const Segment segment = path.points[i].segment;
  std::size_t work = i;
  if (segment == Segment::Approach) {
    while (work + 1 < path.points.size() && path.points[work].segment == segment) ++work;
  } else {
    while (work > 0 && path.points[work].segment == segment) --work;
  }
  const Vec3 way = path.points[i].T_base_tcp.translation() - path.points[work].T_base_tcp.translation();
  return way.norm() + path.standoff_mm;
}

double process_speed_mm_s(const ToolPath& path, std::size_t i, const Motion& motion) {
  constexpr double k_rounding_mm = 1e-6;
  switch (path.points[i].segment) {
    case Segment::Line:
      return motion.speed_mm_s * path.points[i].speed_ratio;
    case Segment::Travel:
      return motion.transfer_speed_mm_s;
    case Segment::Approach:
    case Segment::Retreat:
      break;
  }
  // The last way to the line and the first away from it are slow, wherever beside the line the tip works; the
  // lift is fast, and so is a tip that stands off.
  return from_work_mm(path, i) < motion.approach_mm - k_rounding_mm ? motion.approach_speed_mm_s
                                                                    : motion.transfer_speed_mm_s;
}

/// dq/ds and d2q/ds2 by differences over uneven steps.
struct Derivatives {
  Joints first;
  Joints second;
};
Derivatives derivatives(const ToolPath& path, const JointPath& joints, std::size_t i) {
  const std::size_t n = joints.q_rad.size();
  const std::size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, n - 1);
  const double back_mm = path.points[i].arc_mm - path.points[a].arc_mm,
               ahead_mm = path.points[b].arc_mm - path.points[i].arc_mm;
  Derivatives d{.first = Joints::Zero(), .second = Joints::Zero()};
  if (back_mm + ahead_mm <= 0) return d;
  d.first = (joints.q_rad[b] - joints.q_rad[a]) / (back_mm + ahead_mm);
  if (back_mm > 0 && ahead_mm > 0) {
    d.second =
        2 * ((joints.q_rad[b] - joints.q_rad[i]) / ahead_mm - (joints.q_rad[i] - joints.q_rad[a]) / back_mm) /
        (back_mm + ahead_mm);
  }
  return d;
}

/// The arm's give at one place, and how much of it there may be.
struct GiveLimit {
  GiveRate rate{};
  double most_mm{0};      ///< 0: it is not looked at
  double least_mm_s2{0};  ///< no give keeps the tool from speeding up so
};

/// What the joints leave for speeding up and slowing down at one place.
class Room {
 public:
  Room(const kinematics::ArmModel& arm, const Derivatives& d, double most_mm_s2, const GiveLimit& give)
      : first_{d.first.cwiseAbs()},
        second_{d.second.cwiseAbs()},
        most_rad_s2_{arm.limits.acceleration_rad_s2},
        most_mm_s2_{most_mm_s2},
        give_{give} {}
  [[nodiscard]] double at_mm_s2(double speed_mm_s) const {
    double room_mm_s2 = most_mm_s2_;
    const auto left = [&](double first, double second, double most) {
      if (!(first > 1e-9)) return most_mm_s2_;
      const double bend = std::min(second * speed_mm_s * speed_mm_s, k_bend_share * most);
      return (most - bend) / first;
    };
    for (int joint = 0; joint < 6; ++joint)
      room_mm_s2 = std::min(room_mm_s2, left(first_[joint], second_[joint], most_rad_s2_[joint]));
    if (!(give_.most_mm > 0)) return room_mm_s2;
    const double by_give =
        left(give_.rate.per_acceleration.norm(), give_.rate.per_speed2.norm(), give_.most_mm);
    return std::min(room_mm_s2, std::max(by_give, give_.least_mm_s2));
  }
  /// Following the bends alone; for the give no slower than `least_mm_s`.
  [[nodiscard]] double most_speed_mm_s(double least_mm_s) const {
    double most_mm_s = k_most_speed_mm_s;
    const auto limit = [&](double second, double most) {
      if (second > 1e-9) most_mm_s = std::min(most_mm_s, std::sqrt(k_bend_share * most / second));
    };
    if (give_.most_mm > 0) limit(give_.rate.per_speed2.norm(), give_.most_mm);
    most_mm_s = std::max(most_mm_s, least_mm_s);
    for (int joint = 0; joint < 6; ++joint) limit(second_[joint], most_rad_s2_[joint]);
    return most_mm_s;
  }

 private:
  Joints first_, second_, most_rad_s2_;
  double most_mm_s2_;
  GiveLimit give_;
};

bool stops_at(const ToolPath& path, std::size_t i, const Motion& motion) {
  if (i == 0 || i + 1 == path.points.size()) return true;
  const Segment here = path.points[i].segment, before = path.points[i - 1].segment,
                after = path.points[i + 1].segment;
  if ((here == Segment::Line || here == Segment::Travel) && before == here && after == here)
    return false;  // rounded: its curvature limits the speed
  if (here == Segment::Travel && after == here) return false;
  if (here == Segment::Travel ? after != here : after == Segment::Travel) return true;
  // A controller drives a straight way at the fastest speed planned on it: what is slow is a way of its own.
  const auto slower = [&](std::size_t other) {
    const bool stands_off = path.standoff_mm >= motion.approach_mm;
    const double at_work_mm_s = stands_off ? motion.transfer_speed_mm_s : motion.approach_speed_mm_s;
    const bool working = path.points[other].segment == Segment::Line;
    return (working ? at_work_mm_s : process_speed_mm_s(path, other, motion)) <
           process_speed_mm_s(path, i, motion);
  };
  if (here == Segment::Approach && slower(i + 1)) return true;
  if (here == Segment::Retreat && slower(i - 1)) return true;
  const Vec3 p = path.points[i].T_base_tcp.translation();
  const Vec3 in = p - path.points[i - 1].T_base_tcp.translation(),
             out = path.points[i + 1].T_base_tcp.translation() - p;
  return in.dot(out) < k_corner_cosine * in.norm() * out.norm();
}

/// From stop to stop beside the line in a straight way: the slowest place's speed for all.
void even_out_ways(const ToolPath& path, std::vector<double>& speed_mm_s) {
  const auto moves_on_way = [&](std::size_t i) {
    if (i >= speed_mm_s.size() || speed_mm_s[i] <= 0) return false;
    return path.points[i].segment == Segment::Approach || path.points[i].segment == Segment::Retreat;
  };
  for (std::size_t first = 0; first < speed_mm_s.size(); ++first) {
    if (!moves_on_way(first)) continue;
    std::size_t end = first;
    while (moves_on_way(end)) ++end;
    const auto begin = speed_mm_s.begin();
    const auto from = begin + static_cast<std::ptrdiff_t>(first),
               to = begin + static_cast<std::ptrdiff_t>(end);
    std::fill(from, to, *std::min_element(from, to));
    first = end;
  }
}

std::vector<GivePlace> places_of(const ToolPath& path, const JointPath& joints, const Timing& timing) {
  std::vector<GivePlace> places;
  for (std::size_t i = 0; i < path.points.size(); ++i)
    places.push_back({.q_rad = joints.q_rad[i],
                      .work_base = path.points[i].line_base,
                      .arc_mm = path.points[i].arc_mm,
                      .speed_mm_s = timing.speed_mm_s[i],
                      .time_s = timing.time_s[i]});
  return places;
}

/// What may give at each place: on the line, and before it, what its stop there leaves swinging.
std::vector<GiveLimit> give_limits(const kinematics::ArmModel& arm, const ToolPath& path,
                                   const JointPath& joints, const Timing& untimed, const Motion& motion) {
  std::vector<GiveLimit> limits(path.points.size());
  if (!motion.give_mm) return limits;
  const std::vector<GiveRate> rates = give_rates(arm, places_of(path, joints, untimed));
  // Four times what comes to the least speed on the way on which the process's own comes to its speed.
  const double least_mm_s2 =
      4 * motion.acceleration_mm_s2 * std::pow(motion.minimum_speed_mm_s / motion.speed_mm_s, 2);
  double most_before_line{0};
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const Segment segment = path.points[i].segment;
    if (segment == Segment::Approach)
      most_before_line = std::max(most_before_line, rates[i].per_acceleration.norm());
    if (segment == Segment::Line)
      limits[i] = {.rate = rates[i], .most_mm = *motion.give_mm, .least_mm_s2 = least_mm_s2};
  }
  // A ramp that ends at once swings up to twice its give, and the one before may still do; one acceleration
  // for all ways in.
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (path.points[i].segment != Segment::Approach) continue;
    limits[i] = {.rate = {.per_acceleration = Vec3{most_before_line, 0, 0}, .per_speed2 = Vec3::Zero()},
                 .most_mm = *motion.give_mm / 3,
                 .least_mm_s2 = least_mm_s2};
  }
  return limits;
}

/// Calls `on_run(first, last)` for each stretch of the line, three points or more.
template <class OnRun>
void for_each_line_run(const ToolPath& path, const OnRun& on_run) {
  for (std::size_t first = 0; first < path.points.size(); ++first) {
    if (path.points[first].segment != Segment::Line) continue;
    std::size_t end = first;
    while (end < path.points.size() && path.points[end].segment == Segment::Line) ++end;
    if (end - first >= 3) on_run(first, end - 1);
    first = end - 1;
  }
}

/// From one place to the next, in either direction of time, what the joints leave at both.
void keep_to_rooms(const ToolPath& path, const std::vector<Room>& rooms, std::vector<double>& speed_mm_s) {
  const std::size_t n = speed_mm_s.size();
  const auto reach = [&](std::size_t from, std::size_t to) {
    const double v = speed_mm_s[from], step = step_mm(path, std::min(from, to));
    const auto faster = [&](double a) { return std::sqrt(v * v + 2 * a * step); };
    const double begun = std::min(speed_mm_s[to], faster(rooms[from].at_mm_s2(v)));
    const double a = std::min(rooms[from].at_mm_s2(v), rooms[to].at_mm_s2(begun));
    speed_mm_s[to] = std::min(begun, faster(a));
  };
  for (std::size_t i = 0; i + 1 < n; ++i) reach(i, i + 1);
  for (std::size_t i = n - 1; i > 0; --i) reach(i, i - 1);
}

/// Of the step from point i to the next.
double step_s(const ToolPath& path, const std::vector<Room>& rooms, const std::vector<double>& speed_mm_s,
              const Motion& motion, std::size_t i) {
  const double mean_mm_s = 0.5 * (speed_mm_s[i] + speed_mm_s[i + 1]);
  const double a = std::min(rooms[i].at_mm_s2(0), rooms[i + 1].at_mm_s2(0));
  // From stop to stop in one step: faster, at most as fast as the program drives it, and slower again.
  const bool worked = path.points[i].segment == Segment::Line && path.points[i + 1].segment == Segment::Line;
  if (!worked && mean_mm_s > 0) {
    const auto [slow, fast] = std::minmax(speed_mm_s[i], speed_mm_s[i + 1]);
    const double ramp_mm = (fast * fast - slow * slow) / (2 * a);
    return (fast - slow) / a + std::max(step_mm(path, i) - ramp_mm, 0.0) / fast;
  }
  if (mean_mm_s > 0) return step_mm(path, i) / mean_mm_s;
  const double most_mm_s = std::min(worked ? process_speed_mm_s(path, i, motion) : motion.approach_speed_mm_s,
                                    std::sqrt(a * step_mm(path, i)));
  return most_mm_s > 0 ? step_mm(path, i) / most_mm_s + most_mm_s / a : 0;
}

std::vector<double> arcs_of(const ToolPath& path) {
  std::vector<double> arc_mm;
  for (const ToolPoint& point : path.points) arc_mm.push_back(point.arc_mm);
  return arc_mm;
}

/// Of the moves of a path whose give is looked at.
std::vector<double> accelerations(const ToolPath& path, const std::vector<Room>& rooms,
                                  const std::vector<double>& speed_mm_s, const Motion& motion) {
  // A speed that hardly changes is still reached, whatever a controller makes of it meanwhile.
  constexpr double k_least_mm_s2 = 50;
  std::vector<double> out(speed_mm_s.size(), motion.acceleration_mm_s2);
  for (std::size_t i = 1; i < out.size(); ++i) {
    const Segment segment = path.points[i - 1].segment;
    if (segment == Segment::Approach) out[i] = std::min(out[i], rooms[i - 1].at_mm_s2(0));
    if (segment != Segment::Line || path.points[i].segment != Segment::Line) continue;
    const double change = std::abs(std::pow(speed_mm_s[i], 2) - std::pow(speed_mm_s[i - 1], 2));
    out[i] = std::clamp(change / (2 * step_mm(path, i - 1)), k_least_mm_s2, out[i]);
  }
  return out;
}

/// Speeds and times along a path, from the speeds that its places allow.
class Timer {
 public:
  Timer(const kinematics::ArmModel& arm, const ToolPath& path, const JointPath& joints, const Motion& motion)
      : arm_{arm}, path_{path}, joints_{joints}, motion_{motion}, arc_mm_{arcs_of(path)} {
    const std::size_t n = path.points.size();
    const std::vector<GiveLimit> give = give_limits(
        arm, path, joints, {.speed_mm_s = std::vector(n, 0.0), .time_s = std::vector(n, 0.0)}, motion);
    for (std::size_t i = 0; i < n; ++i) {
      const Derivatives d = derivatives(path, joints, i);
      rooms_.emplace_back(arm, d, motion.acceleration_mm_s2, give[i]);
      limit_mm_s_.push_back(stops_at(path, i, motion) ? 0 : limit_mm_s(d, i));
    }
    even_out_ways(path, limit_mm_s_);
  }

  [[nodiscard]] Timing timing() const {
    const std::size_t n = limit_mm_s_.size();
    Timing timing{.speed_mm_s = limit_mm_s_, .time_s = std::vector<double>(n)};
    if (motion_.give_mm) lower_for_mean(timing.speed_mm_s);
    keep_to_rooms(path_, rooms_, timing.speed_mm_s);
    std::vector<double> steps_s(n, 0.0);
    for (std::size_t i = 0; i + 1 < n; ++i)
      steps_s[i + 1] = step_s(path_, rooms_, timing.speed_mm_s, motion_, i);
    if (motion_.give_mm) {
      average(timing.speed_mm_s, steps_s);
      timing.acceleration_mm_s2 = accelerations(path_, rooms_, timing.speed_mm_s, motion_);
    }
    for (std::size_t i = 1; i < n; ++i) timing.time_s[i] = timing.time_s[i - 1] + steps_s[i];
    return timing;
  }

  /// Slower before each place of the line where the arm gives more than it may; false: it does nowhere, or
  /// the process's least speed is reached.
  bool slow_down(const Timing& timing) {
    constexpr double k_least_ratio = 0.7;
    const std::vector<double> give_mm = give_along_mm(arm_, places_of(path_, joints_, timing));
    std::vector<double> ratio(give_mm.size(), 1.0);
    for (std::size_t i = 0; i < give_mm.size(); ++i) {
      if (path_.points[i].segment != Segment::Line || !(give_mm[i] > *motion_.give_mm)) continue;
      const double wanted = std::max(k_least_ratio, std::sqrt(*motion_.give_mm / give_mm[i]));
      for (std::size_t k = i + 1; k > 0 && path_.points[k - 1].segment == Segment::Line &&
                                  timing.time_s[i] - timing.time_s[k - 1] <= 0.5 * window_s();
           --k)
        ratio[k - 1] = std::min(ratio[k - 1], wanted);
    }
    bool slower = false;
    for (std::size_t i = 0; i < ratio.size(); ++i) {
      if (!(ratio[i] < 1) || !(limit_mm_s_[i] > least_mm_s())) continue;
      // What it goes at now, where that is below its limit anyway.
      const double now_mm_s = std::min(limit_mm_s_[i], std::max(timing.speed_mm_s[i], least_mm_s()));
      limit_mm_s_[i] = std::max(ratio[i] * now_mm_s, least_mm_s());
      slower = true;
    }
    return slower;
  }

 private:
  [[nodiscard]] double window_s() const { return 1 / arm_.give.natural_hz.minCoeff(); }
  /// The arm's give slows no tool below what its process needs.
  [[nodiscard]] double least_mm_s() const { return 1.05 * motion_.minimum_speed_mm_s; }

  /// Of the joints per mm, the faster of both steps: those of a travel are long.
  [[nodiscard]] Joints step_rate(std::size_t i) const {
    const auto of = [&](std::size_t from) {
      const double mm = step_mm(path_, from);
      return mm > 0 ? Joints{(joints_.q_rad[from + 1] - joints_.q_rad[from]).cwiseAbs() / mm}
                    : Joints{Joints::Zero()};
    };
    return of(i - 1).cwiseMax(of(std::min(i, path_.points.size() - 2)));
  }

  [[nodiscard]] double limit_mm_s(const Derivatives& d, std::size_t i) const {
    double limit_mm_s = std::min(process_speed_mm_s(path_, i, motion_), k_most_speed_mm_s);
    const double curvature = path_.points[i].curvature_per_mm;
    if (curvature > 1e-6)
      limit_mm_s = std::min(limit_mm_s, std::sqrt(motion_.cross_acceleration_mm_s2 / curvature));
    const Joints rate =
        path_.points[i].segment == Segment::Travel ? step_rate(i) : Joints{d.first.cwiseAbs()};
    for (int joint = 0; joint < 6; ++joint) {
      const double first = rate[joint];
      if (first > 1e-9)
        limit_mm_s = std::min(limit_mm_s, motion_.joint_speed_ratio * arm_.limits.speed_rad_s[joint] / first);
    }
    return std::min(limit_mm_s, rooms_[i].most_speed_mm_s(least_mm_s()));
  }

  template <class T>
  [[nodiscard]] static auto part_of(T& values, std::size_t first, std::size_t last) {
    return std::span{values}.subspan(first, last - first + 1);
  }

  void lower_for_mean(std::vector<double>& speed_mm_s) const {
    for_each_line_run(path_, [&](std::size_t first, std::size_t last) {
      const auto run = part_of(speed_mm_s, first, last);
      std::ranges::copy(lowered_for_mean(part_of(arc_mm_, first, last), run, window_s()), run.begin());
    });
  }

  void average(std::vector<double>& speed_mm_s, std::vector<double>& steps_s) const {
    for_each_line_run(path_, [&](std::size_t first, std::size_t last) {
      const auto run = part_of(speed_mm_s, first, last);
      const TimeLaw law = averaged(part_of(arc_mm_, first, last), run, window_s());
      std::ranges::copy(law.speed_mm_s, run.begin());
      for (std::size_t i = first + 1; i <= last; ++i)
        steps_s[i] = law.time_s[i - first] - law.time_s[i - first - 1];
    });
  }

  const kinematics::ArmModel& arm_;
  const ToolPath& path_;
  const JointPath& joints_;
  const Motion& motion_;
  std::vector<double> arc_mm_;
  std::vector<Room> rooms_{};
  std::vector<double> limit_mm_s_{};
};

}  // namespace

Timing time_path(const kinematics::ArmModel& arm, const ToolPath& path, const JointPath& joints,
                 const Motion& motion) {
  constexpr int k_most_rounds = 12;
  Timer timer{arm, path, joints, motion};
  Timing timing = timer.timing();
  for (int i = 0; motion.give_mm && i < k_most_rounds && timer.slow_down(timing); ++i)
    timing = timer.timing();
  return timing;
}

JointAcceleration worst_acceleration(const kinematics::ArmModel& arm, const ToolPath& path,
                                     const JointPath& joints, const Timing& timing) {
  JointAcceleration worst;
  for (std::size_t i = 1; i + 1 < joints.q_rad.size(); ++i) {
    const double back_s = timing.time_s[i] - timing.time_s[i - 1],
                 ahead_s = timing.time_s[i + 1] - timing.time_s[i];
    if (back_s <= 0 || ahead_s <= 0) continue;
    const Joints a = ((joints.q_rad[i + 1] - joints.q_rad[i]) / ahead_s -
                      (joints.q_rad[i] - joints.q_rad[i - 1]) / back_s) *
                     (2 / (back_s + ahead_s));
    for (int joint = 0; joint < 6; ++joint) {
      const double ratio = std::abs(a[joint]) / arm.limits.acceleration_rad_s2[joint];
      if (ratio > worst.ratio) worst = {.ratio = ratio, .arc_mm = path.points[i].arc_mm, .joint = joint};
    }
  }
  return worst;
}

}  // namespace biteline::path
