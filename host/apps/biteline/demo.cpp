// SPDX-License-Identifier: MIT
// biteline demo: the simulated cell, the sensor and the host service as processes; scan, line, path, the arm following it.
#include <cstdio>
#include <fstream>
#include <optional>

#include "host/apps/biteline/command.hpp"
#include "host/cloud/ply.hpp"
#include "host/measure/line_error.hpp"
#include "host/process/child_process.hpp"
#include "host/report/page.hpp"
#include "host/report/report.hpp"
#include "host/stages/stages.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using process::ChildProcess;
using namespace std::chrono_literals;

struct Options {
  fs::path out{"demo-result"};
  std::uint64_t seed{5};
  std::string shoe{"deep"};
  std::string arm{"ur5e"};
  fs::path process;
};

/// The processes' files stand beside the programs, as built and as installed.
fs::path process_file(const std::string& name) {
  return process::program_folder().parent_path() / "share" / "biteline" / "processes" / (name + ".yaml");
}

/// Starts a program that says in one line of JSON where it listens.
struct Server {
  ChildProcess child;
  ordered_json endpoints;
};

Result<Server> start_server(const std::string& name, std::vector<std::string> arguments) {
  arguments.emplace_back("--exit-with-parent");
  // Making a shoe and its search tree takes the cell some seconds, more on a busy machine.
  constexpr auto k_patience = 60s;
  BITELINE_ASSIGN(ChildProcess child, ChildProcess::start({.program = process::program_folder() / name,
                                                           .arguments = std::move(arguments),
                                                           .pass_stderr = true}));
  BITELINE_ASSIGN(const std::string line, child.next_line(k_patience));
  ordered_json endpoints = ordered_json::parse(line, nullptr, false);
  if (!endpoints.is_object()) return fail(Errc::ProtocolError, "%s: a line of JSON expected", name.c_str());
  return Server{.child = std::move(child), .endpoints = std::move(endpoints)};
}

Result<std::string> endpoint(const Server& server, const char* name) {
  if (!server.endpoints.contains(name) || !server.endpoints[name].is_string()) {
    return fail(Errc::ProtocolError, "no '%s' among the endpoints of a started program", name);
  }
  return server.endpoints[name].get<std::string>();
}

/// Shows what the host says; its exit status.
Result<int> attend(ChildProcess& host, bool quiet) {
  // Scan, extraction, plan and following take about a minute; a host that is silent for longer than that hangs.
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

ordered_json read_json(const fs::path& file) {
  std::ifstream stream(file);
  ordered_json json = ordered_json::parse(stream, nullptr, false);
  return json.is_object() ? json : ordered_json::object();
}

/// z of the table that the shoe stands on, which an integrator knows of his cell: here the cell's own.
double table_z_mm(const fs::path& truth) {
  std::ifstream file(truth / "T_base_shoe.txt");
  double entry = 0, z_mm = 0;
  for (int i = 0; i < 12 && file >> entry; ++i) {
    if (i == 11) z_mm = entry;
  }
  return z_mm;
}

Result<measure::LineError> measure_line(const fs::path& scan, const fs::path& truth) {
  BITELINE_ASSIGN(const line::ClosedLine found, line::read_line(scan / "line.csv"));
  BITELINE_ASSIGN(const line::ClosedLine known, line::read_positions(truth / "groove.csv"));
  return measure::line_error(found, known);
}

std::string millimetres(const ordered_json& json, const char* group, const char* name) {
  if (!json.contains(group) || !json[group].contains(name)) return "-";
  return report::value_text(json[group][name].get<double>(), "mm");
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

/// The host refused a scan that did not reach its end, whatever the shoe looks like.
bool scan_was_cut_short(const std::optional<fs::path>& scan) {
  if (!scan) return false;
  const ordered_json report = read_json(*scan / "report.json");
  return report.contains("reason") && report["reason"].get<std::string>().starts_with("the scan is not complete");
}

Result<void> write_page(const Options& options, const fs::path& scan, const std::string& verdict, bool good, const std::optional<measure::LineError>& error) {
  using report::Page;
  const ordered_json line = read_json(scan / "report.json"), plan = read_json(scan / "path/report.json"),
                     followed = read_json(scan / "followed.json");
  const std::string folder = scan.filename();
  Page page{"Biteline demo", verdict, good ? Page::Mood::Good : Page::Mood::Refused};
  page.paragraph("Simulated: the shoe (class " + options.shoe + ", seed " + std::to_string(options.seed) +
                 "), the pictures, the arm and its controller. Real: the sensor program, the host service, and the protocols between all of them.");
  page.heading("How good");
  std::vector<std::pair<std::string, std::string>> figures;
  if (error) {
    figures.emplace_back("line from the cell's own groove, mean", report::value_text(error->mean_mm, "mm"));
    figures.emplace_back("95 % of it within", report::value_text(error->p95_mm, "mm"));
    figures.emplace_back("largest", report::value_text(error->max_mm, "mm"));
  }
  if (line.contains("confidence")) figures.emplace_back("the host's own confidence", report::value_text(line["confidence"].get<double>(), ""));
  figures.emplace_back("arm's recorded track from the planned path, mean", millimetres(followed, "from_path_mm", "mean"));
  figures.emplace_back("largest", millimetres(followed, "from_path_mm", "max"));
  figures.emplace_back("arm's recorded track from the line (process offset taken off), mean", millimetres(followed, "from_line_mm", "mean"));
  figures.emplace_back("largest", millimetres(followed, "from_line_mm", "max"));
  page.figures(figures);

  page.heading("How long");
  std::vector<std::pair<std::string, double>> stages;
  for (const auto* report_json : {&line, &plan}) {
    if (!report_json->contains("stages")) continue;
    for (const auto& [name, seconds] : (*report_json)["stages"].items()) stages.emplace_back(name, seconds.get<double>());
  }
  if (line.contains("extraction_s")) {
    for (const auto& [name, seconds] : line["extraction_s"].items()) stages.emplace_back("extract: " + name, seconds.get<double>());
  }
  page.durations(stages);
  if (fs::exists(scan / "path/tracking.html")) {
    page.heading("The arm following the line");
    page.frame(folder + "/path/tracking.html", 1010);
  }
  page.heading("What each stage saw");
  for (const auto& [file, caption] : stages::pictures(scan / "stages")) page.picture(folder + "/stages/" + file, caption);
  page.link(folder + "/index.html", "the scan's own page");
  return page.write(options.out / "index.html");
}

Result<ExitStatus> demo(const Options& options, const GlobalOptions& global) {
  BITELINE_TRY(report::prepare_folder(options.out));
  const std::optional<fs::path> earlier = newest_scan(options.out);  // of an earlier demo: kept
  const fs::path cell_folder = fs::absolute(options.out) / "cell";
  const auto say = [&](const char* words) {
    if (!global.quiet) std::printf("%s\n", words), std::fflush(stdout);
  };

  // Each program dies with this one, and each Server stops its program when it goes, whatever happens below.
  say("starting the simulated cell, the sensor and the host service");
  BITELINE_ASSIGN(Server cell, start_server("biteline-cell", {"serve", "--seed", std::to_string(options.seed), "--shoe", options.shoe, "--arm",
                                                              options.arm, "--out", cell_folder.string()}));
  BITELINE_ASSIGN(const std::string wires, endpoint(cell, "wires"));
  BITELINE_ASSIGN(const std::string calibration, endpoint(cell, "sensor"));
  BITELINE_ASSIGN(const std::string rtde, endpoint(cell, "rtde"));
  BITELINE_ASSIGN(const std::string script, endpoint(cell, "script"));
  BITELINE_ASSIGN(Server sensor, start_server("biteline-sensor", {"--source", "cell:" + wires, "--sensor", calibration, "--rt", "ignore"}));
  BITELINE_ASSIGN(const std::string stream, endpoint(sensor, "endpoint"));
  const std::vector<std::string> host_arguments{
      "--sensor", stream, "--out", options.out.string(), "--robot", options.arm, "--process", options.process.string(), "--table-z",
      std::to_string(table_z_mm(cell_folder / "truth")), "--rtde", rtde, "--script", script, "--send", "--once", "--exit-with-parent"};
  // On a machine that is busy with other things frames may come too late, and the laser's guard then, rightly, ends the scan.
  constexpr int k_most_scans = 3;
  int host_status = 0;
  std::string last_words;
  for (int scans = 1; scans <= k_most_scans; ++scans) {
    BITELINE_ASSIGN(ChildProcess host, ChildProcess::start({.program = process::program_folder() / "biteline-host",
                                                            .arguments = host_arguments, .pass_stderr = true}));
    BITELINE_ASSIGN(host_status, attend(host, global.quiet));
    last_words = host.last_words();
    if (!scan_was_cut_short(newest_scan(options.out))) break;
    if (scans < k_most_scans) say("the scan was cut short: scanning again");
  }
  sensor.child.stop();
  cell.child.stop();  // writes its record of the arm's track

  const std::optional<fs::path> newest = newest_scan(options.out);
  if (!newest || newest == earlier) return fail(Errc::ProcessDied, "biteline-host left no result (status %d): %s", host_status, last_words.c_str());
  const fs::path& scan = *newest;
  std::optional<measure::LineError> error;
  std::string verdict = "the host service ended with status " + std::to_string(host_status) + ": " + last_words;
  if (const ordered_json plan = read_json(scan / "path/report.json"); plan.contains("reason")) verdict = "no path: " + plan["reason"].get<std::string>();
  if (fs::exists(scan / "line.csv")) {
    BITELINE_ASSIGN(error, measure_line(scan, cell_folder / "truth"));
    char text[200];
    std::snprintf(text, sizeof text, "line within %.3f mm of the cell's groove on average, %.3f mm at most", error->mean_mm, error->max_mm);
    verdict = host_status == 0 ? text : std::string(text) + "; " + verdict;
  } else if (const ordered_json refused = read_json(scan / "report.json"); refused.contains("reason")) {
    verdict = "refused: " + refused["reason"].get<std::string>();
  }
  BITELINE_TRY(write_page(options, scan, verdict, host_status == 0, error));
  if (!global.quiet) {
    std::printf("%s\n", verdict.c_str());
    const ordered_json followed = read_json(scan / "followed.json");
    std::printf("arm's recorded track from the line: mean %s, largest %s\n", millimetres(followed, "from_line_mm", "mean").c_str(),
                millimetres(followed, "from_line_mm", "max").c_str());
    std::printf("open %s\n", (options.out / "index.html").c_str());
  }
  if (host_status == static_cast<int>(ExitStatus::Done)) return ExitStatus::Done;
  return host_status == static_cast<int>(ExitStatus::Refused) ? ExitStatus::Refused : ExitStatus::Connection;
}

}  // namespace

void add_demo(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  options->process = process_file("grind");
  CLI::App* command = app.add_subcommand("demo", "The main job without hardware: simulated cell, real sensor program and host service");
  command->add_option("--out", options->out, "Result folder")->capture_default_str();
  command->add_option("--seed", options->seed, "Which made shoe")->capture_default_str();
  command->add_option("--shoe", options->shoe, "Class of made shoe (biteline-cell serve --help)")->capture_default_str();
  command->add_option("--arm", options->arm, "ur3e, ur5e or ur10e")->capture_default_str();
  command->add_option("--process", options->process, "Process YAML; default: grind");
  command->callback([options, &context] { context.run = [options, &context] { return demo(*options, context.options); }; });
}

}  // namespace biteline::app
