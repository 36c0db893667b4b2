// SPDX-License-Identifier: MIT
#include "hal/sim/robot/program_text.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::sim {
namespace {

std::vector<std::uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

}  // namespace

TEST_GROUP(ProgramText){};

TEST(ProgramText, ProgramsAreTakenOneByOneAsTheyComeWhole) {
  auto bytes = bytes_of(
      "\n\ndef a():\n  while True:\n    if 1 > 0:\n      sync()\n    else:\n      halt\n    end\n  "
      "end\nend\nstop program\ndef b():\n");
  const auto first = take_program(bytes);
  CHECK(first.has_value());
  CHECK(first->starts_with("def a()"));
  CHECK(first->ends_with("  end\nend\n"));
  STRCMP_EQUAL("stop program\n", take_program(bytes)->c_str());
  CHECK(!take_program(bytes));
  for (const auto byte : bytes_of("end\n")) bytes.push_back(byte);
  STRCMP_EQUAL("def b():\nend\n", take_program(bytes)->c_str());
  CHECK(bytes.empty());
}

TEST(ProgramText, WithoutControlFlowItIsAPlainOne) {
  CHECK(std::holds_alternative<Script>(*parse_program("def a():\n  v = 0.1\n  sleep(v)\nend\n")));
  CHECK(std::holds_alternative<ScriptCode>(
      *parse_program("def a():\n  while True:\n    sync()\n  end\nend\n")));
  CHECK(std::holds_alternative<ScriptCode>(
      *parse_program("def a():\n  here = get_actual_tcp_pose()\n  movel(here)\nend\n")));
  CHECK(std::holds_alternative<ScriptCode>(*parse_program("sleep(0.1 * 2)\n")));
}

/// As a real controller's compiler names it: the line, the column, the name.
TEST(ProgramText, WhatItDoesNotKnowIsNamedWithItsPlace) {
  const struct {
    const char *text, *fault;
    int line, column;
  } rows[] = {{"def a():\n  nothing()\nend\n", "compile_error_name_not_found:nothing:", 2, 3},
              {"def a():\n  while True:\n    servoj([0,0,0,0,0,0])\n  end\nend\n",
               "compile_error_name_not_found:servoj:", 3, 5},
              {"def a():\n  x = cos(1)\nend\n", "compile_error_name_not_found:cos:", 2, 7}};
  for (const auto& row : rows) {
    const auto program = parse_program(row.text);
    CHECK_TEXT(!program.has_value(), row.text);
    const ProgramFault fault = fault_of(program.error(), row.text);
    STRCMP_EQUAL(row.fault, fault.text.c_str());
    LONGS_EQUAL(row.line, fault.line);
    LONGS_EQUAL(row.column, fault.column);
  }
}

TEST(ProgramText, BlocksThatDoNotCloseAreNoProgram) {
  for (const char* text :
       {"def a():\n  while True:\n    sync()\nend\n", "def a():\n  if True:\n  else:\n  else:\n  end\nend\n",
        "def a():\n  elif True:\n  end\nend\n", "while True:\n", "def a():\nend\nsync()\n", ""}) {
    if (std::string_view{text}.empty()) continue;
    CHECK_TEXT(!parse_program(text).has_value(), text);
  }
}

TEST(ProgramText, TheControllersOwnWordsAreNoPrograms) {
  CHECK(port_order("power on\n") == PortOrder::PowerOn);
  CHECK(port_order("power off\r\n") == PortOrder::PowerOff);
  CHECK(port_order("set robotmode run\n") == PortOrder::ReleaseBrakes);
  CHECK(port_order("set unlock protective stop\n") == PortOrder::Unlock);
  CHECK(port_order("stop program\n") == PortOrder::Stop);
  CHECK(port_order("def a():\n  sync()\nend\n") == PortOrder::None);
}

}  // namespace biteline::sim
