// SPDX-License-Identifier: MIT
#include "host/robot/path/mounted.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <limits>

#include "host/robot/path/plan.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {

TEST_GROUP(Mounted) {
  PlanRequest request{.line = test::made_line(),
                      .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "rough.yaml"),
                      .arm = *kinematics::arm_model("UR5e"),
                      .T_line_base = SE3::Identity(),
                      .table_z_mm = 40,
                      .shoe = {},
                      .cloud = {}};
  const Vec3 tip{request.process.tool.T_flange_tcp.translation()};

  std::string code() {
    const PlanOutcome outcome = plan(request);
    if (outcome.path) return "planned";
    return report::told(*outcome.refusal).reason_code;
  }
};

TEST(Mounted, WhatWasNotTaughtIsNotChecked) {
  STRCMP_EQUAL("planned", code().c_str());
  CHECK(check_mounted(request.process, {}).empty());
}

TEST(Mounted, AProcessOfTheMountedToolIsPlanned) {
  request.mounted.tip_flange = tip + Vec3{0, 0.6, 0.6};
  request.mounted.payload = request.process.tool.payload;
  STRCMP_EQUAL("planned", code().c_str());
  LONGS_EQUAL(2, check_mounted(request.process, request.mounted).size());
}

TEST(Mounted, AProcessThatTellsNoPayloadCarriesTheTaughtOne) {
  const Payload taught{.mass_kg = 1.25, .centre_flange_mm = {0, 5, 60}};
  request.process.tool.payload.reset();
  CHECK(!carried(request.process, {}));
  request.mounted.payload = taught;
  const PlanOutcome outcome = plan(request);
  CHECK(outcome.path.has_value());
  const std::optional<Payload>& sent = outcome.path->path().payload;
  CHECK(sent.has_value());
  DOUBLES_EQUAL(1.25, sent->mass_kg, 0);
  CHECK(sent->centre_flange_mm == taught.centre_flange_mm);
}

TEST(Mounted, AProcessWhoseTipDiffersIsRefusedBeforeAnythingIsPlanned) {
  request.mounted.tip_flange = tip + Vec3{0, 0, 1.2};
  const PlanOutcome outcome = plan(request);
  CHECK(!outcome.path.has_value());
  CHECK(outcome.refusal->code == Refused::NotAsTaught);
  STRCMP_CONTAINS("tip as taught", outcome.reason().c_str());
  STRCMP_CONTAINS("1.2", outcome.reason().c_str());
  LONGS_EQUAL(1, outcome.checks.size());
}

TEST(Mounted, AnotherMassOrCentreIsRefused) {
  request.mounted.payload = request.process.tool.payload;
  request.mounted.payload->mass_kg += 0.15;
  STRCMP_EQUAL("not_as_taught", code().c_str());
  request.mounted.payload = request.process.tool.payload;
  request.mounted.payload->centre_flange_mm.x() += 25;
  STRCMP_EQUAL("not_as_taught", code().c_str());
  STRCMP_CONTAINS("centre", plan(request).reason().c_str());
}

TEST(Mounted, AnotherOutputThanTheToolsIsRefused) {
  request.process.digital_output = 1;
  request.mounted.lines = ToolLines{.on_output = 1};
  STRCMP_EQUAL("planned", code().c_str());
  request.mounted.lines->on_output = 2;
  STRCMP_EQUAL("not_as_taught", code().c_str());
  STRCMP_CONTAINS("output 1, its tool was taught with 2", plan(request).reason().c_str());
  request.process.digital_output = -1;
  STRCMP_CONTAINS("no output", plan(request).reason().c_str());
}

/// The changer would turn while the tool works.
TEST(Mounted, AnOutputThatAsksAChangerIsRefused) {
  request.process.digital_output = 5;
  request.mounted.changer =
      Changer{.wanted = {.ask_output = 4, .there_input = 2}, .others = {{.ask_output = 6, .there_input = 3}}};
  STRCMP_EQUAL("planned", code().c_str());
  for (const int output : {4, 6}) {
    request.process.digital_output = output;
    STRCMP_EQUAL("not_as_taught", code().c_str());
    STRCMP_CONTAINS("asks the changer", plan(request).reason().c_str());
  }
}

TEST(Mounted, APersonIsWaitedForOnlyWhereNoChangerBringsTheTool) {
  CHECK(!waits_for_its_tool(request.process, request.mounted));
  request.process.tool.name = "brush";
  CHECK(waits_for_its_tool(request.process, request.mounted));
  request.mounted.changer = Changer{};
  CHECK(!waits_for_its_tool(request.process, request.mounted));
  CHECK(has_its_tool(request.process, request.mounted) == false);
}

TEST(Mounted, ATipThatIsNoNumberNeverPasses) {
  request.mounted.tip_flange = Vec3{0, 0, std::numeric_limits<double>::quiet_NaN()};
  STRCMP_EQUAL("not_as_taught", code().c_str());
  std::feclearexcept(FE_INVALID);  // of comparing with what is no number
}

}  // namespace biteline::path
