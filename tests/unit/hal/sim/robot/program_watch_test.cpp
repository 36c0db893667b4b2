// SPDX-License-Identifier: MIT
// Threads and watchdogs of a program, by the controller's time alone: no test waits for a clock.
#include "hal/sim/robot/program_watch.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/transforms.hpp"

namespace biteline::sim {

namespace {

constexpr SensorClock::time_point k_begin{Nanoseconds{1'000'000'000}};

SensorClock::time_point at(double time_s) {
  return k_begin + Nanoseconds{static_cast<std::int64_t>(time_s * 1e9 + 0.5)};
}

struct Inputs final : RtdeInputs {
  int input_register(int number) const override { return number == 47 ? count : 0; }
  std::optional<SensorClock::time_point> written(const std::string& variable) const override {
    return variable == "input_int_register_47" ? last : std::nullopt;
  }
  void beat(double time_s) {
    ++count;
    last = at(time_s);
  }
  int count{0};
  std::optional<SensorClock::time_point> last{};
};

const char* const k_watched =
    "def job():\n"
    "  rtde_set_watchdog(\"input_int_register_47\", 2, \"stop\")\n"
    "  thread dead_man():\n"
    "    local last = read_input_integer_register(47)\n"
    "    local still = 0\n"
    "    while still < 7:\n"
    "      sleep(0.05)\n"
    "      local beat = read_input_integer_register(47)\n"
    "      if beat == last:\n"
    "        still = still + 1\n"
    "      else:\n"
    "        still = 0\n"
    "      end\n"
    "      last = beat\n"
    "    end\n"
    "    set_standard_digital_out(0, False)\n"
    "    sync()\n"
    "    halt\n"
    "  end\n"
    "  watch = run dead_man()\n"
    "  set_standard_digital_out(0, True)\n"
    "  set_standard_digital_out(3, True)\n"
    "  sleep(20)\n"
    "  kill watch\n"
    "  sleep(5)\n"
    "end\n";

}  // namespace

TEST_GROUP(ProgramWatch) {
  ArmKinematics kinematics = *ArmKinematics::named("ur5e");
  Arm arm{kinematics, (JointVector() << 0.1, -1.4, 1.7, -1.8, -1.5, 0.2).finished()};
  ProgramWatch sut{arm, 0.002};
  Inputs inputs;

  void run(const char* script) {
    const auto read = parse_script(script);
    CHECK_TEXT(read.has_value(), read ? "" : to_line(read.error()).c_str());
    arm.run(*read, k_begin);
  }
  /// Cycle by cycle, with a beat every `beat_s` up to `beats_until_s`.  When the program was cut, or nothing.
  std::optional<double> cut_at(double from_s, double until_s, double cycle_s, double beats_until_s,
                               double beat_s = 0.02) {
    for (double now_s = from_s; now_s < until_s; now_s += cycle_s) {
      while (beaten_s <= std::min(now_s, beats_until_s)) {
        inputs.beat(beaten_s);
        beaten_s += beat_s;
      }
      if (!sut.step(at(now_s), inputs).empty()) return now_s;
    }
    return std::nullopt;
  }
  double beaten_s{0};
};

TEST(ProgramWatch, WatchedProgramGoesOn) {
  run(k_watched);
  CHECK(!cut_at(0, 19, 0.002, 19));
  CHECK(arm.at(at(19)).program_running);
  LONGS_EQUAL(0b1001, arm.at(at(19)).outputs);
}

/// A slider at nothing stops the moves, and neither the watchdog nor the thread that watches.
TEST(ProgramWatch, SliderAtNothingStopsTheMovesAndNoWatch) {
  const char* const moves =
      "def job():\n  rtde_set_watchdog(\"input_int_register_47\", 2, \"stop\")\n"
      "  set_standard_digital_out(0, True)\n"
      "  movej([0.5,-1.2,1.5,-1.6,-1.4,0.4], a=1, v=0.5)\n"
      "  set_standard_digital_out(0, False)\nend\n";
  run(moves);
  arm.set_speed(0, at(0.5));
  CHECK(!cut_at(0, 10, 0.002, 10));
  CHECK(arm.at(at(10)).program_running);
  LONGS_EQUAL(1, arm.at(at(10)).outputs);
  TRANSFORMS_EQUAL(arm.at(at(0.5)).T_base_flange, arm.at(at(10)).T_base_flange, 1e-9, 1e-12);
  arm.set_speed(0.5, at(10));
  CHECK(arm.at(at(11.59)).program_running);
  CHECK_FALSE(arm.at(at(11.61)).program_running);  // 0.8 s of the program at half its speed
  LONGS_EQUAL(0, arm.at(at(11.61)).outputs);
  arm.set_speed(1, at(12));

  run(moves);
  arm.set_speed(0, at(0.5));
  beaten_s = 0;
  const auto cut = cut_at(0, 10, 0.002, 2);
  CHECK(cut.has_value());
  DOUBLES_EQUAL(2.5, *cut, 0.03);
}

/// The moves go on to the value that the program gave its variable, and the thread sees it from then on.
TEST(ProgramWatch, AThreadSeesTheProgramsVariablesAndSetsAnalogOutputs) {
  run("def job():\n  global share = 0.25\n  thread flow():\n    while True:\n"
      "      set_standard_analog_out(1, share)\n      sync()\n    end\n  end\n"
      "  flowing = run flow()\n  sleep(1)\n  share = 0.75\n  sleep(1)\n  kill flowing\n"
      "  set_standard_analog_out(1, 0)\n  sleep(1)\nend\n");
  CHECK(!cut_at(0, 0.5, 0.002, 0));
  DOUBLES_EQUAL(0.25, arm.at(at(0.5)).analog_ratio[1], 0);
  CHECK(!cut_at(0.5, 1.5, 0.002, 0));
  DOUBLES_EQUAL(0.75, arm.at(at(1.5)).analog_ratio[1], 0);
  CHECK(!cut_at(1.5, 2.5, 0.002, 0));
  DOUBLES_EQUAL(0, arm.at(at(2.5)).analog_ratio[1], 0);
}

/// As a real controller's analog outputs do; a program that takes no time sets them, too.
TEST(ProgramWatch, AnalogOutputsStayWhenAProgramEndsUntilAnotherOneSetsThem) {
  run("def job():\n  set_standard_analog_out(0, 0.5)\n  sleep(0.1)\nend\n");
  arm.stop(at(0.05));
  DOUBLES_EQUAL(0.5, arm.at(at(1)).analog_ratio[0], 0);
  const auto read = parse_script("def stop():\n  set_standard_analog_out(0, 0)\n  stopj(2.0)\nend\n");
  arm.run(*read, at(1));
  DOUBLES_EQUAL(0, arm.at(at(1)).analog_ratio[0], 0);
}

TEST(ProgramWatch, AThreadWhoseValueIsNoneHaltsItsProgram) {
  run("def job():\n  thread t():\n    sleep(0.1)\n    local x = nothing + 1\n  end\n"
      "  r = run t()\n  sleep(5)\nend\n");
  const auto cut = cut_at(0, 1, 0.002, 0);
  CHECK(cut.has_value());
  DOUBLES_EQUAL(0.1, *cut, 0.005);
}

TEST(ProgramWatch, CountThatStandsStillTurnsTheToolOffAndHaltsOnBothSeries) {
  for (const double cycle_s : {0.002, 0.008}) {
    for (double last_s = 1; last_s < 1.1; last_s += 0.007) {
      inputs = {};
      beaten_s = 0;
      run(k_watched);
      const auto cut = cut_at(0, 5, cycle_s, last_s);
      CHECK(cut.has_value());
      const double after_s = *cut - (beaten_s - 0.02);
      CHECK(after_s >= 0.33);  // a beat is seen up to a look late
      CHECK(after_s < 0.5);    // before the controller's own watchdog, which leaves the tool on
      const ArmState now = arm.at(at(*cut));
      CHECK_FALSE(now.program_running);
      LONGS_EQUAL(0b1000, now.outputs);
    }
  }
}

TEST(ProgramWatch, ControllersOwnWatchdogStopsAndLeavesOutputsAsTheyAre) {
  run("def job():\n  rtde_set_watchdog(\"input_int_register_47\", 2, \"stop\")\n"
      "  set_standard_digital_out(0, True)\n  sleep(20)\nend\n");
  const auto cut = cut_at(0, 5, 0.002, 1);
  CHECK(cut.has_value());
  DOUBLES_EQUAL(1.5, *cut, 0.03);
  CHECK_FALSE(arm.at(at(*cut)).program_running);
  LONGS_EQUAL(1, arm.at(at(*cut)).outputs);
}

TEST(ProgramWatch, WatchdogWithoutAnyUpdateCountsFromItsSetting) {
  run("def job():\n  sleep(1)\n  rtde_set_watchdog(\"input_int_register_47\", 4, \"stop\")\n  "
      "sleep(20)\nend\n");
  const auto cut = cut_at(0, 5, 0.002, -1);
  CHECK(cut.has_value());
  DOUBLES_EQUAL(1.25, *cut, 0.005);
}

TEST(ProgramWatch, IgnoredWatchdogAndAnotherVariablesBeatDoNotCount) {
  run("def job():\n  rtde_set_watchdog(\"input_int_register_47\", 4, \"ignore\")\n  sleep(3)\nend\n");
  CHECK(!cut_at(0, 3.5, 0.002, -1));
  run("def job():\n  rtde_set_watchdog(\"input_int_register_24\", 4, \"stop\")\n  sleep(3)\nend\n");
  beaten_s = 0;
  CHECK(cut_at(0, 3.5, 0.002, 3).has_value());
}

/// A controller that a busy machine holds up reads the beats that came meanwhile, and then looks.
TEST(ProgramWatch, CycleThatComesLateIsNoSilence) {
  run(k_watched);
  CHECK(!cut_at(0, 15, 0.3, 15));
}

TEST(ProgramWatch, KilledThreadAndEndedProgramWatchNoMore) {
  run("def job():\n  thread t():\n    sleep(1)\n    set_standard_digital_out(2, True)\n    halt\n  end\n"
      "  a = run t()\n  sleep(0.5)\n  kill a\n  sleep(2)\nend\n");
  CHECK(!cut_at(0, 4, 0.002, -1));
  LONGS_EQUAL(0, arm.at(at(4)).outputs);
  run(k_watched);
  arm.stop(at(0.1));
  CHECK(!cut_at(0.1, 3, 0.002, -1));
  LONGS_EQUAL(0b1001, arm.at(at(3)).outputs);  // as a real one: outputs stay when a program is stopped
}

TEST(ProgramWatch, OutputOfAThreadHoldsUntilTheProgramSetsIt) {
  run("def job():\n  thread t():\n    set_standard_digital_out(1, True)\n  end\n  a = run t()\n  sleep(1)\n"
      "  set_standard_digital_out(1, True)\n  sleep(1)\n  set_standard_digital_out(1, False)\n  "
      "sleep(1)\nend\n");
  CHECK(!cut_at(0, 2.9, 0.002, 3));
  LONGS_EQUAL(0b10, arm.at(at(0.5)).outputs);
  LONGS_EQUAL(0b10, arm.at(at(1.5)).outputs);
  LONGS_EQUAL(0, arm.at(at(2.5)).outputs);
}

TEST(ProgramWatch, ThreadThatNeverWaitsDoesNotHoldUpTheController) {
  run("def job():\n  thread t():\n    x = 0\n    while True:\n      x = x + 1\n    end\n  end\n  a = run "
      "t()\n"
      "  sleep(1)\nend\n");
  CHECK(!cut_at(0, 1.1, 0.05, -1));
}

TEST(ProgramWatch, WhatItDoesNotKnowOfThreadsIsRefusedWithItsLine) {
  struct Row {
    const char* text;
    const char* place;
  };
  for (const Row& row :
       {Row{"def a():\n  thread t():\n    movel(p[0,0,0,0,0,0])\n  end\nend\n", "line 3"},
        Row{"def a():\n  thread t():\n    else:\n  end\nend\n", "line 3"},
        Row{"def a():\n  thread t():\n    while x ~ 2:\n    end\n  end\nend\n", "line 3"},
        Row{"def a():\n  thread t():\n    set_standard_digital_out(9, True)\n  end\nend\n", "line 3"},
        Row{"def a():\n  b = run t()\nend\n", "line 2"}, Row{"def a():\n  kill b\nend\n", "line 2"},
        Row{"def a():\n  rtde_set_watchdog(\"x\", 2, \"pause\")\nend\n", "line 2"},
        Row{"def a():\n  rtde_set_watchdog(\"x\", 0, \"stop\")\nend\n", "line 2"},
        Row{"def a():\n  thread t():\n    sleep(1)\n", "'end' is missing"}}) {
    const auto read = parse_script(row.text);
    CHECK_TEXT(!read.has_value(), row.text);
    STRCMP_CONTAINS(row.place, to_line(read.error()).c_str());
  }
}

}  // namespace biteline::sim
