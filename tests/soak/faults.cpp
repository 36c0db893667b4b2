// SPDX-License-Identifier: MIT
#include "tests/soak/faults.hpp"

#include <csignal>

#include "tests/support/stalled_thread.hpp"

namespace biteline::soak {
namespace {

using namespace std::chrono_literals;
using enum Outcome;
using sim::Line;
using When = Fault::When;
using Undo = Fault::Undo;

Undo undo_with(std::function<void()> repair) {
  return {nullptr, [repair = std::move(repair)](void*) { repair(); }};
}

auto line(Line which, bool during) {
  return [=](Stand& stand) {
    stand.cell().drive(which, during);
    return undo_with([&stand, which, during] { stand.cell().drive(which, !during); });
  };
}

auto flag(std::atomic<bool> sim::CellFaults::*member) {
  return [=](Stand& stand) {
    stand.cell().faults.*member = true;
    return undo_with([&stand, member] { stand.cell().faults.*member = false; });
  };
}

auto count(std::atomic<int> sim::CellFaults::*member, int number) {
  return [=](Stand& stand) {
    stand.cell().faults.*member = number;
    return undo_with([&stand, member] { stand.cell().faults.*member = 0; });
  };
}

auto stall(const char* thread) {
  return [=](Stand& stand) -> Undo {
    return std::make_shared<test::StalledThread>(stand.sensor().pid(), thread);
  };
}

auto lies(Lie lie) {
  return [=](Stand& stand) {
    stand.between().lie = lie;
    return undo_with([&stand] { stand.between().lie = Lie::None; });
  };
}

Undo kill_sensor(Stand& stand) {
  ::kill(stand.sensor().pid(), SIGKILL);
  return {};
}

Undo kill_host(Stand& stand) {
  ::kill(stand.host().pid(), SIGKILL);
  return {};
}

Undo end_host(Stand& stand) {
  ::kill(stand.host().pid(), SIGTERM);
  return {};
}

Undo hold_sensor(Stand& stand) {
  ::kill(stand.sensor().pid(), SIGSTOP);
  return undo_with([&stand] { ::kill(stand.sensor().pid(), SIGCONT); });
}

Undo kill_page(Stand& stand) {
  ::kill(stand.page().program().pid(), SIGKILL);
  return {};
}

Undo hold_page(Stand& stand) {
  ::kill(stand.page().program().pid(), SIGSTOP);
  return undo_with([&stand] { ::kill(stand.page().program().pid(), SIGCONT); });
}

Undo slow_browser(Stand& stand) {
  stand.page().stop_reading(true);
  return undo_with([&stand] { stand.page().stop_reading(false); });
}

Undo step_robot_clock(Stand& stand) {
  stand.cell().faults.robot_clock_step_ns += 2'000'000'000;
  return {};
}

Undo press_protective_stop(Stand& stand) {
  stand.cell().robot().set_protective_stop(true);
  return undo_with([&stand] { stand.cell().robot().set_protective_stop(false); });
}

Undo take_local_control(Stand& stand) {
  stand.cell().robot().set_remote_control(false);
  // A stop: it goes on when somebody says start.
  return undo_with([&stand] {
    stand.cell().robot().set_remote_control(true);
    stand.page().say_start();
  });
}

constexpr unsigned k_dark = any_of({Refused});
// Some poses or frames less: a line, or a reason.
constexpr unsigned k_less = any_of({Followed, Refused, NoPath, NotSent});
constexpr unsigned k_halted = any_of({Halted});

const Fault k_table[] = {
    {"none", When::Never, 0ms, false, any_of({Followed}), "", {}},
    // The sensor's table.
    {"door opened", When::Scan, 700ms, true, k_dark, "interlock", line(Line::Interlock, false)},
    {"key switched off", When::Scan, 700ms, true, k_dark, "", line(Line::Key, false)},
    {"head too hot", When::Scan, 700ms, true, k_dark, "too hot", line(Line::TooHot, true)},
    {"camera silent", When::Scan, 700ms, true, k_dark, "", flag(&sim::CellFaults::camera_silent)},
    {"frame thread stalled", When::Scan, 700ms, true, k_dark, "", stall("bl-acq")},
    {"safety thread stalled", When::Scan, 700ms, true, k_dark, "", stall("bl-safety")},
    {"stream thread stalled", When::Scan, 700ms, true, k_dark, "", stall("bl-stream")},
    {"pose thread stalled", When::Scan, 300ms, false, k_less, "", stall("bl-pose")},
    {"sensor killed", When::Scan, 0ms, true, k_dark, "", kill_sensor},
    {"sensor stands still", When::Scan, 500ms, true, k_dark, "", hold_sensor},
    {"edges lost", When::Scan, 200ms, false, k_less, "", count(&sim::CellFaults::edges_to_lose, 2)},
    {"edges doubled", When::Scan, 200ms, false, k_less, "", count(&sim::CellFaults::edges_to_double, 2)},
    {"strobe echoes lost", When::Scan, 200ms, false, k_less, "", count(&sim::CellFaults::echoes_to_lose, 2)},
    {"pose bus off", When::Scan, 500ms, false, k_less, "", flag(&sim::CellFaults::bus_off)},
    {"poses silent", When::Scan, 250ms, false, k_less, "", flag(&sim::CellFaults::poses_silent)},
    {"sync stopped", When::Scan, 500ms, false, k_less, "", flag(&sim::CellFaults::sync_stopped)},
    {"poses from the future", When::Scan, 100ms, false, k_less, "",
     count(&sim::CellFaults::poses_from_future, 3)},
    {"robot's clock stepped", When::Scan, 0ms, false, k_less, "", step_robot_clock},
    {"host killed in the scan", When::Scan, 0ms, false, k_less, "", kill_host},
    {"host ended in the scan", When::Scan, 0ms, false, k_less, "", end_host},
    // Nobody who only looks on changes anything.
    {"page killed", When::Scan, 0ms, false, any_of({Followed}), "", kill_page},
    {"page stands still", When::Scan, 2s, false, any_of({Followed}), "", hold_page},
    {"browser stops reading", When::Scan, 4s, false, any_of({Followed}), "", slow_browser},
    // The robot's table.
    {"tip beside the path", When::OnLine, 1s, false, k_halted, "off_path", lies(Lie::TipAside)},
    {"tip NaN", When::Follow, 1s, false, k_halted, "unusable_state", lies(Lie::NotANumber)},
    {"another tool", When::OnLine, 1s, false, k_halted, "other_tool", lies(Lie::OtherTool)},
    {"arm without power", When::Follow, 1s, false, k_halted, "power_off", lies(Lie::PowerOff)},
    {"controller silent", When::Follow, 2s, false, k_halted, "silent", lies(Lie::Silent), 500ms},
    {"link cut", When::Follow, 2s, false, k_halted, "silent", lies(Lie::Cut), 500ms},
    {"protective stop", When::Follow, 1s, false, k_halted, "protective_stop", press_protective_stop},
    {"local control", When::Follow, 3s, false, k_halted, "local_control", take_local_control, 500ms},
    {"door opened while following", When::Follow, 700ms, false, any_of({Followed}), "",
     line(Line::Interlock, false)},
    {"host ended while following", When::Follow, 0ms, false, k_halted, "stopped_by_a_person", end_host},
    {"host killed while following", When::Follow, 0ms, false, any_of({Abandoned}), "", kill_host},
};

}  // namespace

const char* name_of(Outcome outcome) {
  constexpr const char* k_names[k_outcomes] = {"followed", "refused",   "no path", "not sent",
                                               "halted",   "abandoned", "open"};
  return k_names[static_cast<std::size_t>(outcome)];
}

std::span<const Fault> fault_table() {
  return k_table;
}

}  // namespace biteline::soak
