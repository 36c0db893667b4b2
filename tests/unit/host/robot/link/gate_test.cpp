// SPDX-License-Identifier: MIT
#include "host/robot/link/gate/gate.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cfenv>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "host/robot/link/gate/gate_file.hpp"
#include "host/robot/link/robot_link.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/refusals.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/host/robot/link/permitted.hpp"
#include "tests/unit/host/robot/link/planned.hpp"

namespace biteline::robot {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

// Nothing but the gate makes what a robot takes.
static_assert(!std::is_default_constructible_v<PermittedPath>);
static_assert(!std::is_constructible_v<PermittedPath, path::CheckedPath>);
static_assert(!std::is_constructible_v<PermittedPath, path::CheckedPath, GateInputs>);
static_assert(!std::is_constructible_v<PermittedPath, path::CheckedPath, GateInputs, StopMark>);
static_assert(!std::is_convertible_v<path::CheckedPath, PermittedPath>);

struct Change {
  const char* name;
  std::function<void(GateInputs&)> make;
  Refused refused;
};

Unmoved look(double age_s) {
  return {.by = Unmoved::By::Look, .age_s = age_s, .shift_mm = 0.02, .u95_mm = 0.04, .limit_mm = 0.15};
}
Unmoved clamped(double age_s) {
  return {.by = Unmoved::By::Clamp, .age_s = age_s};
}

const std::vector<Change>& bad_changes() {
  static const std::vector<Change> k_changes{
      {"recovered", [](GateInputs& in) { in.scan.recovered = true; }, Refused::ScanNotSeen},
      {"of a recording", [](GateInputs& in) { in.scan.from_recording = true; }, Refused::ScanNotSeen},
      {"120.1 s old", [](GateInputs& in) { in.scan.age_s = 120.1; }, Refused::ScanTooOld},
      {"of no known age", [](GateInputs& in) { in.scan.age_s.reset(); }, Refused::ScanTooOld},
      {"of age NaN", [](GateInputs& in) { in.scan.age_s = k_nan; }, Refused::ScanTooOld},
      {"from the future", [](GateInputs& in) { in.scan.age_s = -1; }, Refused::ScanTooOld},
      {"limit NaN", [](GateInputs& in) { in.limits.scan_age_s = k_nan; }, Refused::ScanTooOld},
      {"1800 s old, looked at again 120.1 s ago",
       [](GateInputs& in) { in.scan.age_s = 1800, in.scan.unmoved = look(120.1); }, Refused::ScanTooOld},
      {"1800 s old, looked at again in the future",
       [](GateInputs& in) { in.scan.age_s = 1800, in.scan.unmoved = look(-1); }, Refused::ScanTooOld},
      {"1800 s old, looked at again at NaN",
       [](GateInputs& in) { in.scan.age_s = 1800, in.scan.unmoved = look(k_nan); }, Refused::ScanTooOld},
      {"130 s old, the look before it",
       [](GateInputs& in) { in.scan.age_s = 130, in.limits.scan_age_s = 120, in.scan.unmoved = look(131); },
       Refused::ScanTooOld},
      {"1800 s old, clamped for 1799.9 s",
       [](GateInputs& in) { in.scan.age_s = 1800, in.scan.unmoved = clamped(1799.9); }, Refused::ScanTooOld},
      {"1800 s old, clamped for NaN",
       [](GateInputs& in) { in.scan.age_s = 1800, in.scan.unmoved = clamped(k_nan); }, Refused::ScanTooOld},
      {"of no known age, clamped",
       [](GateInputs& in) { in.scan.age_s.reset(), in.scan.unmoved = clamped(1e6); }, Refused::ScanTooOld},
      {"from the future, clamped", [](GateInputs& in) { in.scan.age_s = -1, in.scan.unmoved = clamped(1e6); },
       Refused::ScanTooOld},
      {"nudged", [](GateInputs& in) { in.scan.unmoved = look(4), in.scan.unmoved->shift_mm = 0.3; },
       Refused::ShoeMoved},
      {"nudged by chance", [](GateInputs& in) { in.scan.unmoved = look(4), in.scan.unmoved->u95_mm = 0.14; },
       Refused::ShoeMoved},
      {"nudged, the look is old",
       [](GateInputs& in) { in.scan.unmoved = look(400), in.scan.unmoved->shift_mm = 0.3; },
       Refused::ShoeMoved},
      {"moved by NaN", [](GateInputs& in) { in.scan.unmoved = look(4), in.scan.unmoved->shift_mm = k_nan; },
       Refused::ShoeMoved},
      {"moved with U95 NaN",
       [](GateInputs& in) { in.scan.unmoved = look(4), in.scan.unmoved->u95_mm = k_nan; },
       Refused::ShoeMoved},
      {"another shoe", [](GateInputs& in) { in.scan.unmoved = look(4), in.scan.unmoved->same_shoe = false; },
       Refused::OtherShoe},
      {"two connections", [](GateInputs& in) { in.scan.one_connection = false; }, Refused::OtherConnection},
      {"no scan", [](GateInputs& in) { in.scan.scan_id = 0; }, Refused::OtherConnection},
      {"nobody vouches for its pictures", [](GateInputs& in) { in.scan.pictures_vouched = false; },
       Refused::PicturesNotVouched},
      {"sent before", [](GateInputs& in) { in.scan.sent_before = true; }, Refused::SentBefore},
      {"stopped since", [](GateInputs& in) { in.scan.stopped = true; }, Refused::Stopped},
      {"stopped since, scan confirmed",
       [](GateInputs& in) {
         in.scan.stopped = true, in.scan.confirmed = Word{"a", "b"};
       },
       Refused::Stopped},
      {"message lost", [](GateInputs& in) { in.scan.messages_lost = 1; }, Refused::MessagesLost},
      {"3 frames lost", [](GateInputs& in) { in.scan.lost.frames = 3; }, Refused::HolesInScan},
      {"3 profiles lost", [](GateInputs& in) { in.scan.lost.profiles = 3; }, Refused::HolesInScan},
      {"3 edges lost", [](GateInputs& in) { in.scan.lost.edges = 3; }, Refused::HolesInScan},
      {"most edges lost", [](GateInputs& in) { in.scan.lost.edges = ~std::uint64_t{0}; },
       Refused::HolesInScan},
      {"limit below 0", [](GateInputs& in) { in.limits.lost_in_a_row = -1; }, Refused::HolesInScan},
      {"line not passed", [](GateInputs& in) { in.result.line_passed = false; }, Refused::LineNotPassed},
      {"path not passed", [](GateInputs& in) { in.result.path_passed = false; }, Refused::PathNotPassed},
      {"too uncertain", [](GateInputs& in) { in.limits.tolerance_mm = 0.3, in.result.u95_mm = 0.31; },
       Refused::TooUncertain},
      {"U95 NaN", [](GateInputs& in) { in.limits.tolerance_mm = 0.3, in.result.u95_mm = k_nan; },
       Refused::TooUncertain},
      {"U95 not known", [](GateInputs& in) { in.limits.tolerance_mm = 0.3, in.result.u95_mm.reset(); },
       Refused::TooUncertain},
      {"tip too far off",
       [](GateInputs& in) { in.limits.tip_tolerance_mm = 0.5, in.result.tip_bound_mm = 0.51; },
       Refused::TipTooFar},
      {"tip's bound NaN",
       [](GateInputs& in) { in.limits.tip_tolerance_mm = 0.5, in.result.tip_bound_mm = k_nan; },
       Refused::TipTooFar},
      {"tip's bound not known", [](GateInputs& in) { in.limits.tip_tolerance_mm = 0.5; }, Refused::TipTooFar},
      {"approval refused", [](GateInputs& in) { in.result.approved = false; }, Refused::NotApproved},
      {"approval refused, scan confirmed",
       [](GateInputs& in) {
         in.result.approved = false, in.scan.confirmed = Word{"a", "b"};
       },
       Refused::NotApproved},
      {"approval asked for, by itself above a limit",
       [](GateInputs& in) { in.limits.approval = true, in.limits.automatic_above = 0.9; },
       Refused::NotApproved},
      {"approval asked for", [](GateInputs& in) { in.limits.approval = true; }, Refused::NotApproved},
      {"moved by 0.3 degrees", [](GateInputs& in) { in.arm.q_now_rad[3] += 0.0053; }, Refused::ArmMoved},
      {"joint NaN", [](GateInputs& in) { in.arm.q_now_rad[5] = k_nan; }, Refused::ArmMoved},
      {"checked from NaN", [](GateInputs& in) { in.arm.q_checked_rad[0] = k_nan; }, Refused::ArmMoved},
      {"local control", [](GateInputs& in) { in.arm.told_remote = false; }, Refused::NotRemote},
      {"remote control not told", [](GateInputs& in) { in.arm.told_remote.reset(); }, Refused::NotRemote},
      {"silent controller",
       [](GateInputs& in) {
         in.arm.told_remote.reset(), in.arm.told_version.reset(), in.arm.told_model.reset();
       },
       Refused::NotRemote},
      {"a UR10", [](GateInputs& in) { in.arm.told_model = "UR10"; }, Refused::OtherArm},
      {"a UR5 of the CB3", [](GateInputs& in) { in.arm.told_version = "URSoftware 3.15.4.1"; },
       Refused::OtherArm},
      {"an e-Series where a CB3 is told", [](GateInputs& in) { in.arm.arm = "UR5"; }, Refused::OtherArm},
      {"a PolyScope X that does not tell remote control",
       [](GateInputs& in) {
         in.arm.told_version = "PolyScope X 10.11.0";
         in.arm.told_remote.reset(), in.arm.told_model.reset();
       },
       Refused::NotRemote},
      {"a PolyScope X where a CB3 is told",
       [](GateInputs& in) { in.arm.arm = "UR5", in.arm.told_version = "PolyScope X 10.14.0"; },
       Refused::OtherArm},
      {"other serial", [](GateInputs& in) { in.arm.serial = "2021", in.arm.told_serial = "2022"; },
       Refused::OtherSerial},
      {"serial not told", [](GateInputs& in) { in.arm.serial = "2021"; }, Refused::OtherSerial},
      {"other tool", [](GateInputs& in) { in.result.tool_off_mm = 5; }, Refused::OtherTool},
      {"tool turned", [](GateInputs& in) { in.result.tool_off_rad = 0.1; }, Refused::OtherTool},
      {"tool NaN", [](GateInputs& in) { in.result.tool_off_mm = k_nan; }, Refused::OtherTool},
      {"other payload", [](GateInputs& in) { in.result.same_payload = false; }, Refused::OtherPayload},
      {"another tool than the process names",
       [](GateInputs& in) { in.result.tool = "brush", in.result.mounted_tool = "gun"; },
       Refused::ToolNotMounted},
      {"a tool that nobody has mounted", [](GateInputs& in) { in.result.tool = "brush"; },
       Refused::ToolNotMounted},
      {"another tip than taught", [](GateInputs& in) { in.result.tip_from_taught_mm = 1.01; },
       Refused::NotAsTaught},
      {"tip NaN", [](GateInputs& in) { in.result.tip_from_taught_mm = k_nan; }, Refused::NotAsTaught},
      {"another payload than taught", [](GateInputs& in) { in.result.payload_as_taught = false; },
       Refused::NotAsTaught},
      {"table taught anew", [](GateInputs& in) { in.result.table_from_taught_mm = 0.2; },
       Refused::NotAsTaught},
      {"another line", [](GateInputs& in) { in.files.line = {.written = "ab", .now = "cd"}; },
       Refused::FilesChanged},
      {"no line any more", [](GateInputs& in) { in.files.line = {.written = "ab", .now = ""}; },
       Refused::FilesChanged},
      {"a line that cannot be read", [](GateInputs& in) { in.files.line.written = "ab"; },
       Refused::FilesChanged},
      {"another cloud", [](GateInputs& in) { in.files.cloud = {.written = "ab", .now = "cd"}; },
       Refused::FilesChanged},
      {"another report", [](GateInputs& in) { in.files.report = {.written = "ab", .now = "cd"}; },
       Refused::FilesChanged},
      {"another process", [](GateInputs& in) { in.files.process = {.written = "ab", .now = "cd"}; },
       Refused::FilesChanged},
      {"another line, scan confirmed",
       [](GateInputs& in) {
         in.files.line = {.written = "ab", .now = "cd"}, in.scan.confirmed = Word{"a", "b"};
       },
       Refused::FilesChanged},
      {"arm not held", [](GateInputs& in) { in.arm.held = false; }, Refused::ArmNotHeld}};
  return k_changes;
}

}  // namespace

TEST_GROUP(Gate) {
  biteline::test::TemporaryFolder folder;
  std::filesystem::path file() const {
    return folder.path() / "gate.json";
  }
  /// A comparison with NaN raises the flag that the runner looks for; here NaN is meant.
  void teardown() override {
    std::feclearexcept(FE_INVALID);
  }
  static bool opens(const GateInputs& inputs) {
    return open_gate(inputs, test::planned_path("grind.yaml"), test::no_stops().now()).path.has_value();
  }
};

TEST(Gate, EveryCodeHasItsRow) {
  biteline::test::check_refusal_table(Refused::ArmNotHeld);
}

TEST(Gate, FilesThatAreAsTheyWereWrittenPassAndStandInTheTable) {
  GateInputs inputs = test::good_inputs();
  const std::size_t rows = judge(inputs).size();
  const FileFacts same{.written = "0123456789abcdef", .now = "0123456789abcdef"};
  inputs.files = {.line = same, .cloud = same, .report = same, .process = same};
  CHECK(opens(inputs));
  LONGS_EQUAL(rows + 4, judge(inputs).size());
  SUCCEEDS(write_gate(file(), inputs));
  const auto read = read_gate(file());
  SUCCEEDS(read);
  STRCMP_EQUAL("0123456789abcdef", read->inputs.files.process.now->c_str());
}

/// Nobody shall go and mend what nobody has looked at, and nothing is sent that nobody has looked at.
TEST(Gate, RowsOfAnArmThatWasNotAskedAreNotFailedAndLetNothingThrough) {
  GateInputs inputs = test::good_inputs();
  inputs.arm.asked = true;
  CHECK(opens(inputs));
  inputs.arm.asked = false;
  CHECK_FALSE(opens(inputs));
  inputs.scan.age_s = 500;
  inputs.arm.told_remote.reset();
  inputs.result.path_passed = false;
  int failed = 0, not_looked_at = 0;
  for (const GateRow& row : judge(inputs)) {
    failed += row.state == GateRow::State::Failed ? 1 : 0;
    not_looked_at += row.state == GateRow::State::NotLookedAt ? 1 : 0;
    if (row.state == GateRow::State::Failed) CHECK(row.code == Refused::ScanTooOld);
  }
  LONGS_EQUAL(1, failed);
  LONGS_EQUAL(5, not_looked_at);
  CHECK(failures(judge(inputs)).find("remote") == std::string::npos);
  SUCCEEDS(write_gate(file(), inputs));
  const auto read = read_gate(file());
  SUCCEEDS(read);
  CHECK(read->inputs.arm.asked == false);
}

TEST(Gate, OpensWhenEverythingHolds) {
  CHECK(opens(test::good_inputs()));
}

TEST(Gate, EachFaultAloneClosesItForItsOwnReason) {
  for (const Change& change : bad_changes()) {
    GateInputs inputs = test::good_inputs();
    change.make(inputs);
    CHECK_TEXT(!opens(inputs), change.name);
    int failed = 0;
    for (const GateRow& row : judge(inputs)) {
      if (row.state != GateRow::State::Failed) continue;
      ++failed;
      STRCMP_EQUAL_TEXT(report::refusal_row(change.refused).name, report::refusal_row(row.code).name,
                        change.name);
    }
    CHECK_EQUAL_TEXT(1, failed, change.name);
    CHECK_TEXT(!failures(judge(inputs)).empty(), change.name);
  }
}

TEST(Gate, EveryReasonIsReachable) {
  for (int code = 0; code <= static_cast<int>(Refused::ArmNotHeld); ++code) {
    const bool reached = std::ranges::any_of(
        bad_changes(), [&](const Change& change) { return static_cast<int>(change.refused) == code; });
    CHECK_TEXT(reached, report::refusal_row(static_cast<Refused>(code)).name);
  }
}

TEST(Gate, PersonVouchesForARecoveredScanAndForNothingElse) {
  GateInputs inputs = test::good_inputs();
  inputs.scan.recovered = true;
  inputs.scan.age_s.reset();
  inputs.scan.one_connection = false;
  CHECK(!opens(inputs));
  inputs.scan.confirmed = Word{.by = "maria", .at = "2026-01-02T03:04:05Z"};
  CHECK(opens(inputs));
  for (const Change& change : bad_changes()) {
    const bool about_the_scan =
        change.refused == Refused::ScanNotSeen || change.refused == Refused::ScanTooOld ||
        change.refused == Refused::OtherConnection || change.refused == Refused::PicturesNotVouched;
    const std::string name = change.name;
    const bool vouched = about_the_scan || name.starts_with("approval asked for") ||
                         name == "U95 not known" || name == "tip's bound not known";
    GateInputs worse = inputs;
    change.make(worse);
    CHECK_EQUAL_TEXT(vouched, opens(worse), change.name);
  }
}

/// Every age with every kind of evidence.
TEST(Gate, AHeldScanStaysFreshByEvidence) {
  struct Shown {
    const char* name;
    std::optional<Unmoved> unmoved;
    bool for_old, for_unknown;
  };
  Unmoved nudged = look(4), other = look(4);
  nudged.shift_mm = 0.3;
  other.same_shoe = false;
  const Shown all[]{{"nothing", std::nullopt, false, false},
                    {"look", look(4), true, true},
                    {"look at the limit", look(120), true, true},
                    {"old look", look(121), false, false},
                    {"clamp", clamped(1800), true, false},
                    {"clamp closed later", clamped(1700), false, false},
                    {"nudged", nudged, false, false},
                    {"other shoe", other, false, false}};
  for (const Shown& shown : all) {
    GateInputs inputs = test::good_inputs();
    inputs.scan.unmoved = shown.unmoved;
    const bool told = shown.unmoved && (shown.unmoved->shift_mm > 0.1 || !shown.unmoved->same_shoe);
    inputs.scan.age_s = 120;
    CHECK_EQUAL_TEXT(!told, opens(inputs), shown.name);
    inputs.scan.age_s = 1800;
    CHECK_EQUAL_TEXT(shown.for_old, opens(inputs), shown.name);
    inputs.scan.age_s.reset();
    CHECK_EQUAL_TEXT(shown.for_unknown, opens(inputs), shown.name);
    inputs.scan.confirmed = Word{.by = "maria", .at = "2026-01-02T03:04:05Z"};
    CHECK_EQUAL_TEXT(!told, opens(inputs), shown.name);
  }
}

/// After half an hour both rows fail, and a person must hear that the shoe was moved.
TEST(Gate, WhatALookHasSeenIsTheReasonAndNotTheAge) {
  GateInputs inputs = test::good_inputs();
  inputs.scan.age_s = 1800;
  inputs.scan.unmoved = look(4);
  const auto first_failed = [&] {
    const std::vector<GateRow> rows = judge(inputs);
    return std::ranges::find(rows, GateRow::State::Failed, &GateRow::state)->code;
  };
  inputs.scan.unmoved->shift_mm = 0.3;
  CHECK(Refused::ShoeMoved == first_failed());
  inputs.scan.unmoved->same_shoe = false;
  CHECK(Refused::OtherShoe == first_failed());
}

TEST(Gate, TheRowOfTheAgeSaysByWhatTheScanIsFresh) {
  GateInputs inputs = test::good_inputs();
  inputs.scan.age_s = 1800;
  const auto age_value = [&] {
    const std::vector<GateRow> rows = judge(inputs);
    return std::ranges::find(rows, Refused::ScanTooOld, &GateRow::code)->value;
  };
  STRCMP_EQUAL("1800.0 s", age_value().c_str());
  inputs.scan.unmoved = look(4);
  STRCMP_EQUAL("1800.0 s, but looked at again 4.0 s ago: moved 0.02 mm, U95 0.04 mm", age_value().c_str());
  inputs.scan.unmoved = clamped(1805);
  STRCMP_EQUAL("1800.0 s, but clamped for 1805.0 s", age_value().c_str());
}

TEST(Gate, EvidenceIsKeptInTheFileAndReadStrictly) {
  for (const Unmoved& shown : {look(4), clamped(2000)}) {
    GateInputs inputs = test::good_inputs();
    inputs.scan.age_s = 1800;
    inputs.scan.unmoved = shown;
    SUCCEEDS(write_gate(file(), inputs));
    const auto read = read_gate(file());
    SUCCEEDS(read);
    CHECK(read->permitted);
    CHECK(read->inputs.scan.unmoved->by == shown.by);
    DOUBLES_EQUAL(shown.age_s, read->inputs.scan.unmoved->age_s, 0);
    DOUBLES_EQUAL(shown.u95_mm, read->inputs.scan.unmoved->u95_mm, 0);
    std::ifstream stream{file()};
    const nlohmann::ordered_json json = biteline::test::read_ordered_json(stream);
    for (const auto& [name, value] : json["inputs"]["scan"]["unmoved"].items()) {
      nlohmann::ordered_json changed = json;
      changed["inputs"]["scan"]["unmoved"].erase(name);
      folder.write("gate.json", biteline::test::text_of(changed));
      CHECK_TEXT(!read_gate(file()).has_value(), name.c_str());
      changed = json;
      changed["inputs"]["scan"]["unmoved"][name] = "hearsay";
      folder.write("gate.json", biteline::test::text_of(changed));
      CHECK_TEXT(!read_gate(file()).has_value(), name.c_str());
    }
  }
}

TEST(Gate, UncertaintyAndApprovalAreNotKnownAndNotInTheWayUntilAskedFor) {
  int not_known = 0;
  for (const GateRow& row : judge(test::good_inputs())) {
    if (row.code == Refused::TooUncertain || row.code == Refused::NotApproved)
      not_known += row.state == GateRow::State::NotKnown ? 1 : 0;
  }
  LONGS_EQUAL(2, not_known);
}

TEST(Gate, PermissionEndsWhereTheArmMoves) {
  kinematics::Joints q_rad = kinematics::Joints::Constant(0.5);
  const PermittedPath sut = test::permitted(test::planned_path("grind.yaml"), q_rad);
  CHECK(sut.holds_for(q_rad));
  q_rad[2] += 0.0034;
  CHECK(sut.holds_for(q_rad));
  q_rad[2] += 0.0002;
  CHECK(!sut.holds_for(q_rad));
  CHECK(!sut.holds_for(kinematics::Joints::Constant(k_nan)));
}

TEST(Gate, DecisionIsReadBackFromItsInputs) {
  for (const Change& change : bad_changes()) {
    GateInputs inputs = test::good_inputs(kinematics::Joints::Constant(0.1));
    change.make(inputs);
    SUCCEEDS(write_gate(file(), inputs));
    const auto read = read_gate(file());
    // NaN has no place in the file: such a decision cannot be made again, and is refused.
    if (!read) continue;
    CHECK_TEXT(!read->permitted, change.name);
    CHECK_EQUAL_TEXT(failures(judge(inputs)), failures(judge(read->inputs)), change.name);
  }
  GateInputs good = test::good_inputs(kinematics::Joints::Constant(0.1));
  good.scan.confirmed = Word{.by = "maria", .at = "2026-01-02T03:04:05Z"};
  SUCCEEDS(write_gate(file(), good));
  const auto read = read_gate(file());
  SUCCEEDS(read);
  CHECK(read->permitted);
  STRCMP_EQUAL("maria", read->inputs.scan.confirmed->by.c_str());
  CHECK(read->inputs.arm.q_now_rad == good.arm.q_now_rad);
}

TEST(Gate, FileThatSaysOtherThanItsInputsIsRefused) {
  GateInputs inputs = test::good_inputs();
  inputs.scan.messages_lost = 4;
  SUCCEEDS(write_gate(file(), inputs));
  std::ifstream stream{file()};
  nlohmann::ordered_json json = biteline::test::read_ordered_json(stream);
  const auto write = [&](const nlohmann::ordered_json& changed) {
    folder.write("gate.json", biteline::test::text_of(changed));
  };

  nlohmann::ordered_json permitted = json;
  permitted["permitted"] = true;
  write(permitted);
  FAILS_NAMING(Errc::BadValue, "not what its inputs give", read_gate(file()));
  nlohmann::ordered_json milder = json;
  milder["inputs"]["scan"]["messages_lost"] = 0;
  write(milder);
  FAILS_NAMING(Errc::BadValue, "not what its inputs give", read_gate(file()));
  nlohmann::ordered_json row = json;
  row["rows"].erase(4);
  write(row);
  FAILS_NAMING(Errc::BadValue, "not what its inputs give", read_gate(file()));
}

TEST(Gate, EveryInputMustBeInTheFileAndOfItsType) {
  SUCCEEDS(write_gate(file(), test::good_inputs()));
  std::ifstream stream{file()};
  const nlohmann::ordered_json json = biteline::test::read_ordered_json(stream);
  int inputs = 0;
  for (const auto& [part, facts] : json["inputs"].items()) {
    for (const auto& [name, value] : facts.items()) {
      if (name == "confirmed") continue;  // absent is as good as nobody's word
      for (const nlohmann::ordered_json& other :
           {nlohmann::ordered_json{}, nlohmann::ordered_json::array({"x"})}) {
        nlohmann::ordered_json changed = json;
        if (other.is_null()) {
          changed["inputs"][part].erase(name);
        } else {
          changed["inputs"][part][name] = other;
        }
        folder.write("gate.json", biteline::test::text_of(changed));
        CHECK_TEXT(!read_gate(file()).has_value(), (part + "." + name).c_str());
      }
      ++inputs;
    }
  }
  CHECK(inputs >= 33);
}

TEST(Gate, RubbishIsNoGate) {
  for (const char* text :
       {"", "{", "[]", "null", "{\"schema\": \"biteline gate 1\"}", "{\"schema\": 1}",
        "{\"schema\": \"biteline gate 1\", \"permitted\": true, \"inputs\": []}",
        "{\"schema\": \"biteline gate 1\", \"permitted\": true, \"inputs\": {\"scan\": 7}}"}) {
    folder.write("gate.json", text);
    CHECK_TEXT(!read_gate(file()).has_value(), text);
  }
  CHECK(read_gate(folder.path() / "none.json").error().code == Errc::FileNotFound);
}

}  // namespace biteline::robot
