// SPDX-License-Identifier: MIT
// biteline explain: why a scan's path was sent, or was not; also where none was planned.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/core/text.hpp"
#include "common/system/file.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/robot/link/gate/gate_file.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using State = robot::GateRow::State;
using Json = nlohmann::ordered_json;

const char* mark(State state) {
  switch (state) {
    case State::Passed:
      return "passed       ";
    case State::Failed:
      return "FAILED       ";
    case State::NotKnown:
      return "not known    ";
    case State::NotLookedAt:
      return "not looked at";
  }
  return "";
}

/// An older file does not say whether the arm was asked: it was not, where the scan itself was refused.
void tell_what_was_not_looked_at(const robot::GateInputs& inputs, std::vector<robot::GateRow>& rows) {
  const bool by_scan = std::ranges::any_of(rows, [](const robot::GateRow& row) {
    return row.state == State::Failed && !robot::needs_the_arm(row.code);
  });
  if (inputs.arm.asked || !by_scan) return;
  for (robot::GateRow& row : rows) {
    if (!robot::needs_the_arm(row.code)) continue;
    row.state = State::NotLookedAt;
    row.value = "not looked at";
  }
}

Result<ExitStatus> explain_gate(const fs::path& scan, const GlobalOptions& options) {
  // Reading makes the decision again from its inputs: a file that says something else is refused there.
  BITELINE_ASSIGN(const robot::GateFile gate, robot::read_gate(scan / "gate.json"));
  std::vector<robot::GateRow> rows = robot::judge(gate.inputs);
  tell_what_was_not_looked_at(gate.inputs, rows);
  if (options.json) {
    const Json json{{"permitted", gate.permitted}, {"failures", robot::failures(rows)}};
    std::printf("%s\n", json.dump(-1, ' ', false, Json::error_handler_t::replace).c_str());
  } else {
    for (const robot::GateRow& row : rows) {
      std::printf("%s  %-32s %s (%s)\n", mark(row.state), row.name.c_str(), row.value.c_str(),
                  row.limit.c_str());
      if (row.state == State::Failed)
        std::printf("               %s\n", report::refusal_row(row.code).next_step);
    }
    std::printf("%s: the inputs give the same decision again\n",
                gate.permitted ? "the path was let through" : "the path was not let through");
  }
  return gate.permitted ? ExitStatus::Done : ExitStatus::Refused;
}

std::string text_of(const Json& json, const char* key) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  return json.is_object() && found != json.end() && found->is_string() ? found->get<std::string>()
                                                                       : std::string{};
}

/// The gates of the line that said no, each with what it measured and its limit; empty: none, or an older
/// report.
Json failed_gates(const Json& report) {
  Json failed = Json::array();
  const auto gates = report.find("gates");
  if (gates == report.end() || !gates->is_array()) return failed;
  for (const Json& gate : *gates) {
    const auto number = [&](const char* key) {
      const auto found = gate.is_object() ? gate.find(key) : gate.end();
      return gate.is_object() && found != gate.end() && found->is_number();
    };
    const bool at_most = number("at_most");
    if (!number("sure") || !number("value") || (!at_most && !number("at_least"))) continue;
    if (gate["sure"].get<double>() >= 0.5) continue;
    failed.push_back({{"measure", clean_text(text_of(gate, "measure"), 60)},
                      {"value", gate["value"]},
                      {at_most ? "at_most" : "at_least", gate[at_most ? "at_most" : "at_least"]}});
  }
  return failed;
}

/// What stands before the gate: the line, and the path along it.
struct Step {
  const char* name;
  const char* file;
};

/// A scan that never came to the gate: its first refusal, else what it has come to.
Result<ExitStatus> explain_report(const fs::path& scan, const GlobalOptions& options) {
  constexpr std::array k_steps{Step{"line", "report.json"}, Step{"path", "path/report.json"}};
  Json told{{"permitted", false}, {"failures", ""}};
  std::error_code error;
  for (const Step& step : k_steps) {
    const fs::path file = scan / step.file;
    if (!fs::exists(file, error)) {
      if (file == scan / "report.json")
        return fail(Errc::FileNotFound, "%.200s: no scan that was worked out lies there", file.c_str());
      told["failures"] = std::string{step.name} + ": none was planned";
      break;
    }
    BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_settings_bytes));
    const Json report = Json::parse(text, nullptr, false);
    if (!report.is_object()) return fail(Errc::BadFormat, "%.200s: an object expected", file.c_str());
    if (text_of(report, "status") == "ok") continue;
    told["failures"] = std::string{step.name} + ": " + clean_text(text_of(report, "reason"), 1000);
    told["reason_code"] = clean_text(text_of(report, "reason_code"), 100);
    told["next_step"] = clean_text(text_of(report, "next_step"), 500);
    if (Json failed = failed_gates(report); !failed.empty()) told["gates"] = std::move(failed);
    break;
  }
  if (told["failures"] == "")
    told["failures"] = "gate: it was never asked; the path was planned and not sent";
  if (options.json) {
    std::printf("%s\n", told.dump(-1, ' ', false, Json::error_handler_t::replace).c_str());
  } else {
    std::printf("%s\n", text_of(told, "failures").c_str());
    for (const Json& gate : told.value("gates", Json::array())) {
      const bool at_most = gate.contains("at_most");
      std::printf("  %-20s %.2f (%s %.2f)\n", text_of(gate, "measure").c_str(), gate["value"].get<double>(),
                  at_most ? "at most" : "at least", gate[at_most ? "at_most" : "at_least"].get<double>());
    }
    if (const std::string next = text_of(told, "next_step"); !next.empty())
      std::printf("next: %s (%s)\n", next.c_str(), text_of(told, "reason_code").c_str());
    std::printf("the gate before the arm was not asked: nothing was sent\n");
  }
  return ExitStatus::Refused;
}

Result<ExitStatus> explain(const fs::path& scan, const GlobalOptions& options) {
  std::error_code error;
  return fs::exists(scan / "gate.json", error) ? explain_gate(scan, options) : explain_report(scan, options);
}

}  // namespace

void add_explain(options::Command& app, Context& context) {
  auto scan = std::make_shared<std::filesystem::path>();
  options::Command* command =
      app.add_subcommand("explain", "Why a scan's path was sent to the arm, or was not");
  command->add_option("SCAN", *scan, "The scan's folder")->required();
  command->callback(
      [scan, &context] { context.run = [scan, &context] { return explain(*scan, context.options); }; });
}

}  // namespace biteline::app
