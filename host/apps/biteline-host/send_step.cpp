// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/send_step.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/core/fixed_text.hpp"
#include "host/apps/biteline-host/late_work.hpp"
#include "host/apps/biteline-host/scan_row.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/apps/biteline-host/tool_step.hpp"
#include "host/records/digest/digest.hpp"
#include "host/records/evidence/evidence.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/records/results/view/view_data.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"
#include "host/robot/link/follow.hpp"
#include "host/robot/link/gate/gate_file.hpp"
#include "host/robot/path/certainty.hpp"
#include "host/robot/path/checks/way_there.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_gate_file = "gate.json";

double seconds_since(HostClock::time_point instant) {
  return 1e-9 * static_cast<double>((now() - instant).count());
}

/// Nothing where the process tells none.
std::optional<bool> same_payload(const std::optional<path::Payload>& sent,
                                 const std::optional<path::Payload>& told) {
  if (!told) return std::nullopt;
  constexpr double k_kg = 1e-6, k_mm = 1e-6;
  return sent && std::abs(sent->mass_kg - told->mass_kg) <= k_kg &&
         (sent->centre_flange_mm - told->centre_flange_mm).norm() <= k_mm;
}

/// A file that cannot be read is not what was written.
robot::FilesFacts files_of(const SendRequest& request) {
  robot::FilesFacts files;
  if (request.looked_at.empty()) return files;
  const memory::Evidence now = evidence::of_folder(request.looked_at).value_or(memory::Evidence{});
  const auto compare = [](const std::string& written, const std::string& is) {
    return written.empty() ? robot::FileFacts{} : robot::FileFacts{.written = written, .now = is};
  };
  files.line = compare(request.written.line, now.line);
  files.cloud = compare(request.written.cloud, now.cloud);
  files.report = compare(request.written.report, now.report);
  files.process =
      compare(request.written.process, digest_of_file(request.process_file).value_or(std::string{}));
  return files;
}

/// What the last look has shown stands, until it is too old: then the clamp may vouch in its place.
std::optional<robot::Unmoved> unmoved_of(const SendRequest& request, double limit_s) {
  std::optional<robot::Unmoved> look;
  if (request.looked) {
    look = request.looked->shows;
    look->age_s = seconds_since(request.looked->at);
    if (!robot::stands_as_scanned(*look) || look->age_s <= limit_s) return look;
  }
  const auto since = request.clamp != nullptr ? request.clamp->held_since() : std::nullopt;
  if (!since) return look;
  return robot::Unmoved{.by = robot::Unmoved::By::Clamp, .age_s = seconds_since(*since)};
}

void tell_age(const SendRequest& request, robot::GateInputs& inputs) {
  if (request.scan_ended) inputs.scan.age_s = seconds_since(*request.scan_ended);
  inputs.scan.unmoved = unmoved_of(request, inputs.limits.scan_age_s);
}

/// What is known before anybody goes near the arm.
robot::GateInputs gate_inputs(const PlanStep& plan, const SendRequest& request) {
  robot::GateInputs inputs;
  const path::Process& process = plan.request.process;
  const path::Certainty certain = path::certainty_of(plan.outcome.path->path(), process.gate.tolerance_mm);
  inputs.limits = process.gate;
  inputs.scan = request.scan;
  tell_age(request, inputs);
  const SE3 off = plan.outcome.path->path().T_flange_tcp.inverse() * process.tool.T_flange_tcp;
  inputs.result = {.line_passed = path::all_passed(path::check_line(plan.request.line)),
                   .path_passed = false,
                   .u95_mm = certain.u95_mm,
                   .tip_bound_mm = certain.tip_bound_mm,
                   .tool_off_mm = off.translation().norm(),
                   .tool_off_rad = geometry::log_so3(off.linear()).norm(),
                   .same_payload = same_payload(plan.outcome.path->path().payload,
                                                path::carried(process, request.mounted))};
  if (!process.tool.name.empty()) {
    inputs.result.tool = process.tool.name;
    // What a changer brings is asked for when all else holds.
    inputs.result.mounted_tool = request.mounted.changer ? process.tool.name : request.mounted.tool;
  }
  inputs.result.tip_from_taught_mm = path::tip_off_mm(process, request.mounted);
  inputs.result.payload_as_taught = path::carries_as_taught(process, request.mounted);
  inputs.result.output_as_taught = path::switches_as_taught(process, request.mounted);
  if (request.mounted.table_z_mm)
    inputs.result.table_from_taught_mm = std::abs(plan.request.table_z_mm - *request.mounted.table_z_mm);
  inputs.files = files_of(request);
  inputs.arm.arm = plan.request.arm.name;
  inputs.arm.held = request.holds_arm;
  inputs.arm.asked = false;
  if (!request.serial.empty()) inputs.arm.serial = request.serial;
  if (request.approved) {
    inputs.result.approved = true;
    inputs.result.approved_by = request.approved->by + ", " + request.approved->at;
  } else if (process.gate.approval && !needs_a_person(process.gate, request.confidence)) {
    inputs.result.approved = true;
    inputs.result.approved_by =
        std::string{FixedText<80>::format("%s, confidence %.3f", k_automatic, request.confidence).view()};
  }
  return inputs;
}

bool about_the_arm(const robot::GateRow& row) {
  return row.code == robot::Refused::PathNotPassed || row.code >= robot::Refused::ArmMoved;
}

/// What is wrong with the scan itself: then the arm is not even asked.
bool scan_fails(const std::vector<robot::GateRow>& rows) {
  return std::ranges::any_of(rows, [](const robot::GateRow& row) {
    return row.state == robot::GateRow::State::Failed && !about_the_arm(row);
  });
}

/// A person's word would help.
bool may_be_confirmed(const robot::GateInputs& inputs) {
  robot::GateInputs vouched = inputs;
  vouched.scan.confirmed = robot::Word{};
  return !inputs.scan.confirmed && !scan_fails(robot::judge(vouched));
}

Result<ExitStatus> say_refused(const fs::path& folder, const robot::GateInputs& inputs) {
  BITELINE_TRY(robot::write_gate(folder / k_gate_file, inputs));
  std::vector<robot::GateRow> rows = robot::judge(inputs);
  const bool by_scan = scan_fails(rows);
  if (by_scan) std::erase_if(rows, about_the_arm);
  const std::string name = folder.filename().string();
  // Of a scan that was seen coming in nobody can say so: it is scanned again.
  const bool nobody_saw = inputs.scan.recovered || inputs.scan.from_recording;
  const bool confirm = by_scan && nobody_saw && may_be_confirmed(inputs);
  warn_step("refused: the path of %s is not sent: %s%s%s", name.c_str(), robot::failures(rows).c_str(),
            confirm ? "; a person who has looked may say --confirm " : "", confirm ? name.c_str() : "");
  return ExitStatus::Refused;
}

nlohmann::ordered_json as_json(const path::ForceTold& told, double set_newton) {
  return {{"set_n", set_newton},
          {"within", told.within},
          {"band_percent", 100 * path::k_force_band_ratio},
          {"mean_n", told.mean_newton},
          {"rms_off_n", told.rms_off_newton},
          {"least_n", told.least_newton},
          {"largest_n", told.largest_newton},
          {"along_mm", told.along_mm},
          {"samples", told.samples}};
}

Result<void> write_followed(const fs::path& folder, const robot::FollowReport& followed, bool dead_man,
                            const path::Process& process, const std::optional<path::ForceTold>& force) {
  const path::TrackDeviation& deviation = followed.deviation;
  nlohmann::ordered_json json{
      {"completed", deviation.completed},
      {"samples", deviation.samples},
      {"duration_s", followed.duration_s},
      {"parts_s",
       {{"way_there", deviation.parts.way_there_s},
        {"approach", deviation.parts.approach_s},
        {"line", deviation.parts.line_s},
        {"retreat", deviation.parts.retreat_s}}},
      {"slowest_speed_ratio", followed.slowest_speed_ratio},
      {"from_path_mm",
       {{"mean", deviation.mean_mm},
        {"rms", deviation.rms_mm},
        {"p95", deviation.p95_mm},
        {"max", deviation.max_mm},
        {"max_at_mm", deviation.max_at_mm}}},
      {"from_path_rad", {{"max", deviation.max_rad}}},
      {"from_line_mm",
       {{"mean", deviation.line_mean_mm}, {"p95", deviation.line_p95_mm}, {"max", deviation.line_max_mm}}},
      {"covered", deviation.covered},
      {"at_rest", followed.ending.at_rest},
      {"tool_output", robot::name_of(followed.ending.tool)},
      {"stops_sent", followed.ending.stops},
      {"oldest_state_s", followed.oldest_s},
      {"dead_man", dead_man}};
  if (force) json["force"] = as_json(*force, process.force->set_newton);
  if (followed.halt) {
    const report::ToldRefusal told = report::told(*followed.halt);
    json["stopped"] = {{"reason_code", told.reason_code},
                       {"reason", told.reason},
                       {"next_step", told.next_step},
                       {"at_rest", followed.ending.at_rest}};
  }
  BITELINE_TRY(robot::write_track(folder / "track.csv", followed.track));
  return report::write_file_atomically(folder / "followed.json", report::to_text(json) + "\n");
}

/// The follower asks for remote control itself, more often than the watch over the pendant does.
Result<void> follow_watched(robot::RobotLink& link, const robot::PermittedPath& path, const PlanStep& plan,
                            const SendRequest& request, robot::FollowReport& followed) {
  const robot::ur::PendantWatch::Rest rest{request.pendant};
  robot::FollowOptions options{.limits = plan.request.process.follow};
  if (request.pendant != nullptr) options.taken = [&request] { request.pendant->tell_taken(); };
  return robot::follow(link, path, options, followed);
}

}  // namespace

robot::Unmoved shown_by(const transfer::Moved& moved) {
  return {.by = robot::Unmoved::By::Look,
          .age_s = 0,
          .shift_mm = moved.shift_mm,
          .u95_mm = moved.u95_mm,
          .limit_mm = moved.limit_mm,
          .same_shoe = moved.verdict != transfer::Moved::Verdict::OtherShoe};
}

bool was_sent(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / k_gate_file, error)) return false;
  const Result<robot::GateFile> gate = robot::read_gate(folder / k_gate_file);
  return !gate || gate->permitted || gate->inputs.scan.sent_before;
}

std::optional<report::ToldRefusal> why_not_sendable(const fs::path& folder, const PlanStep& plan,
                                                    const SendRequest& request) {
  SendRequest said = request;
  said.approved = robot::Word{};
  robot::GateInputs inputs = gate_inputs(plan, said);
  inputs.scan.sent_before = was_sent(folder);
  for (const robot::GateRow& row : robot::judge(inputs)) {
    if (row.state != robot::GateRow::State::Failed || about_the_arm(row)) continue;
    const auto& words = report::refusal_row(row.code);
    return report::ToldRefusal{.reason_code = words.name,
                               .reason = row.name + ": " + row.value + " (" + row.limit + ")",
                               .next_step = words.next_step};
  }
  return std::nullopt;
}

std::optional<double> fresh_s(const PlanStep& plan, const SendRequest& request) {
  if (!request.scan_ended || request.scan.confirmed) return std::nullopt;
  const double limit_s = plan.request.process.gate.scan_age_s;
  const double age_s = seconds_since(*request.scan_ended);
  const std::optional<robot::Unmoved> unmoved = unmoved_of(request, limit_s);
  if (!unmoved) return limit_s - age_s;
  if (unmoved->by == robot::Unmoved::By::Look)
    return limit_s - (robot::stands_as_scanned(*unmoved) ? std::min(unmoved->age_s, age_s) : age_s);
  if (unmoved->age_s >= age_s) return std::nullopt;
  return limit_s - age_s;
}

bool needs_a_person(const path::GateLimits& limits, double confidence) {
  return limits.approval && !(limits.automatic_above && confidence >= *limits.automatic_above);
}

Result<ExitStatus> follow_path(const fs::path& folder, const PlanStep& plan, const SendRequest& request,
                               std::function<Result<void>()> meanwhile,
                               const std::function<void(const path::ForceTold&)>& pressed) {
  const path::Process& process = plan.request.process;
  robot::GateInputs inputs = gate_inputs(plan, request);
  inputs.scan.sent_before = was_sent(folder);
  inputs.scan.stopped = request.mark.stopped();
  if (scan_fails(robot::judge(inputs))) return say_refused(folder, inputs);
  const auto stopped = [&] {
    inputs.scan.stopped = true;
    return say_refused(folder, inputs);
  };

  const int flange_input = process.force && process.force->flange ? process.force->flange->analog_input : -1;
  BITELINE_ASSIGN(
      const std::shared_ptr<robot::RobotLink> link,
      open_robot(request.controller, robot::ur::UrLink::Config{}.connect_patience_s, request.claim,
                 plan.request.process.force && !plan.request.tool_off, flange_input));
  const Result<robot::RobotState> still = robot::wait_until_still(
      *link, {.turn_rad = robot::k_ringing_rad, .move_mm = robot::k_ringing_mm, .mark = request.mark});
  if (request.mark.stopped()) return stopped();
  if (!still) return tl::unexpected<Error>{still.error()};
  const path::CollisionModel collisions{plan.request.arm, plan.request.process.tool,
                                        plan.outcome.surroundings};
  const path::WayThere way =
      path::find_way_there(still->q_rad, *plan.outcome.path, plan.request.arm, collisions);
  if (!way.path) log_step("%s comes as near as %.1f mm", way.check.detail.c_str(), way.check.value);
  BITELINE_TRY(ask_about_itself(request.controller, plan.request.arm, *still, inputs.arm));
  inputs.result.path_passed = way.path.has_value();
  inputs.result.way_clearance_mm = way.check.value;
  inputs.arm.asked = true;
  inputs.arm.q_checked_rad = inputs.arm.q_now_rad = still->q_rad;
  if (request.mounted.changer) {
    if (!robot::passed(robot::judge(inputs))) return say_refused(folder, inputs);
    log_step("asks the changer for %s", process.tool.name.c_str());
    const BroughtTool brought = bring_tool(request, process.tool, plan.outcome.surroundings,
                                           still->T_base_tcp * still->T_flange_tcp.inverse());
    if (request.tool_stands) request.tool_stands(brought.stands);
    inputs.result.mounted_tool = brought.stands;
    if (!brought.trouble.empty()) inputs.result.changer_trouble = brought.trouble;
    if (request.mark.stopped()) return stopped();
  }
  // Right before the sending, and before the arm is looked at for the last time.
  inputs.files = files_of(request);
  BITELINE_ASSIGN(const robot::RobotState now, link->latest());

  tell_age(request, inputs);
  inputs.arm.q_now_rad = now.q_rad;
  inputs.scan.stopped = request.mark.stopped();
  const robot::GateOutcome gate =
      robot::open_gate(inputs, way.path ? *way.path : *plan.outcome.path, request.mark);
  if (!gate.path) return say_refused(folder, inputs);
  // Before anything moves: a decision that cannot be kept is none.
  BITELINE_TRY(robot::write_gate(folder / k_gate_file, inputs));

  log_step("sends the path to %s", request.controller.name().c_str());
  robot::FollowReport followed;
  std::future<Result<void>> beside = begin_beside_arm(std::move(meanwhile));
  const Result<void> done = follow_watched(*link, *gate.path, plan, request, followed);
  if (const Result<void> written = beside.get(); !written) log_error(written.error());
  if (!followed.sent && request.mark.stopped()) return stopped();
  // As far as it went, also when it was stopped.
  const std::optional<path::ForceTold> force = path::force_told(
      plan.outcome.path->path(), followed.track, process.force_learned.value_or(path::ForceLearned{}));
  BITELINE_TRY(write_followed(folder, followed, link->has_dead_man(), process, force));
  if (!link->has_dead_man())
    log_step("the arm's program had no dead man: nothing ends it when this machine or the cable fails");
  BITELINE_TRY(results::write_tracking(folder / "path", plan.request, plan.outcome, followed.track));
  BITELINE_TRY(results::write_file_list(folder));
  if (followed.ending.stops > 1) log_step("the arm was told to stop %d times", followed.ending.stops);
  if (!done) return tl::unexpected<Error>{done.error()};
  log_step(
      "the arm followed the line in %.1f s: %.3f mm from it on average, %.3f mm at most; %.1f %% of it "
      "covered",
      followed.duration_s, followed.deviation.line_mean_mm, followed.deviation.line_max_mm,
      100 * followed.deviation.covered);
  if (force) {
    log_step(
        "the tool pressed with %.1f N on average, %.1f N at most; %.1f %% of it within %.0f %% of %.1f N",
        force->mean_newton, force->largest_newton, 100 * force->within, 100 * path::k_force_band_ratio,
        process.force->set_newton);
    if (pressed) pressed(*force);
  }
  return ExitStatus::Done;
}

}  // namespace biteline::service
