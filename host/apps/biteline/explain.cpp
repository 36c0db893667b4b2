// SPDX-License-Identifier: MIT
// biteline explain: why a scan's path was sent, or was not.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/apps/biteline/command.hpp"
#include "host/robot/link/gate/gate_file.hpp"

namespace biteline::app {
namespace {

const char* mark(robot::GateRow::State state) {
  switch (state) {
    case robot::GateRow::State::Passed:
      return "passed   ";
    case robot::GateRow::State::Failed:
      return "FAILED   ";
    case robot::GateRow::State::NotKnown:
      return "not known";
  }
  return "";
}

Result<ExitStatus> explain(const std::filesystem::path& scan, const GlobalOptions& options) {
  // Reading makes the decision again from its inputs: a file that says something else is refused there.
  BITELINE_ASSIGN(const robot::GateFile gate, robot::read_gate(scan / "gate.json"));
  const std::vector<robot::GateRow> rows = robot::judge(gate.inputs);
  if (options.json) {
    nlohmann::ordered_json json{{"permitted", gate.permitted}, {"failures", robot::failures(rows)}};
    std::printf("%s\n", json.dump().c_str());
  } else {
    for (const robot::GateRow& row : rows) {
      std::printf("%s  %-32s %s (%s)\n", mark(row.state), row.name.c_str(), row.value.c_str(),
                  row.limit.c_str());
      if (row.state == robot::GateRow::State::Failed)
        std::printf("           %s\n", report::refusal_row(row.code).next_step);
    }
    std::printf("%s: the inputs give the same decision again\n",
                gate.permitted ? "the path was let through" : "the path was not let through");
  }
  return gate.permitted ? ExitStatus::Done : ExitStatus::Refused;
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
