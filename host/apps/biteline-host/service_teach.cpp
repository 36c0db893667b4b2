// SPDX-License-Identifier: MIT
// A scan that is taught: with another process, and first in the air.
#include "host/apps/biteline-host/service.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/doors/api/air.hpp"
#include "host/records/report/report.hpp"
#include "host/robot/path/first_run.hpp"

namespace biteline::service {

Result<ExitStatus> Service::plan_with(Held held, const std::string& process, const std::string& who) {
  const std::string name = held.folder.filename().string();
  cockpit_->show(Phase::Working, "plans the path of " + name + " with " + process, "a person decides");
  const Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    // The path of another process is not what was asked for, also where this one cannot be read.
    held.plan.outcome = {};
    Chosen chosen = held.chosen;
    chosen.process.reset();
    chosen.process_name = process;
    chosen.process_by = who;
    chosen.taught = true;
    chosen.other_process.clear();
    BITELINE_TRY(choose_process(chosen));
    held.chosen = std::move(chosen);
    // Where this shoe grows too old the next scan of it is worked so, too.
    order_taught(process, held.chosen);
    BITELINE_TRY(keep_process(held.folder, held.chosen));
    held.plan.request.process = process_of(held.chosen);
    return plan_anew(held);
  });
  // Also without a path: another process may have one.
  held_.emplace(std::move(held));
  cockpit_->show_model(held_->chosen.model, held_->chosen.probability,
                       {held_->chosen.process_name, held_->chosen.process_by});
  remember(held_->folder, "held", held_->chosen, {});
  return status;
}

Result<ExitStatus> Service::work_with(Unnamed unnamed, const std::string& process, const std::string& who) {
  Scan& scan = unnamed.scan;
  const std::filesystem::path folder = scan.folder;
  cockpit_->show(Phase::Working, "plans the path of " + folder.filename().string() + " with " + process,
                 "a person decides");
  Chosen chosen;
  chosen.process_name = process;
  chosen.process_by = who;
  chosen.taught = true;
  chosen.part = scan.chosen.part;
  chosen.foot = scan.chosen.foot;
  chosen.size = scan.chosen.size;
  // Of the release that it was looked for in.
  chosen.release = scan.chosen.release;
  Result<void> possible = choose_process(chosen);
  if (possible && !unnamed.line.line)
    possible =
        fail(Errc::WrongState, "%s has no line of its own; choose its model", folder.filename().c_str());
  if (!possible) {
    unnamed_.emplace(std::move(unnamed));
    return tl::unexpected<Error>{possible.error()};
  }
  order_taught(process, chosen);
  scan.chosen = chosen;
  cockpit_->show_model("", 0, {chosen.process_name, chosen.process_by});
  const Result<ExitStatus> status =
      without_exceptions([&] { return work_out_path(scan, unnamed.outcome, unnamed.line, true); });
  close_result(folder, chosen);
  return status;
}

Result<ExitStatus> Service::run_in_air(Held held, const robot::Word& word) {
  const std::string name = held.folder.filename().string();
  cockpit_->show(Phase::Following, "the arm runs the path of " + name + " in the air", "a person decides");
  const Result<ExitStatus> status = without_exceptions([&]() -> Result<ExitStatus> {
    const std::filesystem::path folder = held.folder / api::k_air_folder;
    std::error_code error;
    std::filesystem::remove_all(folder, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", folder.c_str());
    path::PlanRequest request = path::first_run(held.plan.request);
    BITELINE_ASSIGN(request.mounted, mounted());
    request.table_z_mm = request.mounted.table_z_mm.value_or(robot_->options.table_z_mm);
    cloud::ClosedLine line = request.line;
    BITELINE_ASSIGN(const PlanStep plan, plan_again(folder / "path", std::move(request), std::move(line)));
    if (!plan.outcome.path) return plan.status;
    SendRequest send = held.request;
    send.approved = word;
    send.holds_arm = holds_arm();
    BITELINE_ASSIGN(send.mounted, mounted());
    return follow_path(folder, plan, send);
  });
  if (!status) {
    // Else whoever asked for it would wait for its outcome.
    report::Report report;
    report.refuse(to_line(status.error()));
    if (const Result<void> told = report.write(held.folder / api::k_air_folder); !told)
      complain(told.error());
  }
  held_.emplace(std::move(held));
  remember(held_->folder, "held", held_->chosen, {});
  return status;
}

}  // namespace biteline::service
