// SPDX-License-Identifier: MIT
// Two processes with a tool each, which a changer brings: two guns in a simulated turret at the flange.
#include <algorithm>

#include "host/records/mounted/mounted_record.hpp"
#include "tests/integration/robot/work_cell.hpp"

namespace biteline {

struct ChangerCell : WorkedCell {
  const mounted::Hand hand{.who = "eng", .door = "command line"};

  /// gun_a stands in the turret's first place, as a person said, gun_b in its second; both switch output 1.
  void teach_tools() const {
    fs::create_directories(results());
    auto memory = memory::Memory::open(results() / memory::k_memory_file);
    SUCCEEDS(memory);
    const auto teach = [&](const char* name, int ask_output, int there_input) {
      SUCCEEDS(mounted::mount_tool(*memory, name, hand));
      SUCCEEDS(mounted::keep_lines(
          *memory,
          {.on_output = 1,
           .changer = path::ChangerLines{.ask_output = ask_output, .there_input = there_input}},
          hand));
    };
    teach("gun_b", 5, 3);
    teach("gun_a", 4, 2);
  }
  std::string tool_of_record() const {
    const auto memory = memory::Memory::open_to_read(results() / memory::k_memory_file);
    SUCCEEDS(memory);
    const auto record = mounted::read_record(*memory);
    SUCCEEDS(record);
    return record->tool ? record->tool->name + " by " + record->tool->how.who : "nobody knows";
  }
};

TEST_GROUP_BASE(ServiceChanger, ChangerCell){};

ORDINARY_TIMED_TEST(ServiceChanger, BringsTheNextProcesssTool) {
  begin_cell({"turret"});
  teach_tools();
  save_second("  name: gun_b\n");
  ChildProcess host = start({"--once"}, {}, "next_process: second\n", "  name: gun_a\n");
  const auto [status, said] = end_of(host);
  LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::Done), status, said.c_str());
  STRCMP_EQUAL("gun_a", file("gate.json")["inputs"]["result"].value("mounted_tool", "").c_str());
  STRCMP_EQUAL("gun_b", file("gate.json", "scan-0002")["inputs"]["result"].value("mounted_tool", "").c_str());
  CHECK(row("scan-0002").followed.value_or(false));
  STRCMP_EQUAL("ok", row("scan-0002").work.verdict.c_str());
  STRCMP_EQUAL("gun_b by changer", tool_of_record().c_str());
  for (const double here : layers()) CHECK_COMPARE(here, >, 1.9);
}

/// What stands in a changer that does not answer nobody knows: a person looks, and says so.
ORDINARY_TIMED_TEST(ServiceChanger, ThatComesToNoToolIsNotWorkedWith) {
  begin_cell({"turret-stuck"});
  teach_tools();
  save_second("  name: gun_b\n");
  ChildProcess host = start({"--once"}, {}, "next_process: second\n", "  name: gun_a\n");
  const auto [status, said] = end_of(host);
  LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::Refused), status, said.c_str());
  const nlohmann::json gate = file("gate.json", "scan-0002");
  CHECK(!gate.value("permitted", true));
  STRCMP_CONTAINS("does not tell within",
                  gate["inputs"]["result"].value("changer_trouble", std::string{}).c_str());
  STRCMP_EQUAL("tool_not_mounted", row("scan-0002").reason_code.c_str());
  CHECK(!row("scan-0002").sent);
  STRCMP_EQUAL("ok", row().work.verdict.c_str());
  STRCMP_EQUAL("nobody knows", tool_of_record().c_str());
  // One film, and its seam.
  const std::vector<double> laid = layers();
  CHECK_COMPARE(std::ranges::count_if(laid, [](double here) { return here > 1.5; }), <,
                std::ssize(laid) / 10);
}

/// A process that switches another output than its tool's would leave the gun shut, or another tool on.
ORDINARY_TIMED_TEST(ServiceChanger, AnotherOutputThanTheToolsIsRefused) {
  begin_cell({"turret"});
  teach_tools();
  std::string text = process({}, {}, "  name: gun_a\n");
  const std::string output = "digital_output: 1";
  text.replace(text.find(output), output.size(), "digital_output: 0");
  ChildProcess host = start_with(folder.write("cement.yaml", text), {"--once"});
  const auto [status, said] = end_of(host);
  LONGS_EQUAL_TEXT(static_cast<int>(ExitStatus::Refused), status, said.c_str());
  STRCMP_EQUAL("not_as_taught", row().reason_code.c_str());
  STRCMP_CONTAINS("output 0", row().reason.c_str());
  CHECK(!row().sent);
}

}  // namespace biteline
