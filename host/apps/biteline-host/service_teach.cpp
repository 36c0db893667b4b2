// SPDX-License-Identifier: MIT
// A scan that is taught: with another process, and first in the air.
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/interfaces/api/air.hpp"
#include "host/report/report.hpp"
#include "host/robot/path/first_run.hpp"

namespace biteline::service {

Service::Chosen Service::chosen_anew(const Chosen& before) {
  Chosen chosen;
  chosen.part = before.part;
  chosen.told_twice = before.told_twice;
  // Of the release that it was looked for in.
  chosen.release = before.release;
  return chosen;
}

Service::Worked Service::plan_with(HeldScan held, const std::string& process, const std::string& who) {
  Chosen& chosen = held.scan.chosen;
  Planned& planned = *held.planned();
  if (chosen.rework) {
    Error error = fail(Errc::WrongState, "%s works once more what is missing, with its own process alone",
                       held.name().c_str())
                      .value();
    return wait_on(std::move(held), std::move(error));
  }
  operator_control_->show("plans the path of " + held.name() + " with " + process, "a person decides");
  Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    // The path of another process is not what was asked for, also where this one cannot be read.
    planned.plan.outcome = {};
    Chosen other = chosen;
    other.process.reset();
    other.process_name = process;
    other.process_by = who;
    other.taught = true;
    other.other_process.clear();
    BITELINE_TRY(choose_process(other));
    BITELINE_TRY(take_following(other));
    chosen = std::move(other);
    // Where this shoe grows too old the next scan of it is worked so, too.
    order_taught(process, chosen);
    BITELINE_TRY(keep_process(held.scan.folder, chosen));
    planned.plan.request.process = process_to_plan(chosen);
    return plan_anew(held);
  });
  operator_control_->show_model(chosen.model, chosen.probability, {chosen.process_name, chosen.process_by});
  // Also without a path: another process may have one.
  return hold_again(std::move(status), std::move(held));
}

Service::Worked Service::work_with(HeldScan held, const std::string& process, const std::string& who) {
  operator_control_->show("plans the path of " + held.name() + " with " + process, "a person decides");
  Unnamed& unnamed = *held.unnamed();
  Chosen chosen = chosen_anew(held.scan.chosen);
  chosen.process_name = process;
  chosen.process_by = who;
  chosen.taught = true;
  chosen.foot = held.scan.chosen.foot;
  chosen.size = held.scan.chosen.size;
  if (const Result<void> possible = choose_process(chosen); !possible)
    return wait_on(std::move(held), possible.error());
  if (!unnamed.line.line) {
    Error error =
        fail(Errc::WrongState, "%s has no line of its own; choose its model", held.name().c_str()).value();
    return wait_on(std::move(held), std::move(error));
  }
  order_taught(process, chosen);
  Scan scan = std::move(held.scan);
  scan.chosen = std::move(chosen);
  operator_control_->show_model("", 0, {scan.chosen.process_name, scan.chosen.process_by});
  const std::filesystem::path folder = scan.folder;
  WorkedOut out = path_without_exceptions(scan, unnamed.outcome, unnamed.line, true);
  Chosen worked = chosen_of(out, scan);
  return close_result(std::move(out), folder, std::move(worked));
}

Service::Worked Service::run_in_air(HeldScan held, const robot::Word& word) {
  Planned& planned = *held.planned();
  operator_control_->show("the arm runs the path of " + held.name() + " in the air", "a person decides");
  const std::filesystem::path folder = held.scan.folder / api::k_air_folder;
  Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    std::error_code error;
    std::filesystem::remove_all(folder, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", folder.c_str());
    path::PlanRequest request = path::first_run(planned.plan.request);
    BITELINE_ASSIGN(request.mounted, mounted(request.process));
    request.table_z_mm = request.mounted.table_z_mm.value_or(robot_->options.table_z_mm);
    cloud::ClosedLine line = request.line;
    BITELINE_ASSIGN(const PlanStep plan, plan_again(folder / "path", std::move(request), std::move(line)));
    if (!plan.outcome.path) return plan.status;
    SendRequest send = planned.request;
    send.approved = word;
    send.holds_arm = holds_arm();
    BITELINE_ASSIGN(send.mounted, mounted(plan.request.process));
    operator_control_->enter(CellEvent::AirSetsOut);
    return follow_path(folder, plan, send);
  });
  if (!status) {
    // Else whoever asked for it would wait for its outcome.
    report::Report report;
    report.refuse(to_line(status.error()));
    if (const Result<void> told = report.write(folder); !told) log_error(told.error());
  }
  return hold_again(std::move(status), std::move(held));
}

}  // namespace biteline::service
