// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/rerun.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "host/apps/biteline-host/refused.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/published/published_line.hpp"
#include "host/cloud/ply.hpp"
#include "host/records/results/line_result.hpp"
#include "host/records/results/plan_result.hpp"
#include "host/records/results/transfer_result.hpp"
#include "host/records/results/view/view_data.hpp"
#include "host/report/report.hpp"
#include "host/transfer/transfer.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using Line = std::optional<cloud::ClosedLine>;

constexpr std::size_t k_most_waiting = 8;
constexpr int k_least_priority = 19;  // as nice(2)

/// `settings` and who asked, for report.json.
nlohmann::ordered_json told_order(const api::RerunOrder& order) {
  return {{"scan", order.scan},
          {"who", order.who},
          {"why", order.why},
          {"settings", nlohmann::ordered_json(api::settings_json(order))}};
}

Result<Line> carry(const api::Catalogue& catalogue, const api::RerunOrder& order,
                   const cloud::PointCloud& cloud, const fs::path& folder, report::Report& report) {
  BITELINE_ASSIGN(const transfer::SampleFiles sample, catalogue.models.load(order.model));
  transfer::TransferOptions options;
  options.align.mirror = order.mirror;
  options.align.grade = order.grade;
  report.fields["sample"] = order.model;
  transfer::Transfer carried =
      report.timed("transfer", [&] { return transfer::transfer_line(sample, cloud, options); });
  BITELINE_ASSIGN(const ExitStatus status, results::write_transfer_result(folder, cloud, carried, report));
  return status == ExitStatus::Done ? Line{std::move(carried.carried.line)} : Line{};
}

template <class Workings, class Find>
Result<Line> find_by(const Find& find, const cloud::PointCloud& cloud, const fs::path& folder,
                     report::Report& report) {
  std::optional<Workings> workings;
  bite_line::Extraction found = report.timed("extract", [&] { return find(&workings); });
  BITELINE_ASSIGN(
      const ExitStatus status,
      results::write_line_result(folder, cloud, found, results::stages_of(std::move(workings)), report));
  return status == ExitStatus::Done ? Line{std::move(found.line)} : Line{};
}

Result<Line> find(const api::RerunOrder& order, const cloud::PointCloud& cloud, const fs::path& folder,
                  report::Report& report) {
  if (order.method == "published") {
    return find_by<published::Workings>(
        [&](auto* workings) { return published::find_bite_line(cloud.points, {}, workings); }, cloud, folder,
        report);
  }
  return find_by<bite_line::Workings>(
      [&](auto* workings) { return bite_line::find_bite_line(cloud, {}, workings); }, cloud, folder, report);
}

/// The line as it stands now, with every mend.
Result<Line> take_line(const fs::path& scan, const cloud::PointCloud& cloud, const fs::path& folder,
                       report::Report& report) {
  BITELINE_ASSIGN(cloud::ClosedLine line, cloud::read_line(scan / "line.csv"));
  BITELINE_TRY(cloud::write_line(folder / "line.csv", line));
  report.fields["length_mm"] = cloud::length_mm(line);
  report.fields["line_points"] = line.points.size();
  report.stop_clock();
  BITELINE_TRY(results::write_view(folder, {.title = "Bite line",
                                            .summary = "the line as it stood",
                                            .found = true,
                                            .report = report.fields,
                                            .cloud = &cloud,
                                            .line = &line,
                                            .T_base_shoe = std::nullopt,
                                            .path_mm = {}}));
  BITELINE_TRY(report.write(folder));
  return Line{std::move(line)};
}

/// The order's, else the model's own, else the service's.
Result<path::Process> process_of(const RerunArm& arm, const api::Catalogue& catalogue,
                                 const api::RerunOrder& order) {
  if (!order.process.empty()) {
    BITELINE_ASSIGN(const api::StoredProcess stored, catalogue.processes.find(order.process));
    return path::read_process(stored.file);
  }
  const fs::path own = catalogue.models.path_of(order.model) / transfer::k_process_file;
  std::error_code error;
  if (!order.model.empty() && fs::exists(own, error)) return path::read_process(own);
  return arm.process;
}

Result<path::PlanRequest> request_of(const RerunRoom& room, path::Process process,
                                     const cloud::PointCloud& cloud, cloud::ClosedLine line) {
  const RerunArm& arm = *room.arm;
  path::PlanRequest request;
  if (room.mounted) {
    BITELINE_ASSIGN(request.mounted, room.mounted(process.tool.name));
  }
  request.process = std::move(process);
  request.arm = arm.model;
  request.table_z_mm = request.mounted.table_z_mm.value_or(arm.table_z_mm);
  request.fixture = arm.fixture;
  request.cloud = cloud.points;
  request.line = std::move(line);
  return request;
}

Result<void> plan(const RerunRoom& room, path::Process process, const cloud::PointCloud& cloud,
                  cloud::ClosedLine line, const fs::path& folder) {
  report::Report report;
  BITELINE_ASSIGN(const path::PlanRequest request,
                  request_of(room, std::move(process), cloud, std::move(line)));
  BITELINE_TRY(results::prepare_plan_folder(folder / "path"));
  const path::PlanOutcome outcome = report.timed("plan", [&] { return path::plan(request); });
  BITELINE_TRY(results::write_plan_result(folder / "path", request, outcome, report));
  return results::write_file_list(folder);
}

/// What could not be read or written is told where the outcome would stand.
void tell_failure(const fs::path& folder, const api::RerunOrder& order, const std::string& words) {
  report::Report report;
  report.fields["rerun"] = told_order(order);
  report.refuse(
      Refusal{.code = Refused::RerunFailed, .reason = "the scan could not be worked out again: " + words});
  if (const Result<void> written = report.write(folder); !written) log_error(written.error());
}

}  // namespace

Result<void> work_again(const RerunRoom& room, const api::RerunOrder& order, int number) {
  const fs::path scan = room.results / order.scan, folder = scan / api::rerun_folder(number);
  report::Report report;
  BITELINE_TRY(results::prepare_result_folder(folder));
  BITELINE_ASSIGN(const cloud::PointCloud cloud,
                  report.timed("read", [&] { return cloud::read_cloud(scan / "cloud.ply"); }));
  report.fields["input"] = order.scan;
  report.fields["rerun"] = told_order(order);
  std::optional<path::Process> process;
  BITELINE_ASSIGN(const api::Catalogue catalogue, catalogue_now(room.catalogue));
  if (room.arm) {
    BITELINE_ASSIGN(process, process_of(*room.arm, catalogue, order));
    report.fields["process"] = process->name;
  }
  std::error_code error;
  Line line;
  if (!order.model.empty()) {
    BITELINE_ASSIGN(line, carry(catalogue, order, cloud, folder, report));
  } else if (!order.method.empty() || !fs::exists(scan / "line.csv", error)) {
    BITELINE_ASSIGN(line, find(order, cloud, folder, report));
  } else {
    BITELINE_ASSIGN(line, take_line(scan, cloud, folder, report));
  }
  if (!line || !room.arm) return {};
  return plan(room, std::move(*process), cloud, std::move(*line), folder);
}

Result<path::PlanOutcome> try_path(const RerunRoom& room, const std::string& scan,
                                   const path::Process& process) {
  const fs::path folder = room.results / scan;
  BITELINE_ASSIGN(const cloud::PointCloud cloud, cloud::read_cloud(folder / "cloud.ply"));
  BITELINE_ASSIGN(cloud::ClosedLine line, cloud::read_line(folder / "line.csv"));
  BITELINE_ASSIGN(path::PlanRequest request, request_of(room, process, cloud, std::move(line)));
  // Every other request of a door waits for this one.
  request.seek_remedy = false;
  tbb::task_arena one_core{1};
  return one_core.execute([&] { return path::plan(request); });
}

RerunWorker::RerunWorker(RerunRoom room, std::function<void(const std::string&)> done)
    : room_{std::move(room)}, done_{std::move(done)}, thread_{[this] { run(); }} {}

void RerunWorker::end() {
  {
    const std::lock_guard lock{mutex_};
    ended_ = true;
  }
  more_.notify_one();
  if (thread_.joinable()) thread_.join();
}

Result<int> RerunWorker::add(const api::RerunOrder& order) {
  if (!order.process.empty() && !room_.arm)
    return fail(Errc::WrongState, "process %s: this service has no arm; start it with --robot",
                order.process.c_str());
  const fs::path scan = room_.results / order.scan;
  std::error_code error;
  if (!fs::exists(scan / "cloud.ply", error))
    return fail(Errc::WrongState, "%s has no points any more; scan the shoe again", order.scan.c_str());
  const std::lock_guard lock{mutex_};
  if (ended_ || jobs_.size() >= k_most_waiting)
    return fail(Errc::WrongState, "%zu scans wait to be worked out again; wait for them", jobs_.size());
  BITELINE_ASSIGN(const int number, api::keep_order(scan, order));
  jobs_.push_back({.order = order, .number = number});
  more_.notify_one();
  return number;
}

bool RerunWorker::open(const std::string& scan, int number) const {
  const std::lock_guard lock{mutex_};
  return std::ranges::any_of(jobs_,
                             [&](const Job& job) { return job.order.scan == scan && job.number == number; });
}

void RerunWorker::run() {
  pthread_setname_np(pthread_self(), "bl-again");
  // A service under systemd may not; one core alone still gives way.
  static_cast<void>(::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), k_least_priority));
  tbb::task_arena one_core{1};
  for (;;) {
    Job job;
    {
      std::unique_lock lock{mutex_};
      more_.wait(lock, [&] { return ended_ || !jobs_.empty(); });
      if (ended_) return;
      job = jobs_.front();
    }
    const fs::path folder = room_.results / job.order.scan / api::rerun_folder(job.number);
    try {
      const Result<void> worked = one_core.execute([&] { return work_again(room_, job.order, job.number); });
      if (!worked) tell_failure(folder, job.order, to_line(worked.error()));
    } catch (const std::exception& error) {
      tell_failure(folder, job.order, error.what());
    }
    {
      const std::lock_guard lock{mutex_};
      jobs_.pop_front();
    }
    done_(job.order.scan);
  }
}

}  // namespace biteline::service
