// SPDX-License-Identifier: MIT
#pragma once
/// \file A service with an arm, and a scan that was recorded once for all tests.
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "host/intake/sensor_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"

namespace biteline {

namespace fs = std::filesystem;
using intake::ChildProcess;
using robot::test::FakeController;
using namespace std::chrono_literals;

inline constexpr auto k_patience = 240s;  // of a loaded machine

inline int run(const fs::path& program, const std::vector<std::string>& arguments) {
  auto child = ChildProcess::start({.program = program, .arguments = arguments, .pass_stderr = true});
  SUCCEEDS(child);
  const auto status = child->wait(k_patience);
  SUCCEEDS(status);
  return *status;
}

inline fs::path host_program() {
  return intake::find_sensor_program()->parent_path() / "biteline-host";
}

/// A scan with a shoe and a line, as a service that died left it; made once.
struct RecordedScan {
  test::TemporaryFolder folder;
  fs::path session{folder.path() / "session"};
  fs::path journal{folder.path() / "results/scan-0001/scan.btln"};
  std::string table_z;

  RecordedScan() {
    LONGS_EQUAL(0,
                run(BITELINE_CELL, {"record", "--shoe", "step", "--seed", "8", "--out", session.string()}));
    auto sensor = sensor_of_it();
    LONGS_EQUAL(0, run(host_program(), {"--sensor", sensor.endpoint().text(), "--out",
                                        (folder.path() / "results").string(), "--once", "--keep-recording"}));
    std::ifstream truth{session / "truth/T_base_shoe.txt"};
    for (int i = 0; i < 12; ++i) truth >> table_z;
  }

  [[nodiscard]] intake::SensorProcess sensor_of_it() const {
    auto sensor = intake::SensorProcess::start(
        *intake::find_sensor_program(), {"--source", "replay:" + session.string(), "--stay"}, k_patience);
    SUCCEEDS(sensor);
    return std::move(*sensor);
  }
};

inline const RecordedScan& recorded() {
  static const RecordedScan scan;
  return scan;
}

struct ServiceWithArm : Utest {
  test::TemporaryFolder folder;
  FakeController controller;

  void setup() override {
    controller.answers = {{"PolyscopeVersion", "URSoftware 5.12.0.0 (Jan 01 2022)"},
                          {"get robot model", "UR5"},
                          {"get serial number", "20215500001"},
                          {"is in remote control", "true"}};
  }
  static nlohmann::json gate_of(const fs::path& scan) {
    std::ifstream stream{scan / "gate.json"};
    return test::read_json(stream);
  }
  /// The reasons of the gate's rows that failed.
  static std::string reasons_of(const fs::path& scan) {
    std::string reasons;
    const nlohmann::json gate = gate_of(scan);
    for (const auto& row : gate.value("rows", nlohmann::json::array()))
      reasons += row.value("reason_code", "") + " ";
    return reasons;
  }
  fs::path results() const { return folder.path() / "results"; }
  /// As a service leaves it that dies between the scan's end and its report.
  fs::path leave_scan(const std::string& name) const {
    const fs::path scan = results() / name;
    fs::create_directories(scan);
    fs::copy_file(recorded().journal, scan / "scan.btln");
    return scan;
  }
  std::vector<std::string> arguments(const std::string& sensor) const {
    return {"--sensor", sensor, "--out", results().string()};
  }
  static constexpr const char* k_no_sensor = "tcp://127.0.0.1:1";

  /// Grinding that takes what a short, coarse scan is good to: the gate's row of U95 has tests of its own.
  fs::path coarse_process() const {
    std::ifstream stream{fs::path{BITELINE_PROCESSES} / "grind.yaml"};
    std::string text{std::istreambuf_iterator<char>{stream}, {}};
    const std::string asked = "tolerance_mm: 1 ";
    const std::size_t at = text.find(asked);
    CHECK(at != std::string::npos);
    return folder.write("grind.yaml", text.replace(at, asked.size(), "tolerance_mm: 20 "));
  }
  std::vector<std::string> sending(const std::string& sensor) const {
    std::vector<std::string> all = arguments(sensor);
    const auto at = [](std::uint16_t port) { return "127.0.0.1:" + std::to_string(port); };
    const fs::path process = coarse_process();
    all.insert(all.end(), {"--robot", "UR5e", "--process", process.string(), "--table-z", recorded().table_z,
                           "--rtde", at(controller.rtde_port()), "--script", at(controller.script_port()),
                           "--dashboard", at(controller.dashboard_port()), "--send"});
    return all;
  }
  /// With doors, and a process that wants a person's word.
  std::vector<std::string> holding() const {
    std::ifstream coarse{coarse_process()};
    const std::string text{std::istreambuf_iterator<char>{coarse}, {}};
    // The gate's keys stand last in the file.
    const fs::path process = folder.write("held.yaml", text + "  approval: person\n");
    std::vector<std::string> all = sending(k_no_sensor);
    *(std::ranges::find(all, "--process") + 1) = process.string();
    all.insert(all.end(), {"--control", "tcp://127.0.0.1:0"});
    return all;
  }
  ChildProcess start(std::vector<std::string> all, const std::vector<std::string>& more) const {
    all.insert(all.end(), more.begin(), more.end());
    auto host = ChildProcess::start({.program = host_program(), .arguments = all, .pass_stderr = true});
    SUCCEEDS(host);
    return std::move(*host);
  }
  /// Its exit status and all that it said on stdout.
  static std::pair<int, std::string> end_of(ChildProcess& host) {
    std::string said;
    while (const auto line = host.next_line(k_patience)) said += *line + "\n";
    const auto status = host.wait(k_patience);
    SUCCEEDS(status);
    return {*status, said};
  }
  static nlohmann::json report_of(const fs::path& scan) {
    std::ifstream stream{scan / "report.json"};
    return test::read_json(stream);
  }
};

}  // namespace biteline
