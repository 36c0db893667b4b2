// SPDX-License-Identifier: MIT
#include "host/robot/link/ending.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

namespace biteline::robot {
namespace {

constexpr Nanoseconds k_look{20'000'000};
// One state may be wrong; so long all of them must say the same.
constexpr double k_sure_s = 0.1;
constexpr int k_tries = 2;

HostClock::time_point now() {
  return HostClock::time_point{
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}

double seconds(Nanoseconds duration) {
  return static_cast<double>(duration.count()) * 1e-9;
}

/// What all states have said for long enough, by both clocks.
class Sure {
 public:
  void take(bool holds, const RobotState& state) {
    if (!holds)
      since_.reset();
    else if (!since_)
      since_ = state;
    if (since_ && between_s(*since_, state) >= k_sure_s) sure_ = true;
  }
  void begin_anew() { since_.reset(); }
  [[nodiscard]] const std::optional<RobotState>& since() const { return since_; }
  [[nodiscard]] bool sure() const { return sure_; }

 private:
  std::optional<RobotState> since_;
  bool sure_{false};
};

bool stands(const RobotState& since, const RobotState& state, const EndingOptions& options) {
  return (state.q_rad - since.q_rad).cwiseAbs().maxCoeff() <= options.turn_rad &&
         (state.T_base_tcp.translation() - since.T_base_tcp.translation()).norm() <= options.move_mm;
}

/// From now on, until both are sure or their time is over.  `impatient`: ends where the tool is late.
void look(const RobotLink& link, const EndingOptions& options, bool impatient, Ending& ending) {
  const HostClock::time_point begin = now();
  Sure rest, off;
  std::optional<RobotState> last;
  std::uint64_t sequence = 0;
  // The newest state may be of before the stop.
  if (const Result<RobotState> old = link.wait_newer(0, Nanoseconds{0})) sequence = old->sequence;
  if (options.digital_output < 0)
    ending.tool = ToolOutput::None;
  else
    ending.tool = ToolOutput::NotSeen;
  while (!(rest.sure() && (off.sure() || options.digital_output < 0))) {
    const double waited_s = seconds(now() - begin);
    if (waited_s > options.rest_patience_s) break;
    const bool tool_late = options.digital_output >= 0 && !off.sure() && waited_s > options.output_patience_s;
    if (tool_late && (impatient || rest.sure())) break;
    const Result<RobotState> state = link.wait_newer(sequence, k_look);
    if (!state) continue;
    sequence = state->sequence;
    // The same instant again, or an older one, says nothing about now.
    if (last && state->sampled <= last->sampled) continue;
    last = *state;
    const bool over = !state->program_running || !state->powered;
    if (rest.since() && !stands(*rest.since(), *state, options)) rest.begin_anew();
    rest.take(over, *state);
    if (options.digital_output < 0) continue;
    off.take(!state->output_on(options.digital_output), *state);
    ending.tool = off.sure() ? ToolOutput::Off : ToolOutput::On;
  }
  ending.at_rest = rest.sure();
}

void stop_until_seen(RobotLink& link, const EndingOptions& options, Ending& ending) {
  for (int tries = 1; tries <= k_tries && !ending.seen(); ++tries) {
    // Whether the words left does not matter: the states tell what became of them.
    static_cast<void>(link.stop());
    ++ending.stops;
    look(link, options, tries < k_tries, ending);
  }
}

}  // namespace

double between_s(const RobotState& begin, const RobotState& end) {
  return std::min(seconds(end.sampled - begin.sampled), seconds(end.received - begin.received));
}

const char* name_of(ToolOutput tool) {
  switch (tool) {
    case ToolOutput::None:
      return "none";
    case ToolOutput::Off:
      return "off";
    case ToolOutput::On:
      return "on";
    case ToolOutput::NotSeen:
      return "not_seen";
  }
  return "";
}

Ending end_run(RobotLink& link, const EndingOptions& options) {
  Ending ending;
  look(link, options, true, ending);
  if (!ending.seen()) stop_until_seen(link, options, ending);
  return ending;
}

Ending stop_run(RobotLink& link, const EndingOptions& options) {
  Ending ending;
  if (options.dead_man_s > 0) {
    EndingOptions alone = options;
    alone.rest_patience_s = alone.output_patience_s = options.dead_man_s;
    look(link, alone, true, ending);
    // The word all the same: what was seen was seen of a controller that somebody has taken.
    if (ending.seen()) {
      static_cast<void>(link.stop());
      ++ending.stops;
    }
  }
  stop_until_seen(link, options, ending);
  return ending;
}

std::string alarm_of(const Ending& ending) {
  std::vector<const char*> alarms;
  if (ending.tool == ToolOutput::On) alarms.push_back("THE TOOL IS STILL ON: SWITCH IT OFF AT ITS SUPPLY");
  if (ending.tool == ToolOutput::NotSeen) alarms.push_back("THE TOOL IS NOT SEEN OFF: LOOK AT IT");
  if (!ending.at_rest) alarms.push_back("THE ARM DOES NOT CONFIRM THE STOP: PRESS ITS EMERGENCY STOP");
  std::string text;
  for (const char* alarm : alarms) text += (text.empty() ? "" : "; ") + std::string{alarm};
  return text;
}

}  // namespace biteline::robot
