// SPDX-License-Identifier: MIT
#pragma once
/// \file A simulated arm that lays glue on a made shoe, and a whole service that looks at it.

#include <CppUTest/TestHarness.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/records/memory/memory.hpp"
#include "tests/integration/robot/person.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline {

namespace fs = std::filesystem;

inline constexpr double k_gap_mm = 6;

struct WorkedCell : Utest {
  test::TemporaryFolder folder;
  std::optional<ChildProcess> cell;
  nlohmann::json ports;
  std::string sensor;
  bool passes_stderr{true};  ///< else it is kept: ChildProcess::last_words()

  fs::path results() const { return folder.path() / "results"; }
  fs::path scan() const { return results() / "scan-0001"; }
  void begin_cell(std::vector<std::string> fault) {
    fault.insert(fault.begin(), (folder.path() / "truth").string());
    auto child = ChildProcess::start(
        {.program = BITELINE_WORKED_CELL, .arguments = std::move(fault), .pass_stderr = true});
    SUCCEEDS(child);
    cell.emplace(std::move(*child));
    const auto told = cell->next_line(k_patience), address = cell->next_line(k_patience);
    SUCCEEDS(told);
    SUCCEEDS(address);
    ports = test::read_json(*told);
    sensor = *address;
  }
  /// Quick cement above the line, on what a quick scan is good to; watched as a loaded machine can.
  std::string process(const std::string& gate, const std::string& more, const std::string& tool) const {
    std::ifstream stream{fs::path{BITELINE_PROCESSES} / "cement.yaml"};
    std::string text{std::istreambuf_iterator<char>{stream}, {}};
    for (const auto& [asked, instead] :
         {std::pair<std::string, std::string>{"start: auto",
                                              "start: auto\nafter_work: rework\nfollow: {covered: 0.5}"},
          {"up_mm: 2", "up_mm: 5"},
          {"contact_width_mm: 10", "contact_width_mm: 6"},
          {"\n  speed_mm_s: 80", "\n  speed_mm_s: 160"},
          {"\n  tolerance_mm: 1 ", "\n  tolerance_mm: 20 "},
          {"\n  tip_tolerance_mm: 2 ", "\n  tip_tolerance_mm: 20 "}}) {
      const std::size_t at = text.find(asked);
      CHECK_TEXT(at != std::string::npos, asked.c_str());
      text.replace(at, asked.size(), instead);
    }
    text.insert(text.find("  tcp_position_mm"), tool);
    return more + text + gate;
  }
  /// Grinding with a set force, on what a quick scan is good to.
  fs::path pressing_process() const {
    std::ifstream stream{fs::path{BITELINE_PROCESSES} / "grind_force.yaml"};
    std::string text{std::istreambuf_iterator<char>{stream}, {}};
    for (const auto& [asked, instead] :
         {std::pair<std::string, std::string>{"start: auto", "start: auto\nfollow: {covered: 0.5}"},
          {"\n  tolerance_mm: 1 ", "\n  tolerance_mm: 20 "},
          {"\n  tip_tolerance_mm: 2 ", "\n  tip_tolerance_mm: 20 "}}) {
      const std::size_t at = text.find(asked);
      CHECK_TEXT(at != std::string::npos, asked.c_str());
      text.replace(at, asked.size(), instead);
    }
    return folder.write("grind_force.yaml", text);
  }
  /// Saved at the cell; its tool's keys begin with `tool`.
  void save_second(const std::string& tool, const std::string& more = {}) const {
    fs::create_directories(results() / "processes");
    std::string text = process({}, more, tool);
    const std::string name = "name: cement";
    text.replace(text.find(name), name.size(), "name: second film");
    std::ofstream{results() / "processes/second.yaml"} << text;
  }
  static std::string not_sendable(const Page& page) {
    const control::Json held = page.ask("GET", "/state").body["held"];
    return held.is_object() && held["reason_code"].is_string() ? held["reason_code"] : "";
  }
  static void until_sendable(const Page& page) {
    const auto until = std::chrono::steady_clock::now() + k_patience;
    while (!not_sendable(page).empty() && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(50ms);
    STRCMP_EQUAL("", not_sendable(page).c_str());
  }
  static int accept(const Page& page, const std::string& name) {
    const control::Json held = page.ask("GET", "/state").body["held"];
    return page.ask("POST", "/scans/" + name + "/accept", {{"version", held["version"]}}).status;
  }
  /// `keys` of the process beside its gate's, and `tool` of its tool.
  ChildProcess start(const std::vector<std::string>& more, const std::string& gate = {},
                     const std::string& keys = {}, const std::string& tool = {}) const {
    return start_with(folder.write("cement.yaml", process(gate, keys, tool)), more);
  }
  ChildProcess start_with(const fs::path& process, const std::vector<std::string>& more) const {
    const auto at = [&](const char* port) { return "127.0.0.1:" + std::to_string(ports[port].get<int>()); };
    std::vector<std::string> all{"--sensor",
                                 sensor,
                                 "--out",
                                 results().string(),
                                 "--robot",
                                 "UR10e",
                                 "--process",
                                 process.string(),
                                 "--fixture-z",
                                 std::to_string(ports["fixture_z_mm"].get<double>()),
                                 "--fixture-beyond",
                                 std::to_string(ports["fixture_beyond_mm"].get<double>()),
                                 "--rtde",
                                 at("rtde"),
                                 "--script",
                                 at("script"),
                                 "--dashboard",
                                 at("dashboard"),
                                 "--send"};
    all.insert(all.end(), more.begin(), more.end());
    auto host =
        ChildProcess::start({.program = host_program(), .arguments = all, .pass_stderr = passes_stderr});
    SUCCEEDS(host);
    return std::move(*host);
  }
  /// What a service says from its start to there and, as its row comes then and no other scan may, 2 s more.
  std::string all_until_a_person_must_look() const {
    ChildProcess host = start({});
    std::string said;
    while (const auto line = host.next_line(k_patience)) {
      said += *line + "\n";
      if (line->find("a person must look before the next scan") != std::string::npos) break;
    }
    while (const auto line = host.next_line(2s)) said += *line + "\n";
    return said;
  }
  static std::pair<int, std::string> end_of(ChildProcess& host) { return ServiceWithArm::end_of(host); }
  nlohmann::json file(const char* name, const char* of = "scan-0001") const {
    std::ifstream stream{results() / of / name};
    return test::read_json(stream);
  }
  memory::Scan row(const char* name = "scan-0001") const {
    const auto memory = memory::Memory::open_to_read(results() / memory::k_memory_file);
    SUCCEEDS(memory);
    const auto row = memory->scan(name);
    CHECK(row && *row);
    return **row;
  }
  /// Places of the true line, 0.5 mm apart, as the last scan saw them.
  std::vector<double> layers() const {
    std::ifstream stream{folder.path() / "truth/worked.csv"};
    std::vector<double> laid;
    for (std::string line; std::getline(stream, line);)
      if (!line.empty() && line[0] != '#') laid.push_back(std::stod(line.substr(line.rfind(',') + 1)));
    return laid;
  }
};

}  // namespace biteline
