// SPDX-License-Identifier: MIT
#include "host/apps/biteline-demo/cell_run.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>

#include "host/apps/biteline-demo/json_file.hpp"
#include "host/apps/biteline-demo/lateness.hpp"
#include "host/apps/biteline-demo/stand.hpp"
#include "host/intake/child_process.hpp"
#include "host/intake/refused.hpp"
#include "host/report/report.hpp"
#include "host/robot/link/gate/refused.hpp"
#include "host/transfer/refused.hpp"

namespace biteline::demo {
namespace {

namespace fs = std::filesystem;
using intake::ChildProcess;
using nlohmann::ordered_json;
using namespace std::chrono_literals;

/// Shows what the host says; its exit status.
Result<int> attend(ChildProcess& host, bool quiet) {
  // Scan, extraction, plan and following take about a minute; a host that is silent for longer than that
  // hangs.
  constexpr auto k_patience = 180s;
  for (;;) {
    const Result<std::string> line = host.next_line(k_patience);
    if (line) {
      if (!quiet) std::printf("  host: %s\n", line->c_str());
      std::fflush(stdout);
      continue;
    }
    if (line.error().code != Errc::ProcessDied) return tl::unexpected<Error>(line.error());
    return host.wait(10s);  // its stdout ended: it is leaving
  }
}

Result<evaluation::LineError> measure_line(const fs::path& scan, const fs::path& truth) {
  BITELINE_ASSIGN(const cloud::ClosedLine found, cloud::read_line(scan / "line.csv"));
  BITELINE_ASSIGN(const cloud::ClosedLine known, cloud::read_positions(truth / "groove.csv"));
  return evaluation::line_error(found, known);
}

/// The newest of the host's result folders, or nothing.
std::optional<fs::path> newest_scan(const fs::path& out) {
  std::optional<fs::path> newest;
  std::error_code error;
  for (fs::directory_iterator it{out, error}, end; !error && it != end; it.increment(error)) {
    const fs::path name = it->path().filename();
    if (name.string().starts_with("scan-") && (!newest || name > newest->filename())) newest = it->path();
  }
  return newest;
}

/// The gate before the arm refused this scan since parts of it were lost on the way.
bool holes_before_gate(const fs::path& scan) {
  const auto lost = [](const ordered_json& row) {
    const std::string code = row.value("reason_code", "");
    return code == report::refusal_row(robot::Refused::HolesInScan).name ||
           code == report::refusal_row(robot::Refused::MessagesLost).name;
  };
  const ordered_json gate = read_json(scan / "gate.json");
  const ordered_json rows = gate.value("rows", ordered_json::array());
  return std::any_of(rows.begin(), rows.end(), lost);
}

/// The scan is at fault, not the shoe: it did not reach its end, pictures or poses came late or not at all,
/// or part of the way round is missing.
bool worth_another_scan(const std::optional<fs::path>& scan) {
  if (!scan) return false;
  constexpr std::array k_of_the_scan{intake::Refused::ScanNotComplete, intake::Refused::NoTime,
                                     intake::Refused::FramesLost, intake::Refused::PosesTooFar};
  const std::string code = read_json(*scan / "report.json").value("reason_code", "");
  return std::ranges::any_of(k_of_the_scan,
                             [&](intake::Refused of) { return code == report::refusal_row(of).name; }) ||
         code == report::refusal_row(transfer::Refused::ScanHasGap).name || holes_before_gate(*scan);
}

/// Nothing when the machine had time.
std::string too_busy(const Lateness& lateness) {
  if (lateness.worst_ms() <= Lateness::k_allowed_ms) return {};
  char text[200];
  std::snprintf(
      text, sizeof text,
      "this machine is too busy: programs wait up to %.0f ms for it, %.0f allowed (end others, or run as a "
      "user with real-time rights); ",
      lateness.worst_ms(), Lateness::k_allowed_ms);
  return text;
}

/// What became of it, in one line.  `busy`: what the machine has to do with it.
std::string verdict_of(const ShoeResult& result, const std::string& last_words, const std::string& busy) {
  const ordered_json line = read_json(result.scan / "report.json"),
                     plan = read_json(result.scan / "path/report.json");
  if (!result.error) {
    if (line.contains("reason")) return busy + "refused: " + line["reason"].get<std::string>();
    return "the host service ended with status " + std::to_string(result.host_status) + ": " + last_words;
  }
  char text[200];
  std::snprintf(text, sizeof text, "line within %.3f mm of the cell's own on average, %.3f mm at most",
                result.error->mean_mm, result.error->max_mm);
  if (result.good()) return text;
  if (plan.contains("reason")) return std::string{text} + "; no path: " + plan["reason"].get<std::string>();
  return std::string{text} + "; the host service ended with status " + std::to_string(result.host_status) +
         ": " + last_words;
}

}  // namespace

Result<ShoeResult> run_shoe(const CellOptions& options, const Shoe& shoe) {
  const auto begin = std::chrono::steady_clock::now();
  const fs::path folder = options.out / shoe.name;
  BITELINE_TRY(report::prepare_folder(folder));
  const std::optional<fs::path> earlier = newest_scan(folder);  // of an earlier demo: kept
  BITELINE_ASSIGN(Stand stand, start_stand(options, shoe, folder));
  std::vector<std::string> arguments = host_arguments(options, stand, folder);
  arguments.emplace_back("--once");
  if (shoe.sample) arguments.insert(arguments.end(), {"--sample", shoe.sample->string()});

  ShoeResult result{.shoe = shoe, .scan = {}, .verdict = {}, .error = {}};
  result.scan_s = stand.cell.endpoints.value("scan_s", 0.0);
  result.time_ratio = stand.cell.endpoints.value("time_ratio", 1.0);
  if (result.time_ratio < 1 && !options.quiet)
    std::printf("  this machine cannot simulate in real time: %.2f of it; the scan goes that much slower\n",
                result.time_ratio);
  std::string last_words;
  const Lateness lateness;
  // On a machine that is busy with other things frames may come too late, and the laser's guard then,
  // rightly, ends the scan.
  constexpr int k_most_scans = 3;
  for (int scans = 1; scans <= k_most_scans; ++scans) {
    BITELINE_ASSIGN(ChildProcess host,
                    ChildProcess::start({.program = intake::program_folder() / "biteline-host",
                                         .arguments = arguments,
                                         .pass_stderr = true}));
    BITELINE_ASSIGN(result.host_status, attend(host, options.quiet));
    last_words = host.last_words();
    if (!worth_another_scan(newest_scan(folder))) break;
    if (scans < k_most_scans && !options.quiet)
      std::printf("  %sthe scan is not whole: scanning again\n", too_busy(lateness).c_str());
  }
  const std::string busy = worth_another_scan(newest_scan(folder)) ? too_busy(lateness) : "";
  stand.sensor.child.stop();
  stand.cell.child.stop();  // writes its record of the arm's track

  const std::optional<fs::path> newest = newest_scan(folder);
  if (!newest || newest == earlier) {
    return fail(Errc::ProcessDied, "biteline-host left no result (status %d): %s", result.host_status,
                last_words.c_str());
  }
  result.scan = *newest;
  if (fs::exists(result.scan / "line.csv")) {
    BITELINE_ASSIGN(result.error, measure_line(result.scan, folder / "cell/truth"));
  }
  result.made = made_times(folder / "cell", result.scan);
  result.verdict = verdict_of(result, last_words, busy);
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace biteline::demo
