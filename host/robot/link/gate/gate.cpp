// SPDX-License-Identifier: MIT
#include "host/robot/link/gate/gate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/core/fixed_text.hpp"
#include "host/robot/kinematics/arm_model.hpp"
#include "host/robot/path/mounted.hpp"

namespace biteline::robot {
namespace {

using State = GateRow::State;

constexpr double k_deg_per_rad = 180 / std::numbers::pi;
// The path's tool is the process's, or the plan was made for another one; less is rounding.
constexpr double k_tool_mm = 0.01, k_tool_rad = 1e-4;
// A table taught anew to the same height: paths keep ten times as much above it.
constexpr double k_table_mm = 0.1;

template <class... Values>
std::string text(const char* pattern, Values... values) {
  return std::string{FixedText<200>::format(pattern, values...).view()};
}

State when(bool good) {
  return good ? State::Passed : State::Failed;
}

/// A look must be as young as a scan would have to be, the clamp must have held since before the scan's end.
bool shows_unmoved(const ScanFacts& scan, double limit_s) {
  if (!scan.unmoved) return false;
  const Unmoved& shown = *scan.unmoved;
  if (shown.by == Unmoved::By::Clamp) return scan.age_s && *scan.age_s >= 0 && shown.age_s >= *scan.age_s;
  const bool after_the_scan = !scan.age_s || shown.age_s <= *scan.age_s;
  return shown.age_s >= 0 && shown.age_s <= limit_s && after_the_scan && stands_as_scanned(shown);
}

std::string what_the_look_shows(const Unmoved& look) {
  if (!look.same_shoe) return "another shoe";
  return text("moved %.2f mm, U95 %.2f mm", look.shift_mm, look.u95_mm);
}

std::string as_words(const Unmoved& shown) {
  if (shown.by == Unmoved::By::Clamp) return text(", but clamped for %.1f s", shown.age_s);
  return text(", but looked at again %.1f s ago: ", shown.age_s) + what_the_look_shows(shown);
}

/// Nobody sees by eye what a look has measured: a person's word does not pass this row.
GateRow row_of_look(const Unmoved& look) {
  return {look.same_shoe ? Refused::ShoeMoved : Refused::OtherShoe, "shoe since its scan",
          what_the_look_shows(look), text("the same, %.2f mm with its U95", look.limit_mm),
          when(stands_as_scanned(look))};
}

/// Without a look or a clamp the row of the age reads as in older files.
void add_age_rows(const GateInputs& inputs, std::vector<GateRow>& rows) {
  const ScanFacts& scan = inputs.scan;
  const double limit_s = inputs.limits.scan_age_s;
  const bool fresh = scan.age_s && *scan.age_s >= 0 && *scan.age_s <= limit_s;
  // A recovered scan has no age that this process could know; its person vouches for the shoe's place.
  const bool vouched = scan.confirmed.has_value();
  // What was seen is the reason, and not the age: it stands first.
  if (scan.unmoved && scan.unmoved->by == Unmoved::By::Look) rows.push_back(row_of_look(*scan.unmoved));
  rows.push_back({Refused::ScanTooOld, "scan's age",
                  (scan.age_s ? text("%.1f s", *scan.age_s) : "not known") +
                      (scan.unmoved ? as_words(*scan.unmoved) : ""),
                  text("%.0f s%s, or confirmed by a person", limit_s,
                       scan.unmoved ? ", or of a look that shows it unmoved, or clamped since" : ""),
                  when(fresh || vouched || shows_unmoved(scan, limit_s))});
}

void add_scan_rows(const GateInputs& inputs, std::vector<GateRow>& rows) {
  const ScanFacts& scan = inputs.scan;
  const bool seen = !scan.recovered && !scan.from_recording;
  const bool vouched = scan.confirmed.has_value();
  const std::string words =
      vouched ? text(", confirmed by %.60s at %.40s", scan.confirmed->by.c_str(), scan.confirmed->at.c_str())
              : "";
  rows.push_back({Refused::ScanNotSeen, "scan seen coming in",
                  (scan.recovered        ? "recovered"
                   : scan.from_recording ? "of a recording"
                                         : "live") +
                      words,
                  "live, or confirmed by a person", when(seen || vouched)});
  add_age_rows(inputs, rows);
  rows.push_back({Refused::OtherConnection, "connection to the sensor",
                  scan.one_connection ? "one" : "broken or renewed", "one, or confirmed by a person",
                  when((scan.one_connection && scan.scan_id != 0) || vouched)});
  // A turned or moved picture gives a sure line beside the shoe, and nobody sees that it lies there.
  if (scan.pictures_vouched)
    rows.push_back({Refused::PicturesNotVouched, "pictures as calibrated",
                    *scan.pictures_vouched ? "vouched for" : "nobody vouches" + words,
                    "by the camera's state or a check lap, or confirmed by a person",
                    when(*scan.pictures_vouched || vouched)});
  rows.push_back(
      {Refused::SentBefore, "sent before", scan.sent_before ? "yes" : "no", "no", when(!scan.sent_before)});
  if (scan.stopped)
    rows.push_back({Refused::Stopped, "stopped since the scan was ordered", *scan.stopped ? "yes" : "no",
                    "no", when(!*scan.stopped)});
  rows.push_back({Refused::MessagesLost, "messages lost",
                  text("%llu", static_cast<unsigned long long>(scan.messages_lost)), "0",
                  when(scan.messages_lost == 0)});
  const std::uint64_t worst = std::max({scan.lost.frames, scan.lost.profiles, scan.lost.edges});
  rows.push_back(
      {Refused::HolesInScan, "lost in a row",
       text("%llu frames, %llu profiles, %llu edges", static_cast<unsigned long long>(scan.lost.frames),
            static_cast<unsigned long long>(scan.lost.profiles),
            static_cast<unsigned long long>(scan.lost.edges)),
       text("%d", inputs.limits.lost_in_a_row),
       when(inputs.limits.lost_in_a_row >= 0 &&
            worst <= static_cast<std::uint64_t>(inputs.limits.lost_in_a_row))});
}

/// Older files know nothing of it.
void add_tip_row(const GateInputs& inputs, std::vector<GateRow>& rows) {
  const std::optional<double>&bound_mm = inputs.result.tip_bound_mm,
        &most_mm = inputs.limits.tip_tolerance_mm;
  if (!bound_mm && !most_mm) return;
  const bool near = bound_mm && (!most_mm || (*bound_mm >= 0 && *bound_mm <= *most_mm));
  const State unknown = inputs.scan.confirmed ? State::NotKnown : State::Failed;
  rows.push_back({Refused::TipTooFar, "tool's tip off the line",
                  bound_mm ? text("%.2f mm at most, in 95 of 100 shoes", *bound_mm) : "not known",
                  most_mm ? text("%.2f mm; not known: confirmed by a person", *most_mm) : "none asked for",
                  bound_mm ? when(near) : unknown});
}

void add_result_rows(const GateInputs& inputs, std::vector<GateRow>& rows) {
  const ResultFacts& result = inputs.result;
  const auto yes = [](bool value) { return value ? "passed" : "not passed"; };
  rows.push_back(
      {Refused::LineNotPassed, "line's checks", yes(result.line_passed), "passed", when(result.line_passed)});
  rows.push_back({Refused::PathNotPassed, "path's checks",
                  text("%s, way there %.1f mm clear", yes(result.path_passed), result.way_clearance_mm),
                  "passed", when(result.path_passed)});
  const std::optional<double>& tolerance_mm = inputs.limits.tolerance_mm;
  const bool certain =
      result.u95_mm && (!tolerance_mm || (*result.u95_mm >= 0 && *result.u95_mm <= *tolerance_mm));
  // A line that does not tell its uncertainty is sent only where the process asks for none, or a person
  // vouches.
  const State unknown = tolerance_mm && !inputs.scan.confirmed ? State::Failed : State::NotKnown;
  rows.push_back(
      {Refused::TooUncertain, "uncertainty (U95) along the path",
       result.u95_mm ? text("%.2f mm at most", *result.u95_mm) : "not known",
       tolerance_mm ? text("%.2f mm; not known: confirmed by a person", *tolerance_mm) : "none asked for",
       result.u95_mm ? when(certain) : unknown});
  add_tip_row(inputs, rows);
  // Who confirms a scan by name has looked at it.
  std::optional<bool> approved = result.approved;
  if (!approved && inputs.scan.confirmed) approved = true;
  const std::string words = result.approved_by ? text(", %.120s", result.approved_by->c_str()) : "";
  rows.push_back({Refused::NotApproved, "approval",
                  approved ? (*approved ? "given" : "refused") + words : "not known",
                  !inputs.limits.approval ? "not asked for"
                  : inputs.limits.automatic_above
                      ? text("a person's, or confidence from %.3f", *inputs.limits.automatic_above)
                      : "a person's, asked for by the process",
                  approved                 ? when(*approved)
                  : inputs.limits.approval ? State::Failed
                                           : State::NotKnown});
  rows.push_back({Refused::OtherTool, "path's tool from the process's",
                  text("%.3f mm, %.3f degrees", result.tool_off_mm, result.tool_off_rad * k_deg_per_rad),
                  text("%.3f mm, %.3f degrees", k_tool_mm, k_tool_rad * k_deg_per_rad),
                  when(result.tool_off_mm <= k_tool_mm && result.tool_off_rad <= k_tool_rad)});
  rows.push_back({Refused::OtherPayload, "path's payload",
                  !result.same_payload   ? "none told: the controller's own setting counts"
                  : *result.same_payload ? "the process's, or the taught one"
                                         : "another",
                  "the process's, else the taught one",
                  result.same_payload ? when(*result.same_payload) : State::NotKnown});
}

/// A row for each file that is compared.
void add_file_rows(const FilesFacts& files, std::vector<GateRow>& rows) {
  const auto brief = [](const std::string& sha256) { return sha256.empty() ? "none" : sha256.substr(0, 12); };
  const auto add = [&](const char* name, const char* file, const FileFacts& facts) {
    if (!facts.written) return;
    const bool same = facts.now == facts.written;
    const std::string now = brief(facts.now.value_or(""));
    rows.push_back({Refused::FilesChanged, name,
                    same ? now : std::string{file} + " was changed since the service took it: " + now,
                    "SHA-256 " + brief(*facts.written), when(same)});
  };
  add("line as written", "line.csv", files.line);
  add("cloud as written", "cloud.ply", files.cloud);
  add("report as written", "report.json", files.report);
  add("process as planned with", "the process file", files.process);
}

/// A row for each part that was taught: without teaching the gate is as it was.
void add_taught_rows(const ResultFacts& result, std::vector<GateRow>& rows) {
  const auto add_mm = [&](const char* name, const std::optional<double>& off_mm, double most_mm) {
    if (!off_mm) return;
    rows.push_back({Refused::NotAsTaught, name, text("%.2f mm", *off_mm), text("%.2f mm", most_mm),
                    when(*off_mm <= most_mm)});
  };
  if (result.tool)
    rows.push_back({Refused::ToolNotMounted, "tool that is mounted",
                    result.mounted_tool.value_or("nobody has said") +
                        (result.changer_trouble ? "; " + *result.changer_trouble : ""),
                    *result.tool, when(result.mounted_tool == result.tool)});
  add_mm("process's tip from the taught one", result.tip_from_taught_mm, path::k_taught_tip_mm);
  if (result.payload_as_taught)
    rows.push_back({Refused::NotAsTaught, "process's payload",
                    *result.payload_as_taught ? "the taught one" : "another", "the taught one",
                    when(*result.payload_as_taught)});
  if (result.output_as_taught)
    rows.push_back({Refused::NotAsTaught, "process's output",
                    *result.output_as_taught ? "its tool's" : "another", "that of its tool, as taught",
                    when(*result.output_as_taught)});
  add_mm("path's table from the taught one", result.table_from_taught_mm, k_table_mm);
}

/// e-Series arms have a remote control to switch on; the CB3 before it took programs at any time.
bool is_cb3(const std::string& version) {
  return version.find("URSoftware 3.") != std::string::npos ||
         version.find("URSoftware 1.") != std::string::npos;
}

/// "UR5" is what the controller of a UR5e says, too: the software's generation tells them apart.
bool is_arm(const ArmFacts& arm, const std::string& told) {
  const Result<kinematics::ArmModel> model = kinematics::arm_model(arm.arm);
  return model && model->controller.cb3 == is_cb3(*arm.told_version) && kinematics::is_told_as(*model, told);
}

bool by_generic_protocol(const ArmFacts& arm) {
  return arm.pose_off_mm && arm.pose_off_rad;
}

/// Beyond any number is no number.
bool poses_agree(const ArmFacts& arm) {
  return *arm.pose_off_mm <= k_pose_off_mm && *arm.pose_off_rad <= k_pose_off_rad;
}

/// What an arm of another make is asked: whether it is built as the one that the path was planned for.
void add_other_makes_rows(const ArmFacts& arm, std::vector<GateRow>& rows) {
  rows.push_back(
      {Refused::NotRemote, "remote control", "the arm's protocol does not tell", "on", State::NotKnown});
  rows.push_back({Refused::OtherArm, "arm",
                  text("%.60s, its pose %.2f mm and %.3f degrees from that of its joints",
                       arm.told_model.value_or("not known").c_str(), *arm.pose_off_mm,
                       *arm.pose_off_rad * k_deg_per_rad),
                  text("as a %.40s, within %.2f mm and %.3f degrees", arm.arm.c_str(), k_pose_off_mm,
                       k_pose_off_rad * k_deg_per_rad),
                  when(poses_agree(arm))});
}

void add_ur_rows(const ArmFacts& arm, std::vector<GateRow>& rows) {
  const bool cb3 = arm.told_version && is_cb3(*arm.told_version);
  rows.push_back({Refused::NotRemote, "remote control",
                  cb3               ? "a CB3 has none: anybody may send"
                  : arm.told_remote ? (*arm.told_remote ? "on" : "off")
                                    : "not known",
                  "on", when(cb3 || arm.told_remote.value_or(false))});
  // Controllers before 3.12 and 5.6 do not tell their model.
  const bool knows_model = arm.told_model && arm.told_version;
  rows.push_back(
      {Refused::OtherArm, "arm",
       knows_model ? text("%.60s, %.60s", arm.told_model->c_str(), arm.told_version->c_str()) : "not known",
       arm.arm, knows_model ? when(is_arm(arm, *arm.told_model)) : State::NotKnown});
}

void add_arm_rows(const GateInputs& inputs, std::vector<GateRow>& rows) {
  const ArmFacts& arm = inputs.arm;
  const double moved_rad = (arm.q_now_rad - arm.q_checked_rad).cwiseAbs().maxCoeff();
  const bool finite = arm.q_now_rad.allFinite() && arm.q_checked_rad.allFinite();
  rows.push_back({Refused::ArmMoved, "arm since the check", text("%.3f degrees", moved_rad * k_deg_per_rad),
                  text("%.3f degrees", inputs.limits.start_rad * k_deg_per_rad),
                  when(finite && moved_rad <= inputs.limits.start_rad)});
  if (by_generic_protocol(arm))
    add_other_makes_rows(arm, rows);
  else
    add_ur_rows(arm, rows);
  rows.push_back({Refused::OtherSerial, "arm's serial number", arm.told_serial.value_or("not known"),
                  arm.serial.value_or("not told"),
                  arm.serial ? when(arm.told_serial == arm.serial) : State::NotKnown});
  rows.push_back({Refused::ArmNotHeld, "arm held by this service alone", arm.held ? "yes" : "no", "yes",
                  when(arm.held)});
}

/// What stands in such a row was never asked for: nobody shall go and mend it.
void tell_what_was_not_looked_at(std::vector<GateRow>& rows) {
  for (GateRow& row : rows) {
    if (!needs_the_arm(row.code)) continue;
    row.state = State::NotLookedAt;
    row.value = "not looked at";
  }
}

}  // namespace

bool stands_as_scanned(const Unmoved& look) {
  return look.same_shoe && look.shift_mm >= 0 && look.u95_mm >= 0 &&
         look.shift_mm + look.u95_mm <= look.limit_mm;
}

bool needs_the_arm(Refused code) {
  return code == Refused::PathNotPassed || code == Refused::ArmMoved || code == Refused::NotRemote ||
         code == Refused::OtherArm || code == Refused::OtherSerial;
}

struct Gatekeeper {
  static PermittedPath permit(const path::CheckedPath& path, const GateInputs& inputs, const StopMark& mark) {
    return PermittedPath{path, inputs, mark};
  }
};

std::vector<GateRow> judge(const GateInputs& inputs) {
  std::vector<GateRow> rows;
  add_scan_rows(inputs, rows);
  add_result_rows(inputs, rows);
  add_taught_rows(inputs.result, rows);
  add_file_rows(inputs.files, rows);
  add_arm_rows(inputs, rows);
  if (inputs.arm.asked == false) tell_what_was_not_looked_at(rows);
  return rows;
}

bool passed(const std::vector<GateRow>& rows) {
  return !rows.empty() && std::ranges::none_of(rows, [](const GateRow& row) {
    return row.state == State::Failed || row.state == State::NotLookedAt;
  });
}

std::string failures(const std::vector<GateRow>& rows) {
  std::string all;
  for (const GateRow& row : rows) {
    if (row.state != State::Failed) continue;
    all += (all.empty() ? "" : "; ") + row.name + ": " + row.value + " (" + row.limit + ")";
  }
  return all;
}

std::string why_not_ready(const ArmFacts& arm) {
  if (by_generic_protocol(arm) && !poses_agree(arm)) {
    return text(
        "%.50s tells a pose that is %.2f mm and %.3f degrees from a %.20s's with its joints (limits %.2f, "
        "%.3f): check --robot and --kinematics",
        arm.told_model.value_or("the arm").c_str(), *arm.pose_off_mm, *arm.pose_off_rad * k_deg_per_rad,
        arm.arm.c_str(), k_pose_off_mm, k_pose_off_rad * k_deg_per_rad);
  }
  if (arm.told_model && arm.told_version && !is_arm(arm, *arm.told_model)) {
    return text("the controller is a %.40s's (%.40s), not a %.20s's: check --robot and the addresses",
                arm.told_model->c_str(), arm.told_version->c_str(), arm.arm.c_str());
  }
  if (arm.serial && arm.told_serial && arm.serial != arm.told_serial) {
    return text("the arm has the serial number %.40s, not %.40s: check --serial and the addresses",
                arm.told_serial->c_str(), arm.serial->c_str());
  }
  const bool cb3 = arm.told_version && is_cb3(*arm.told_version);
  if (!cb3 && arm.told_remote == false)
    return "remote control is off: switch it on at the teach pendant (Settings, System, Remote Control; "
           "PolyScope X: Mode Selection, Automatic, Remote)";
  return {};
}

bool PermittedPath::holds_for(const kinematics::Joints& q_rad) const {
  return q_rad.allFinite() && (q_rad - from_rad_).cwiseAbs().maxCoeff() <= start_rad_;
}

GateOutcome open_gate(const GateInputs& inputs, const path::CheckedPath& path, const StopMark& mark) {
  GateOutcome outcome{.rows = judge(inputs), .path = std::nullopt};
  if (passed(outcome.rows)) outcome.path = Gatekeeper::permit(path, inputs, mark);
  return outcome;
}

}  // namespace biteline::robot
