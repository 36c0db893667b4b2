// SPDX-License-Identifier: MIT
#include "hal/sim/robot/program.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace biteline::sim {

namespace {

/// Way along a move that speeds up evenly, cruises and slows down evenly, and the whole move's time.
struct Trapezoid {
  double way, speed, acceleration;

  [[nodiscard]] double peak_speed() const { return std::min(speed, std::sqrt(way * acceleration)); }
  [[nodiscard]] double duration_s() const {
    return way <= 0 ? 0 : way / peak_speed() + peak_speed() / acceleration;
  }
  [[nodiscard]] double at(double time_s) const {
    const double whole_s = duration_s(), ramp_s = peak_speed() / acceleration;
    if (time_s <= 0) return 0;
    if (time_s >= whole_s) return way;
    if (time_s < ramp_s) return 0.5 * acceleration * time_s * time_s;
    if (time_s > whole_s - ramp_s) return way - 0.5 * acceleration * (whole_s - time_s) * (whole_s - time_s);
    return peak_speed() * (time_s - 0.5 * ramp_s);
  }
};

/// The same posture with each joint within half a turn of `reference_rad`.
JointVector nearest_turns(JointVector q_rad, const JointVector& reference_rad) {
  for (Eigen::Index i = 0; i < q_rad.size(); ++i) {
    q_rad[i] = reference_rad[i] + std::remainder(q_rad[i] - reference_rad[i], 2 * std::numbers::pi);
  }
  return q_rad;
}

/// Farther from the base than all links in a row.
bool beyond(const SE3& T_base_tcp, const SE3& T_flange_tcp, const ArmKinematics& arm) {
  double links_mm = 0;
  for (const ArmKinematics::DhRow& row : arm.rows()) links_mm += std::abs(row.a_mm) + std::abs(row.d_mm);
  return (T_base_tcp * T_flange_tcp.inverse(Eigen::Isometry)).translation().norm() > links_mm;
}

}  // namespace

Program Program::plan(const Script& script, const ArmKinematics& arm, const SE3& T_base_flange_start,
                      const SE3& T_flange_tcp_start, const Payload& payload_start,
                      std::uint32_t outputs_start, const std::array<double, 2>& analog_start) {
  Program program(arm);
  program.name_ = script.name;
  program.threads_ = script.threads;
  SE3 T_base_flange = T_base_flange_start;
  SE3 T_flange_tcp = T_flange_tcp_start;
  Payload payload = payload_start;
  std::uint32_t outputs = outputs_start;
  std::array<double, 2> analog_ratio = analog_start;
  double time_s = 0;
  const auto append = [&](double duration_s, std::variant<Hold, TimedPath, JointMove> motion) {
    program.pieces_.push_back({.begin_s = time_s,
                               .end_s = time_s + duration_s,
                               .T_flange_tcp = T_flange_tcp,
                               .payload = payload,
                               .outputs = outputs,
                               .analog_ratio = analog_ratio,
                               .motion = std::move(motion)});
    time_s += duration_s;
    T_base_flange = program.flange_of(program.pieces_.back(), time_s);
  };
  append(0, Hold{T_base_flange});

  std::vector<StraightMove> pending;  ///< straight moves not yet made a path
  const auto flush = [&] {
    if (pending.empty()) return;
    TimedPath path(T_base_flange * T_flange_tcp, pending);
    pending.clear();
    const double duration_s = path.duration_s();
    append(duration_s, std::move(path));
  };
  std::optional<JointVector> q_rad = script.start_rad;
  for (const ScriptStep& step : script.steps) {
    const auto* move = std::get_if<MoveStep>(&step);
    if (move != nullptr && move->T_base_tcp && beyond(*move->T_base_tcp, T_flange_tcp, arm)) {
      flush();
      const bool joint = move->kind == MoveStep::Kind::Joint;
      program.events_.push_back(
          {.time_s = time_s,
           .step = joint ? ScriptStep{FaultStep{"RuntimeExceptionMessage: no joints reach the goal of movej"}}
                         : ScriptStep{ProtectiveStopStep{.out_of_reach = true}}});
      return program;
    }
    if (move != nullptr && move->kind != MoveStep::Kind::Joint) {
      const SE3 goal = move->T_base_tcp ? *move->T_base_tcp : arm.T_base_flange(*move->q_rad) * T_flange_tcp;
      pending.push_back({.T_base_tcp = goal,
                         .speed_mm_s = move->speed,
                         .acceleration_mm_s2 = move->acceleration,
                         .blend_mm = move->blend_mm});
      continue;
    }
    flush();
    if (move != nullptr) {
      std::optional<JointVector> to_rad = move->q_rad;
      // An arm does not change its posture between two programs: the goal's is only a guess for one whose
      // joints nobody knows.
      auto from_rad = q_rad ? arm.joints_near(T_base_flange, *q_rad) : std::nullopt;
      const bool known = from_rad.has_value();
      if (!from_rad && to_rad) from_rad = arm.joints_near(T_base_flange, *to_rad);
      if (!from_rad) from_rad = arm.joints_anywhere(T_base_flange);
      if (!to_rad && from_rad)
        to_rad = arm.joints_near(*move->T_base_tcp * T_flange_tcp.inverse(Eigen::Isometry), *from_rad);
      if (from_rad && to_rad) from_rad = nearest_turns(*from_rad, known ? *q_rad : *to_rad);
      if (to_rad) q_rad = to_rad;
      if (from_rad && to_rad) {
        const double way_rad = (*to_rad - *from_rad).cwiseAbs().maxCoeff();
        append(Trapezoid{way_rad, move->speed, move->acceleration}.duration_s(),
               JointMove{*from_rad, *to_rad, move->speed, move->acceleration});
      } else {
        // The scan's head reaches farther round the shoe than the simulated arm's links do: from there it
        // goes straight.
        const SE3 T_base_tcp =
            move->T_base_tcp ? *move->T_base_tcp : arm.T_base_flange(*move->q_rad) * T_flange_tcp;
        pending.push_back({.T_base_tcp = T_base_tcp});
        flush();
      }
    } else if (const auto* tcp = std::get_if<SetTcpStep>(&step)) {
      T_flange_tcp = tcp->T_flange_tcp;
      append(0, Hold{T_base_flange});
    } else if (const auto* carried = std::get_if<Payload>(&step)) {
      payload = *carried;
      append(0, Hold{T_base_flange});
    } else if (const auto* pause = std::get_if<SleepStep>(&step)) {
      append(pause->time_s, Hold{T_base_flange});
    } else if (const auto* output = std::get_if<DigitalOutStep>(&step)) {
      const std::uint32_t bit = 1U << static_cast<unsigned>(output->number);
      outputs = output->active ? outputs | bit : outputs & ~bit;
      append(0, Hold{T_base_flange});
      program.events_.push_back({.time_s = time_s, .step = step});
    } else if (const auto* analog = std::get_if<AnalogOutStep>(&step)) {
      analog_ratio[static_cast<std::size_t>(analog->number)] = analog->ratio;
      append(0, Hold{T_base_flange});
      program.events_.push_back({.time_s = time_s, .step = step});
    } else {
      program.events_.push_back({.time_s = time_s, .step = step});
      if (std::holds_alternative<ProtectiveStopStep>(step)) return program;
    }
  }
  flush();
  return program;
}

bool Program::sets_between(const OutputStep& same, double after_s, double until_s) const {
  const auto sets_it = [&](const ScriptStep& step) {
    return std::visit(
        [&](const auto& output) {
          const auto* set = std::get_if<std::decay_t<decltype(output)>>(&step);
          return set != nullptr && set->number == output.number;
        },
        same);
  };
  return std::ranges::any_of(events_, [&](const ProgramEvent& event) {
    return event.time_s > after_s && event.time_s <= until_s && sets_it(event.step);
  });
}

const ScriptCode* Program::thread(std::string_view name) const {
  const auto known = std::ranges::find(threads_, name, &ScriptCode::name);
  return known == threads_.end() ? nullptr : &*known;
}

const Program::Piece& Program::piece_at(double time_s) const {
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), time_s,
                                      [](double t, const Piece& piece) { return t < piece.begin_s; });
  return after == pieces_.begin() ? pieces_.front() : *(after - 1);
}

double Program::later_s(double time_s, double elapsed_s, double speed_ratio) const {
  if (speed_ratio == 1) return time_s + elapsed_s;
  while (elapsed_s > 0 && time_s < duration_s()) {
    const Piece& piece = piece_at(time_s);
    const double ratio = std::holds_alternative<Hold>(piece.motion) ? 1 : speed_ratio;
    const double left_s = piece.end_s - time_s;
    if (ratio * elapsed_s < left_s) return time_s + ratio * elapsed_s;
    time_s = piece.end_s;
    elapsed_s -= left_s / ratio;
  }
  return time_s + std::max(elapsed_s, 0.0);
}

SE3 Program::flange_of(const Piece& piece, double time_s) const {
  const double inside_s = time_s - piece.begin_s;
  if (const auto* hold = std::get_if<Hold>(&piece.motion)) return hold->T_base_flange;
  if (const auto* path = std::get_if<TimedPath>(&piece.motion)) {
    return path->T_base_tcp_at(inside_s) * piece.T_flange_tcp.inverse(Eigen::Isometry);
  }
  return arm_.T_base_flange(std::get<JointMove>(piece.motion).q_rad_at(inside_s));
}

JointVector Program::JointMove::q_rad_at(double inside_s) const {
  const JointVector change_rad = to_rad - from_rad;
  const double way_rad = change_rad.cwiseAbs().maxCoeff();
  const double part =
      way_rad > 0 ? Trapezoid{way_rad, speed_rad_s, acceleration_rad_s2}.at(inside_s) / way_rad : 1;
  return from_rad + part * change_rad;
}

std::optional<JointVector> Program::q_rad_at(double time_s) const {
  const Piece& piece = piece_at(time_s);
  const auto* move = std::get_if<JointMove>(&piece.motion);
  if (move == nullptr) return std::nullopt;
  return move->q_rad_at(std::min(time_s, duration_s()) - piece.begin_s);
}

SE3 Program::T_base_flange_at(double time_s) const {
  return flange_of(piece_at(time_s), std::min(time_s, duration_s()));
}
SE3 Program::T_flange_tcp_at(double time_s) const {
  return piece_at(time_s).T_flange_tcp;
}
const Payload& Program::payload_at(double time_s) const {
  return piece_at(time_s).payload;
}
std::uint32_t Program::outputs_at(double time_s) const {
  return piece_at(time_s).outputs;
}
std::array<double, 2> Program::analog_at(double time_s) const {
  return piece_at(time_s).analog_ratio;
}

}  // namespace biteline::sim
