// SPDX-License-Identifier: MIT
#include "hal/sim/robot/arm.hpp"

#include <algorithm>
#include <utility>

namespace biteline::sim {

namespace {

double seconds(Nanoseconds time) {
  return static_cast<double>(time.count()) * 1e-9;
}

std::uint32_t with_output(std::uint32_t bits, int number, bool on) {
  const std::uint32_t bit = 1U << static_cast<unsigned>(number);
  return on ? bits | bit : bits & ~bit;
}

void put(const OutputStep& output, std::uint32_t& digital, std::array<double, 2>& analog_ratio) {
  if (const auto* set = std::get_if<DigitalOutStep>(&output)) {
    digital = with_output(digital, set->number, set->active);
  } else {
    const auto& share = std::get<AnalogOutStep>(output);
    analog_ratio[static_cast<std::size_t>(share.number)] = share.ratio;
  }
}

bool is_same(const OutputStep& a, const OutputStep& b) {
  const auto number = [](const OutputStep& one) {
    return std::visit([](const auto& output) { return output.number; }, one);
  };
  return a.index() == b.index() && number(a) == number(b);
}

}  // namespace

Arm::Arm(const ArmKinematics& kinematics, const SE3& T_base_flange_start, const ArmDynamics& dynamics)
    : kinematics_(kinematics),
      T_base_flange_still_(T_base_flange_start),
      ideal_(dynamics.ideal()),
      real_(dynamics) {}

Arm::Arm(const ArmKinematics& kinematics, const JointVector& q_start_rad, const ArmDynamics& dynamics)
    : Arm(kinematics, kinematics.T_base_flange(q_start_rad), dynamics) {
  q_still_rad_ = q_start_rad;
}

ArmState Arm::at(SensorClock::time_point instant) const {
  const std::lock_guard lock(mutex_);
  ArmState state{.T_base_flange = T_base_flange_still_,
                 .T_flange_tcp = T_flange_tcp_,
                 .q_rad = q_still_rad_,
                 .outputs = outputs_,
                 .analog_ratio = analog_ratio_,
                 .payload = payload_};
  const double time_s = seconds(instant - begin_);
  if (motion_) {
    state.moving = time_s >= 0 && time_s < motion_->duration_s;
    const double inside_s = std::clamp(time_s, 0.0, motion_->duration_s);
    state.program_name = motion_->name;
    if (motion_->q_rad_at) {
      state.q_rad = motion_->q_rad_at(inside_s);
      state.T_base_flange = kinematics_.T_base_flange(*state.q_rad);
    } else {
      state.T_base_flange = motion_->T_base_flange_at(inside_s);
      state.q_rad = time_s >= motion_->duration_s ? motion_->q_end_rad : std::nullopt;
    }
  } else if (program_) {
    const double program_s = std::max(0.0, program_time_s(instant));
    state.moving = state.program_running = time_s >= 0 && program_s < program_->duration_s();
    state.paused = state.program_running && paused_;
    state.T_base_flange = program_->T_base_flange_at(program_s);
    state.T_flange_tcp = program_->T_flange_tcp_at(program_s);
    state.outputs = program_->outputs_at(program_s);
    state.analog_ratio = program_->analog_at(program_s);
    for (const SetBeside& set : beside_) {
      if (!program_->sets_between(set.output, set.time_s, program_s))
        put(set.output, state.outputs, state.analog_ratio);
    }
    state.q_rad = program_->q_rad_at(program_s);
    if (const Vec3 off_mm = off_at(instant); !off_mm.isZero()) {
      state.T_base_flange.translation() += off_mm;
      state.q_rad.reset();
    }
    state.payload = program_->payload_at(program_s);
    state.program_name = program_->name();
  }
  return state;
}

void Arm::set_off(const Vec3& off_base_mm, SensorClock::time_point instant) {
  // Pictures are asked for after their time, by less than that.
  constexpr std::size_t k_kept = 4096;
  const std::lock_guard lock(mutex_);
  if (offs_.empty() && off_base_mm.isZero()) return;
  if (offs_.size() >= 2 * k_kept) offs_.erase(offs_.begin(), offs_.end() - k_kept);
  offs_.push_back({.since = instant, .off_base_mm = off_base_mm});
}

Vec3 Arm::off_at(SensorClock::time_point instant) const {
  const auto after = std::ranges::upper_bound(offs_, instant, {}, &Off::since);
  return after == offs_.begin() ? Vec3{Vec3::Zero()} : (after - 1)->off_base_mm;
}

double Arm::program_time_s(SensorClock::time_point instant) const {
  const auto after = std::ranges::upper_bound(paces_, instant, {}, &Pace::since);
  if (after == paces_.begin()) return seconds(instant - begin_);
  const Pace& pace = *(after - 1);
  if (pace.paused) return pace.program_s;
  return program_->later_s(pace.program_s, seconds(instant - pace.since), pace.ratio);
}

void Arm::set_speed(double ratio, SensorClock::time_point instant) {
  const std::lock_guard lock(mutex_);
  if (ratio != std::exchange(speed_ratio_, ratio)) change_pace(instant);
}

void Arm::set_paused(bool on, SensorClock::time_point instant) {
  const std::lock_guard lock(mutex_);
  if (on != std::exchange(paused_, on)) change_pace(instant);
}

void Arm::change_pace(SensorClock::time_point instant) {
  if (!program_) return;
  // A cycle that comes late is before the program that was begun meanwhile.
  const SensorClock::time_point since = std::max(instant, paces_.back().since);
  paces_.push_back(
      {.since = since, .program_s = program_time_s(since), .ratio = speed_ratio_, .paused = paused_});
}

std::optional<JointVector> Arm::joints_of(const ArmState& state, const JointVector& near_rad) const {
  if (state.q_rad) return state.q_rad;
  if (near_rad.isZero(0)) return kinematics_.joints_anywhere(state.T_base_flange);
  if (kinematics_.T_base_flange(near_rad).isApprox(state.T_base_flange, 1e-12)) return near_rad;
  return kinematics_.joints_near(state.T_base_flange, near_rad);
}

ArmReal Arm::real_at(SensorClock::time_point instant) const {
  const ArmState wanted = at(instant);
  const ArmReal exact{.T_base_flange = wanted.T_base_flange,
                      .T_base_flange_told = wanted.T_base_flange,
                      .q_told_rad = wanted.q_rad};
  if (ideal_) return exact;
  const std::lock_guard lock(real_mutex_);
  const auto joints = real_.at(instant, [this](SensorClock::time_point when, const JointVector& near_rad) {
    return joints_of(at(when), near_rad);
  });
  if (!joints) return exact;
  return {.T_base_flange = kinematics_.T_base_flange(joints->q_link_rad),
          .T_base_flange_told = kinematics_.T_base_flange(joints->q_told_rad),
          .q_told_rad = joints->q_told_rad};
}

void Arm::stand(SensorClock::time_point instant) {
  const ArmState now = at(instant);
  const std::lock_guard lock(mutex_);
  T_base_flange_still_ = now.T_base_flange;
  q_still_rad_ = now.q_rad;
  T_flange_tcp_ = now.T_flange_tcp;
  outputs_ = now.outputs;
  analog_ratio_ = now.analog_ratio;
  payload_ = now.payload;
  motion_.reset();
  program_.reset();
  beside_.clear();
  paces_.clear();
  offs_.clear();
  paused_ = false;
  begin_ = instant;
}

void Arm::set_output(const OutputStep& output, SensorClock::time_point instant) {
  const std::lock_guard lock(mutex_);
  if (!program_) {
    put(output, outputs_, analog_ratio_);
  } else {
    std::erase_if(beside_, [&](const SetBeside& set) { return is_same(set.output, output); });
    beside_.push_back({.output = output, .time_s = program_time_s(instant)});
  }
}

Arm::Running Arm::running(SensorClock::time_point instant) const {
  const std::lock_guard lock(mutex_);
  if (!program_) return {};
  const double time_s = program_time_s(instant);
  return {.program = program_,
          .begin = begin_,
          .time_s = time_s,
          .paused = paused_,
          .ended = time_s >= program_->duration_s()};
}

void Arm::stop(SensorClock::time_point instant) {
  stand(instant);
}

void Arm::run(FlangeMotion motion, SensorClock::time_point begin) {
  stand(begin);
  const std::lock_guard lock(mutex_);
  motion_ = std::make_shared<const FlangeMotion>(std::move(motion));
}

void Arm::run(const Script& script, SensorClock::time_point begin) {
  stand(begin);
  const ArmState now = at(begin);
  auto program = std::make_shared<const Program>(Program::plan(
      script, kinematics_, now.T_base_flange, now.T_flange_tcp, now.payload, now.outputs, now.analog_ratio));
  const std::lock_guard lock(mutex_);
  program_ = std::move(program);
  paces_.assign(1, {.since = begin, .program_s = 0, .ratio = speed_ratio_, .paused = paused_});
}

}  // namespace biteline::sim
