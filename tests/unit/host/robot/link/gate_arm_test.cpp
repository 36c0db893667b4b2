// SPDX-License-Identifier: MIT
// What the gate asks of an arm and its controller: which one it is.
#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <limits>

#include "host/robot/link/gate/gate.hpp"
#include "host/robot/link/gate/gate_file.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot {

TEST_GROUP(GateArm) {
  biteline::test::TemporaryFolder folder;
  /// A comparison with NaN raises the flag that the runner looks for; here NaN is meant.
  void teardown() override {
    std::feclearexcept(FE_INVALID);
  }
  static bool opens(const GateInputs& inputs) {
    return open_gate(inputs, test::planned_path("grind.yaml"), test::no_stops().now()).path.has_value();
  }
};

TEST(GateArm, Cb3HasNoRemoteControlAndSaysSo) {
  GateInputs inputs = test::good_inputs();
  inputs.arm.arm = "UR5";
  inputs.arm.told_version = "URSoftware 3.15.4.106291 (Apr 16 2021)";
  inputs.arm.told_remote.reset();
  CHECK(opens(inputs));
  bool said = false;
  for (const GateRow& row : judge(inputs))
    said = said || row.value.find("a CB3 has none") != std::string::npos;
  CHECK(said);
}

/// What their controllers say, as their maker's own client has it.
TEST(GateArm, EachModelIsKnownByWhatItsControllerSays) {
  const struct {
    const char *arm, *told, *version;
    bool opens;
  } k_cases[]{{"UR7e", "UR5", "URSoftware 5.22.0", true},     {"UR12e", "UR10", "URSoftware 5.22.0", true},
              {"UR7e", "UR7e", "PolyScope X 10.11.0", true},  {"UR16e", "UR16", "URSoftware 5.12.0", true},
              {"UR20", "UR20", "PolyScope X 10.11.0", true},  {"UR30", "UR30", "URSoftware 5.22.0", true},
              {"UR30", "UR20", "URSoftware 5.22.0", false},   {"UR20", "UR20", "URSoftware 3.15.4.1", false},
              {"UR12e", "UR10", "URSoftware 3.15.4.1", false}};
  for (const auto& one : k_cases) {
    GateInputs inputs = test::good_inputs();
    inputs.arm.arm = one.arm;
    inputs.arm.told_model = one.told;
    inputs.arm.told_version = one.version;
    CHECK_EQUAL_TEXT(one.opens, opens(inputs), one.arm);
  }
}

/// It knows no remote control and no model of ours: it is sent to where its pose is that of its joints.
TEST(GateArm, ArmByTheGenericProtocolIsHeldAgainstItsPose) {
  constexpr double k_not_a_number = std::numeric_limits<double>::quiet_NaN();
  const auto other = [](double off_mm, double off_rad) {
    GateInputs inputs = test::good_inputs();
    inputs.arm.told_version.reset();
    inputs.arm.told_remote.reset();
    inputs.arm.told_model = "made of another make";
    inputs.arm.pose_off_mm = off_mm;
    inputs.arm.pose_off_rad = off_rad;
    return inputs;
  };
  CHECK(opens(other(0.19, 0.0019)));
  STRCMP_EQUAL("", why_not_ready(other(0.19, 0.0019).arm).c_str());
  for (const auto& [off_mm, off_rad] : {std::pair{0.21, 0.0}, std::pair{0.0, 0.0021},
                                        std::pair{k_not_a_number, 0.0}, std::pair{0.0, k_not_a_number}}) {
    const GateInputs inputs = other(off_mm, off_rad);
    CHECK_FALSE(opens(inputs));
    for (const GateRow& row : judge(inputs))
      CHECK_EQUAL(row.code == Refused::OtherArm, row.state == GateRow::State::Failed);
    STRCMP_CONTAINS("made of another make tells a pose", why_not_ready(inputs.arm).c_str());
  }
  GateInputs inputs = other(0.01, 0.0001);
  inputs.arm.serial = "7";
  inputs.arm.told_serial = "8";
  STRCMP_CONTAINS("serial number 8, not 7", why_not_ready(inputs.arm).c_str());
  CHECK_FALSE(opens(inputs));
  SUCCEEDS(write_gate(folder.path() / "gate.json", inputs));
  const auto read = read_gate(folder.path() / "gate.json");
  SUCCEEDS(read);
  DOUBLES_EQUAL(0.0001, *read->inputs.arm.pose_off_rad, 0);
}

}  // namespace biteline::robot
