// SPDX-License-Identifier: MIT
#include "hal/sim/robot/script_runner.hpp"

#include <utility>

#include "hal/sim/robot/blends.hpp"
#include "hal/sim/robot/script_rows.hpp"

namespace biteline::sim {
namespace {

/// What a program may do without time going on before it is a loop for ever.
constexpr int k_most_in_a_cycle = 10'000;

}  // namespace

void ScriptRunner::run(ProgramText program, const std::optional<JointVector>& q_rad,
                       SensorClock::time_point instant) {
  if (auto* plain = std::get_if<Script>(&program)) {
    if (plain->secondary) return run_secondary(*plain, instant);
    end_code();
    run_plain(std::move(*plain), q_rad, instant);
    return;
  }
  stop(instant);
  code_ = std::move(std::get<ScriptCode>(program));
  news_.push_back({.kind = ProgramNews::Kind::Started, .text = code_->name});
}

void ScriptRunner::run_plain(Script script, const std::optional<JointVector>& q_rad,
                             SensorClock::time_point instant) {
  for (std::string& warning : skip_overlapping_blends(script))
    news_.push_back({.kind = ProgramNews::Kind::Warning, .text = std::move(warning)});
  script.start_rad = q_rad;
  paused_ = false;
  arm_.run(script, instant);
}

void ScriptRunner::run_secondary(const Script& script, SensorClock::time_point instant) {
  for (const ScriptStep& step : script.steps) {
    if (const auto* digital = std::get_if<DigitalOutStep>(&step)) {
      arm_.set_output(*digital, instant);
    } else if (const auto* analog = std::get_if<AnalogOutStep>(&step)) {
      arm_.set_output(*analog, instant);
    } else if (const auto* text = std::get_if<TextStep>(&step)) {
      news_.push_back({.kind = ProgramNews::Kind::Text, .text = text->text});
    } else {
      news_.push_back({.kind = ProgramNews::Kind::Fault, .text = "a secondary program takes time or moves"});
      return;
    }
  }
}

void ScriptRunner::stop(SensorClock::time_point instant) {
  arm_.stop(instant);
  end_code();
}

void ScriptRunner::set_paused(bool on, SensorClock::time_point instant) {
  paused_ = on;
  arm_.set_paused(on, instant);
}

void ScriptRunner::end_code() {
  if (!code_) return;
  news_.push_back({.kind = ProgramNews::Kind::Ended, .text = code_->name});
  code_.reset();
  rows_.reset();
  variables_.clear();
  at_ = 0;
  paused_ = false;
}

void ScriptRunner::take(const ProgramNews& news) {
  using Kind = ProgramNews::Kind;
  const bool of_rows = (news.kind == Kind::Started || news.kind == Kind::Ended) && news.text.empty();
  if (!of_rows) news_.push_back(news);
  if (news.kind == Kind::ProtectiveStop || news.kind == Kind::OutOfReach || news.kind == Kind::Fault)
    end_code();
}

std::string ScriptRunner::step(SensorClock::time_point instant, const RtdeInputs& inputs,
                               const std::optional<JointVector>& q_rad) {
  std::string cut = watch_.step(instant, inputs);
  for (const ProgramNews& news : watch_.take_news()) take(news);
  if (!code_ || paused_) return cut;
  const Arm::Running running = arm_.running(instant);
  // Stopped, or another one's: its rest is nobody's.
  if (rows_ && running.program != rows_) {
    end_code();
    return cut;
  }
  if (running.program && !running.ended) return cut;
  if (const Result<void> done = advance(instant, inputs, q_rad); !done) {
    news_.push_back({.kind = ProgramNews::Kind::Fault, .text = to_line(done.error())});
    end_code();
  }
  return cut;
}

Result<void> ScriptRunner::advance(SensorClock::time_point instant, const RtdeInputs& inputs,
                                   const std::optional<JointVector>& q_rad) {
  using Kind = Instruction::Kind;
  const ScriptWorld world = watch_.world_at(instant, inputs);
  for (int done = 0; done < k_most_in_a_cycle; ++done) {
    if (at_ >= code_->instructions.size()) {
      end_code();
      return {};
    }
    const Instruction& now = code_->instructions[at_];
    if (now.kind == Kind::Row) {
      BITELINE_ASSIGN(Script rows, next_rows(world));
      run_plain(std::move(rows), q_rad, instant);
      rows_ = arm_.running(instant).program;
      return {};
    }
    ++at_;
    if (now.kind == Kind::Sync) return {};
    if (now.kind == Kind::Jump) at_ = now.target;
    if (now.kind == Kind::Halt || now.kind == Kind::Return) at_ = code_->instructions.size();
    if (now.kind != Kind::Assign && now.kind != Kind::JumpUnless) continue;
    const std::optional<ScriptValue> value = value_of(now.value, {}, variables_, world);
    const auto* number = value ? std::get_if<double>(&*value) : nullptr;
    if (!value || (now.kind == Kind::JumpUnless && number == nullptr))
      return fail(Errc::BadValue, "script line %d: no value", now.line);
    if (now.kind == Kind::Assign) {
      variables_.insert_or_assign(now.name, *value);
    } else if (*number == 0) {
      at_ = now.target;
    }
  }
  return fail(Errc::BadValue, "program %s: a loop without sync() or sleep()", code_->name.c_str());
}

Result<Script> ScriptRunner::next_rows(const ScriptWorld& world) {
  const Literals no_literals;
  const Evaluate evaluate = [&](const Expression& expression) {
    return value_of(expression, {}, variables_, world);
  };
  Script script{.name = {}, .steps = {}};
  for (; at_ < code_->instructions.size() && code_->instructions[at_].kind == Instruction::Kind::Row; ++at_) {
    const Instruction& row = code_->instructions[at_];
    LineReader reader{row.name, row.line, no_literals, &evaluate};
    const std::string function = reader.word();
    if (!reader.take('(')) return reader.wrong("'('");
    BITELINE_ASSIGN(const auto arguments, reader.arguments());
    if (!reader.at_end()) return reader.wrong("the end of the line");
    BITELINE_ASSIGN(auto step, step_of(function, arguments, row.line));
    if (step) script.steps.push_back(std::move(*step));
  }
  return script;
}

}  // namespace biteline::sim
