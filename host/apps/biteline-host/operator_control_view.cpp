// SPDX-License-Identifier: MIT
// What doors see: lamps with words, the robot and the sensor.
#include <algorithm>
#include <array>
#include <utility>

#include "host/apps/biteline-host/operator_control.hpp"
#include "host/interfaces/control/upkeep.hpp"
#include "host/robot/link/gate/refused.hpp"

namespace biteline::service {
namespace {

using api::Json;

const char* phase_of(CellState state, bool on_demand) {
  switch (state) {
    case CellState::Starting:
      return "starting";
    case CellState::NoSensor:
    case CellState::NotReady:
      return "fault";
    case CellState::Resting:
      // A fault would take no start.
      return on_demand ? "waiting" : "fault";
    case CellState::Idle:
    case CellState::WaitsForStart:
      return "waiting";
    case CellState::Stopped:
      return "stopped";
    case CellState::Scanning:
      return "scanning";
    case CellState::Working:
      return "working";
    case CellState::Held:
      return "deciding";
    case CellState::Following:
      return "following";
  }
  return "fault";
}

/// `code` is what a page has words for, `detail` what only its source can tell (a name, a reason).
Json lamp(const char* level, const char* code, const std::string& words, const std::string& detail = {}) {
  return {{"level", level}, {"words", words}, {"code", code}, {"detail", detail}};
}

/// The next step as a code, of the cell's state alone.
const char* next_code(CellState state, const CellMachine& cell, Waits waits, bool asks, bool has_arm) {
  switch (state) {
    case CellState::Starting:
    case CellState::NoSensor:
      return "sensor_called";
    case CellState::NotReady:
      return "robot_ready";
    case CellState::Resting:
      return "remove_cause";
    case CellState::Idle:
      return "next_scan";
    case CellState::WaitsForStart:
      return asks ? "look_then_start" : "start";
    case CellState::Stopped:
      return "start_when_clear";
    case CellState::Scanning:
      if (cell.shoe() == Shoe::Looking) return "person_decides";
      return cell.shoe() == Shoe::Inspecting ? "work_judged" : "its_line";
    case CellState::Working:
      if (cell.goes_on()) return "person_decides";
      return has_arm ? "its_path" : "next_scan";
    case CellState::Held:
      if (waits == Waits::ForModel) return "choose_model";
      return waits == Waits::ForPath ? "mend_or_reject" : "accept_or_reject";
    case CellState::Following:
      return cell.shoe() == Shoe::InAir ? "person_decides" : "what_follows";
  }
  return "remove_cause";
}

Json clock_json(const wire::ClockState& clock) {
  return {{"name", clock.name},
          {"known", clock.known},
          {"offset_ns", clock.offset.count()},
          {"uncertainty_ns", clock.uncertainty.count()},
          {"drift_ppm", clock.drift_ppm},
          {"steps", clock.steps}};
}

Json laser_lamp(const wire::Health& health) {
  switch (health.laser) {
    case wire::LaserState::Off:
      return lamp("off", "laser_off", health.laser_reason.empty() ? "off" : "off: " + health.laser_reason,
                  health.laser_reason);
    case wire::LaserState::On:
      return lamp("ok", "laser_on", "on");
    case wire::LaserState::Fault:
      return lamp("fault", "laser_fault", "off by a fault: " + health.laser_reason, health.laser_reason);
  }
  return lamp("unknown", "not_told", "not known");
}

Json clock_lamp(const wire::Devices& devices) {
  if (devices.clocks.empty()) return lamp("ok", "one_clock", "one clock");
  std::string unknown;
  for (const wire::ClockState& clock : devices.clocks) {
    if (!clock.known) unknown += (unknown.empty() ? "" : ", ") + clock.name;
  }
  if (!unknown.empty()) return lamp("warning", "clock_unknown", "not known yet: " + unknown, unknown);
  const std::string count = std::to_string(devices.clocks.size());
  return lamp("ok", "clocks_known", count + " known", count);
}

}  // namespace

Json OperatorControl::held_json_locked() const {
  if (cell_.shoe() != Shoe::Held) return nullptr;
  constexpr std::array k_waits{"word", "path", "model"};
  Json held{{"scan", shoe_scan_},
            {"waits_for", k_waits.at(static_cast<std::size_t>(waits_))},
            {"fresh_s", nullptr}};
  if (fresh_until_)
    held["fresh_s"] = std::max(0.0, std::chrono::duration<double>(*fresh_until_ - Clock::now()).count());
  const std::optional<report::ToldRefusal> why = not_sendable_locked();
  held["version"] = api::or_null(version_);
  held["tool"] = api::or_null(held_tool_);
  held["sendable"] = !why;
  held["reason_code"] = why ? api::or_null(why->reason_code) : Json{};
  held["reason"] = why ? Json(why->reason) : Json{};
  held["next_step"] = why ? Json(why->next_step) : Json{};
  return held;
}

void OperatorControl::show_stopped_locked(Json& state) const {
  std::string words = "stopped by " + stopped_by_;
  // An arm that comes to rest is told as it is.
  if (cell_.arm_moves()) {
    state["now"] = words + "; " + now_;
    return;
  }
  if (!ended_.empty()) words += "; " + ended_ + " waits no longer";
  state["now"] = words;
  state["next"] = "start, when the cell is clear";
}

std::optional<report::ToldRefusal> OperatorControl::not_sendable_locked() const {
  if (waits_ == Waits::ForModel)
    return report::ToldRefusal{.reason_code = "model_unknown",
                               .reason = "the model of " + shoe_scan_ + " is not known",
                               .next_step = "choose one, or reject it"};
  if (waits_ == Waits::ForPath)
    return report::ToldRefusal{.reason_code = {},
                               .reason = shoe_scan_ + " has no checked path",
                               .next_step = "mend its line, choose another process, or reject it"};
  if (not_sendable_) return not_sendable_;
  if (!fresh_until_ || Clock::now() < *fresh_until_) return std::nullopt;
  const auto& row = report::refusal_row(robot::Refused::ScanTooOld);
  return report::ToldRefusal{
      .reason_code = row.name,
      .reason = shoe_scan_ + " is too old to be sent: somebody may have moved the shoe",
      .next_step = row.next_step};
}

Json OperatorControl::state_locked() const {
  const bool connected = sensor_lost_.empty();
  Json lamps;
  if (!connected || !health_) {
    const Json away = connected ? lamp("unknown", "not_told", "not told yet")
                                : lamp("unknown", "no_sensor", "sensor: " + sensor_lost_, sensor_lost_);
    for (const char* name : {"laser", "camera", "poses", "clock"}) lamps[name] = away;
  } else {
    const wire::Devices& devices = health_->devices;
    lamps["laser"] = laser_lamp(*health_);
    lamps["camera"] = devices.camera_connected ? lamp("ok", "camera_connected", "connected")
                                               : lamp("warning", "camera_not_open", "not open");
    lamps["poses"] = devices.poses_flow ? lamp("ok", "poses_flow", "come in")
                                        : lamp("warning", "poses_none", "none come in");
    lamps["clock"] = clock_lamp(devices);
  }
  if (config_.arm.empty()) {
    lamps["robot"] = lamp("off", "no_robot", "none: lines are found, no path is planned");
  } else if (!robot_asked_) {
    lamps["robot"] = lamp("unknown", "robot_not_asked", "not asked yet");
  } else {
    lamps["robot"] = robot_wrong_.empty() ? lamp("ok", "robot_ready", "ready")
                                          : lamp("fault", "robot_wrong", robot_wrong_, robot_wrong_);
  }
  if (work_)
    lamps["work"] = lamp(work_->asks ? "warning" : "ok", work_->asks ? "work_asks" : "work_done",
                         work_->words, work_->words);
  if (centre_)
    lamps["centre"] = centre_->empty() ? lamp("ok", "centre_reads", "reads every shoe")
                                       : lamp("warning", "centre_wrong", *centre_, *centre_);
  const bool simulated = hello_ && hello_->simulated;
  const CellState told = cell_.state(hindrance_);
  Json state{{"version", BITELINE_VERSION},
             {"simulated", simulated},
             {"phase", phase_of(told, cycle_.on_demand())},
             {"now", now_},
             {"next", next_},
             {"next_code", next_code(told, cell_, waits_, work_ && work_->asks, !config_.arm.empty())},
             {"scan", api::or_null(scan_)},
             {"progress", api::or_null(progress_)},
             {"lamps", std::move(lamps)},
             {"cycle", {{"this_s", api::or_null(cycle_s_locked())}, {"last_s", api::or_null(last_cycle_s_)}}},
             {"model", nullptr},
             {"part", api::or_null(shoe_.part)},
             {"foot", api::or_null(shoe_.foot)},
             {"size", api::or_null(shoe_.size)},
             {"process", api::or_null(process_.name)},
             {"process_by", api::or_null(process_.by)}};
  state["held"] = held_json_locked();
  state["offers"] = offers_locked();
  state["day"] = {{"zone", memory::time_zone()}, {"begin", config_.day.begin()}};
  if (cell_.going() == Going::Stopped) show_stopped_locked(state);
  if (!model_.empty()) state["model"] = {{"name", model_}, {"probability", model_probability_}};
  return state;
}

Json OperatorControl::state() {
  const std::lock_guard lock{mutex_};
  return state_locked();
}

Json OperatorControl::robots() {
  const std::lock_guard lock{mutex_};
  if (config_.arm.empty()) return Json::array();
  Json robot{{"name", config_.arm},
             {"address", config_.controller},
             {"serial", nullptr},
             {"connected", robot_.has_value()},
             {"powered", nullptr},
             {"remote", nullptr},
             {"ready", robot_asked_ && robot_wrong_.empty()},
             {"words", robot_asked_ ? robot_wrong_ : "not asked yet"}};
  if (robot_) {
    if (robot_->serial) robot["serial"] = *robot_->serial;
    if (robot_->remote) robot["remote"] = *robot_->remote;
    if (robot_->robot_mode)
      robot["powered"] = *robot_->robot_mode == "RUNNING" || *robot_->robot_mode == "IDLE";
  }
  return Json::array({std::move(robot)});
}

Json OperatorControl::sensors() {
  const std::lock_guard lock{mutex_};
  const bool connected = sensor_lost_.empty() && hello_;
  Json sensor{
      {"name", hello_ ? hello_->name : "sensor"}, {"address", config_.sensor}, {"connected", connected}};
  if (hello_) {
    sensor["version"] = hello_->version;
    sensor["simulated"] = hello_->simulated;
  }
  if (!connected) {
    sensor["fault"] = sensor_lost_;
    sensor["next_step"] = "check the sensor's power and network";
    return Json::array({std::move(sensor)});
  }
  if (!health_) return Json::array({std::move(sensor)});
  const wire::Health& health = *health_;
  constexpr std::array k_lasers{"off", "on", "fault"};
  sensor["scanning"] = health.scanning;
  sensor["laser"] = k_lasers.at(static_cast<std::size_t>(health.laser));
  sensor["laser_reason"] = health.laser_reason;
  sensor["camera_connected"] = health.devices.camera_connected;
  sensor["poses_flow"] = health.devices.poses_flow;
  sensor["realtime"] = health.devices.realtime;
  sensor["temperature_degc"] =
      health.devices.temperature_degc ? Json(*health.devices.temperature_degc) : Json{};
  const wire::Counters& counters = health.counters;
  for (const auto& [name, count] :
       {std::pair{"frames", counters.frames}, std::pair{"frames_lost", counters.frames_lost},
        std::pair{"frames_damaged", counters.frames_damaged}, std::pair{"profiles", counters.profiles},
        std::pair{"profiles_dropped", counters.profiles_dropped},
        std::pair{"messages_lost", counters.messages_lost}, std::pair{"poses_lost", counters.poses_lost},
        std::pair{"overruns", counters.overruns}}) {
    sensor[name] = count;
  }
  sensor["clocks"] = Json::array();
  for (const wire::ClockState& clock : health.devices.clocks) sensor["clocks"].push_back(clock_json(clock));
  sensor["upkeep"] = health.upkeep ? control::to_json(*health.upkeep) : Json{};
  const bool fault = health.laser == wire::LaserState::Fault;
  sensor["fault"] = fault ? Json(health.laser_reason) : Json{};
  sensor["next_step"] = fault ? Json("remove the cause, then start again") : Json{};
  return Json::array({std::move(sensor)});
}

}  // namespace biteline::service
