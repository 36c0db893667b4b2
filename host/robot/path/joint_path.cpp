// SPDX-License-Identifier: MIT
#include "host/robot/path/joint_path.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/robot/kinematics/chain.hpp"
#include "host/robot/kinematics/inverse.hpp"

namespace biteline::path {
namespace {

using kinematics::Joints;
using kinematics::k_elbow;
constexpr double k_pi = std::numbers::pi;

// A step of the search grid is 8 mm; a joint that turns more than this over it would have to stop the tool.
constexpr double k_max_step_rad = 0.8;
// Per grid step the tool may be turned by so many grid turns either way.
constexpr int k_turn_steps = 4;
// The way to the path's beginning is slow: a radian of it costs as much as some whole turns along the path.
constexpr double k_way_there_cost = 1;
// On the ways in and out the tool had better not turn about its axis: they are short, and it would be slow.
constexpr double k_turn_beside_line_cost = 40;
// Between the knots the turns are smoothed: so far beside the search's own way a joint may come.
constexpr double k_beside_knots_rad = 0.1;
constexpr double k_unreached = 1e300;

struct State {
  Joints solved_rad;  ///< as the inverse gives it, within half a turn of zero
  Joints q_rad;       ///< with whole turns counted along the best way here
  Joints lowest_rad;  ///< on the best way here
  Joints highest_rad;
  int turn{0};
  double own_cost{0};
  double cost{k_unreached};
  int previous{-1};
};

struct Knot {
  std::size_t point{0};
  std::vector<State> states;
  int solved{0}, in_limits{0}, regular{0};  ///< how far states came, for the reason of a failure
  Clearance worst_clearance;
};

class Search {
 public:
  Search(const kinematics::ArmModel& arm, const ToolPath& path, const Tool& tool,
         const CollisionModel& collisions, const JointPathOptions& options)
      : arm_{arm}, path_{path}, tool_{tool}, collisions_{collisions}, options_{options} {
    round_ = tool.free_turn_rad > k_pi - 1e-6;
    // A tool that may not turn at all has one choice; a round one wraps, the others end at their freedom.
    turns_ = tool.free_turn_rad < 1e-6 ? 1 : options.turns;
    first_turn_rad_ = -tool.free_turn_rad;
    turn_step_rad_ = turns_ == 1 ? 0 : 2 * tool.free_turn_rad / (round_ ? turns_ : turns_ - 1);
  }

  JointPathResult run() {
    place_knots();
    oneapi::tbb::parallel_for(std::size_t{0}, knots_.size(), [&](std::size_t k) { fill(knots_[k]); });
    for (const Knot& knot : knots_) {
      if (knot.states.empty()) return {.path = std::nullopt, .blockage = why_empty(knot)};
    }
    // With whole turns as they count from the wished posture on; where a joint's limits leave no way so, with
    // those that fit.
    std::optional<std::size_t> stuck;
    if (options_.near_rad) stuck = connect_all(Turns::Counted);
    if (stuck || !options_.near_rad) stuck = connect_all(Turns::Fitted);
    if (stuck) return {.path = std::nullopt, .blockage = why_unconnected(*stuck)};
    return refine(backtrack());
  }

 private:
  enum class Turns { Counted, Fitted };

  void place_knots() {
    double next_mm = 0;
    for (std::size_t i = 0; i < path_.points.size(); ++i) {
      const bool last = i + 1 == path_.points.size();
      if (path_.points[i].arc_mm + 1e-9 < next_mm && !last) continue;
      knots_.push_back(
          {.point = i, .states = {}, .solved = 0, .in_limits = 0, .regular = 0, .worst_clearance = {}});
      next_mm = path_.points[i].arc_mm + options_.knot_spacing_mm;
    }
  }

  [[nodiscard]] SE3 T_base_flange(std::size_t point, double turn_rad) const {
    return path_.points[point].T_base_tcp * Eigen::AngleAxisd(turn_rad, Vec3::UnitZ()) *
           tool_.T_flange_tcp.inverse();
  }

  void fill(Knot& knot) const {
    for (int turn = 0; turn < turns_; ++turn) {
      const SE3 T = T_base_flange(knot.point, first_turn_rad_ + turn * turn_step_rad_);
      for (const kinematics::Solution& solution :
           kinematics::inverse(arm_, T, {.q6_hint_rad = 0, .search_folds = false})) {
        ++knot.solved;
        add_state(knot, solution.q_rad, turn);
      }
    }
  }

  void add_state(Knot& knot, const Joints& q_rad, int turn) const {
    if (((q_rad - arm_.limits.maximum_rad).array() > 0).any() ||
        ((arm_.limits.minimum_rad - q_rad).array() > 0).any())
      return;
    ++knot.in_limits;
    const auto frames = kinematics::joint_frames(arm_, q_rad);
    const double singularity = kinematics::singularity(arm_, q_rad, frames).worst();
    if (singularity < options_.least_singularity) return;
    ++knot.regular;
    const Clearance clearance = collisions_.clearance(frames, 20.0);
    if (clearance.mm < options_.least_clearance_mm) {
      if (knot.worst_clearance.mm > 1e8 || clearance.mm > knot.worst_clearance.mm)
        knot.worst_clearance = clearance;
      return;
    }
    State state;
    state.solved_rad = state.q_rad = state.lowest_rad = state.highest_rad = q_rad;
    state.turn = turn;
    // Staying 0.3 away from singularities and 20 mm from everything costs nothing, coming nearer costs like
    // turning.
    state.own_cost =
        std::pow(std::max(0.0, 0.3 / singularity - 1), 2) * 0.02 + 0.002 * std::max(0.0, 20.0 - clearance.mm);
    knot.states.push_back(state);
  }

  void begin(State& state, Turns turns) const {
    state.q_rad = state.solved_rad;
    state.cost = state.own_cost;
    if (options_.near_rad) {
      const Joints counted_rad =
          kinematics::nearest_turns(state.solved_rad, *options_.near_rad, arm_.limits, k_beside_knots_rad);
      state.cost += k_way_there_cost * (counted_rad - *options_.near_rad).cwiseAbs().maxCoeff();
      if (turns == Turns::Counted) state.q_rad = counted_rad;
    }
    state.lowest_rad = state.highest_rad = state.q_rad;
  }

  /// The knot that no way leads to; none: all are connected.
  std::optional<std::size_t> connect_all(Turns turns) {
    for (State& state : knots_.front().states) begin(state, turns);
    for (std::size_t k = 1; k < knots_.size(); ++k) {
      if (!connect(knots_[k - 1], knots_[k], turns)) return k;
    }
    return std::nullopt;
  }

  [[nodiscard]] int turn_distance(int a, int b) const {
    const int d = std::abs(a - b);
    return round_ ? std::min(d, turns_ - d) : d;
  }

  /// Extends the best ways by one knot; false when no state can be reached.
  bool connect(const Knot& from, Knot& to, Turns turns) const {
    bool any = false;
    const Segment segment = path_.points[to.point].segment;
    const bool beside_line = segment == Segment::Approach || segment == Segment::Retreat;
    for (State& state : to.states) {
      state.cost = k_unreached;
      for (std::size_t i = 0; i < from.states.size(); ++i) {
        const State& before = from.states[i];
        if (before.cost >= k_unreached || turn_distance(before.turn, state.turn) > k_turn_steps) continue;
        Joints q_here_rad;
        double turned2 = 0;
        bool possible = true;
        for (int joint = 0; joint < 6 && possible; ++joint) {
          double d_rad = state.solved_rad[joint] - before.solved_rad[joint];
          if (joint != k_elbow && std::abs(d_rad) > k_pi) d_rad -= std::copysign(2 * k_pi, d_rad);
          q_here_rad[joint] = before.q_rad[joint] + d_rad;
          turned2 += d_rad * d_rad;
          const double low_rad = std::min(before.lowest_rad[joint], q_here_rad[joint]);
          const double high_rad = std::max(before.highest_rad[joint], q_here_rad[joint]);
          const double least_rad = arm_.limits.minimum_rad[joint], most_rad = arm_.limits.maximum_rad[joint];
          possible = std::abs(d_rad) <= k_max_step_rad && high_rad - low_rad <= most_rad - least_rad;
          if (turns == Turns::Counted && joint != k_elbow)
            possible = possible && low_rad >= least_rad + k_beside_knots_rad &&
                       high_rad <= most_rad - k_beside_knots_rad;
        }
        const double turn_rad = turn_step_rad_ * turn_distance(before.turn, state.turn);
        const double cost = before.cost + turned2 + state.own_cost +
                            (beside_line ? k_turn_beside_line_cost * turn_rad * turn_rad : 0);
        if (!possible || cost >= state.cost) continue;
        state.cost = cost;
        state.previous = static_cast<int>(i);
        state.q_rad = q_here_rad;
        state.lowest_rad = before.lowest_rad.cwiseMin(q_here_rad);
        state.highest_rad = before.highest_rad.cwiseMax(q_here_rad);
        any = true;
      }
    }
    return any;
  }

  [[nodiscard]] std::vector<const State*> backtrack() const {
    std::vector<const State*> way(knots_.size());
    const auto last = std::ranges::min_element(knots_.back().states, {}, &State::cost);
    way.back() = &*last;
    for (std::size_t k = knots_.size() - 1; k > 0; --k) {
      way[k - 1] = &knots_[k - 1].states[static_cast<std::size_t>(way[k]->previous)];
    }
    return way;
  }

  /// Turn at every tool point: between the knots linear, then a running mean over two knot spacings against
  /// its corners.
  [[nodiscard]] std::vector<double> turns_along(const std::vector<const State*>& way) const {
    std::vector<double> knot_turns(way.size());
    for (std::size_t k = 0; k < way.size(); ++k) {
      const double turn_rad = first_turn_rad_ + way[k]->turn * turn_step_rad_;
      knot_turns[k] = k > 0 && round_ ? kinematics::nearest_turn(turn_rad, knot_turns[k - 1]) : turn_rad;
    }
    std::vector<double> linear(path_.points.size());
    std::size_t k = 0;
    for (std::size_t i = 0; i < linear.size(); ++i) {
      while (k + 2 < knots_.size() && knots_[k + 1].point <= i) ++k;
      if (knots_.size() == 1) {
        linear[i] = knot_turns[0];
        continue;
      }
      const double from_mm = path_.points[knots_[k].point].arc_mm,
                   to_mm = path_.points[knots_[k + 1].point].arc_mm;
      const double t = to_mm > from_mm ? (path_.points[i].arc_mm - from_mm) / (to_mm - from_mm) : 0;
      linear[i] = (1 - t) * knot_turns[k] + t * knot_turns[k + 1];
    }
    return smoothed(linear);
  }

  /// Gaussian over the arc; constant at both ends.
  [[nodiscard]] std::vector<double> smoothed(const std::vector<double>& values) const {
    constexpr double k_sigma_knots = 2.5;
    const double sigma_mm = k_sigma_knots * options_.knot_spacing_mm;
    std::vector<double> out(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double here_mm = path_.points[i].arc_mm;
      // Narrower towards the ends, so that the mean stays centred and the ends stay put.
      const double reach_mm = std::min(
          {3 * sigma_mm, here_mm - path_.points.front().arc_mm, path_.points.back().arc_mm - here_mm});
      double sum = values[i], weights = 1;
      for (const int direction : {-1, 1}) {
        for (std::size_t k = i + static_cast<std::size_t>(direction); k < values.size();
             k += static_cast<std::size_t>(direction)) {
          const double d_mm = std::abs(path_.points[k].arc_mm - here_mm);
          if (d_mm > reach_mm) break;
          const double weight = std::exp(-0.5 * d_mm * d_mm / (sigma_mm * sigma_mm));
          sum += weight * values[k];
          weights += weight;
        }
      }
      out[i] = sum / weights;
    }
    return out;
  }

  [[nodiscard]] JointPathResult refine(const std::vector<const State*>& way) const {
    JointPath path{.q_rad = {}, .turn_rad = turns_along(way)};
    Joints reference_rad = way.front()->q_rad;
    for (std::size_t i = 0; i < path_.points.size(); ++i) {
      const auto solutions = kinematics::inverse(arm_, T_base_flange(i, path.turn_rad[i]),
                                                 {.q6_hint_rad = reference_rad[5], .search_folds = false});
      std::optional<Joints> best;
      double best_rad = 1e9;
      for (const kinematics::Solution& solution : solutions) {
        Joints q_rad = solution.q_rad;
        for (int joint = 0; joint < 6; ++joint) {
          if (joint != k_elbow) q_rad[joint] = kinematics::nearest_turn(q_rad[joint], reference_rad[joint]);
        }
        const double far_rad = (q_rad - reference_rad).cwiseAbs().maxCoeff();
        if (far_rad < best_rad) {
          best_rad = far_rad;
          best = q_rad;
        }
      }
      if (!best || best_rad > k_max_step_rad) {
        return {.path = std::nullopt,
                .blockage = {.what = best ? Obstacle::Jump : Obstacle::Reach,
                             .arc_mm = path_.points[i].arc_mm,
                             .detail = best ? "the arm would have to jump to another configuration"
                                            : "out of the arm's reach"}};
      }
      path.q_rad.push_back(*best);
      reference_rad = *best;
    }
    choose_turns(path);
    return {.path = std::move(path), .blockage = {}};
  }

  /// Whole turns added so that each joint's range lies in its limits: near to the wished posture, or as
  /// centred as can be.
  void choose_turns(JointPath& path) const {
    for (int joint = 0; joint < 6; ++joint) {
      if (joint == k_elbow) continue;
      double low_rad = 1e9, high_rad = -1e9;
      for (const Joints& q_rad : path.q_rad) {
        low_rad = std::min(low_rad, q_rad[joint]);
        high_rad = std::max(high_rad, q_rad[joint]);
      }
      double shift_rad = -2 * k_pi * std::round(0.5 * (low_rad + high_rad) / (2 * k_pi));
      if (options_.near_rad) {
        const double begin_rad = path.q_rad.front()[joint];
        const double wished_rad =
            kinematics::nearest_turn(begin_rad, (*options_.near_rad)[joint]) - begin_rad;
        if (low_rad + wished_rad >= arm_.limits.minimum_rad[joint] &&
            high_rad + wished_rad <= arm_.limits.maximum_rad[joint])
          shift_rad = wished_rad;
      }
      for (Joints& q_rad : path.q_rad) q_rad[joint] += shift_rad;
    }
  }

  [[nodiscard]] Blockage why_empty(const Knot& knot) const {
    Blockage out{.what = Obstacle::Reach, .arc_mm = path_.points[knot.point].arc_mm, .detail = {}};
    if (knot.solved == 0) {
      out.detail = "out of the arm's reach";
    } else if (knot.in_limits == 0) {
      out.what = Obstacle::JointLimit;
      out.detail = "only with joints beyond their limits";
    } else if (knot.regular == 0) {
      out.what = Obstacle::Singularity;
      out.detail = "only in a singularity of the arm";
    } else {
      out.what = Obstacle::Collision;
      out.detail = std::string{knot.worst_clearance.what} + " collide in every configuration";
    }
    return out;
  }

  [[nodiscard]] Blockage why_unconnected(std::size_t k) const {
    return {.what = Obstacle::Jump,
            .arc_mm = path_.points[knots_[k].point].arc_mm,
            .detail =
                "every configuration of the arm that comes this far would have to jump or turn a joint past "
                "its limit"};
  }

  const kinematics::ArmModel& arm_;
  const ToolPath& path_;
  const Tool& tool_;
  const CollisionModel& collisions_;
  JointPathOptions options_;
  bool round_{false};
  int turns_{1};
  double first_turn_rad_{0};
  double turn_step_rad_{0};
  std::vector<Knot> knots_;
};

}  // namespace

JointPathResult find_joint_path(const kinematics::ArmModel& arm, const ToolPath& path, const Tool& tool,
                                const CollisionModel& collisions, const JointPathOptions& options) {
  return Search{arm, path, tool, collisions, options}.run();
}

}  // namespace biteline::path
