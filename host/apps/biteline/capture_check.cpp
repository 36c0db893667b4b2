// SPDX-License-Identifier: MIT
// biteline capture check: a piece of known size in a scan, pass or fail, and the history of it.
#include "host/apps/biteline/capture_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>

#include "common/options/command.hpp"
#include "common/system/file.hpp"
#include "host/apps/biteline/cloud_option.hpp"
#include "host/intake/capture/known_piece.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

struct CaptureCheckOptions {
  fs::path cloud, out, history;
  cloud::Reading reading;
  std::optional<double> ball_mm, step_mm;
  double limit_mm{0.1};
};

constexpr const char* k_history_head =
    "#time [UTC],scan,piece,known [mm],measured [mm],off [mm],sigma [mm],limit [mm],verdict\n";

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  char text[40];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

/// One field of the table.
std::string scan_name(const fs::path& cloud) {
  constexpr std::size_t k_longest = 60;
  std::string name = cloud.filename().string().substr(0, k_longest);
  std::ranges::replace_if(
      name, [](unsigned char c) { return c == ',' || c == '"' || c < 0x20 || c == 0x7f; }, '_');
  return name;
}

/// The whole file anew beside it, then renamed: a kill leaves the former rows.
Result<void> add_to_history(const fs::path& file, const std::string& row) {
  std::string text = k_history_head;
  std::error_code error;
  if (fs::exists(file, error)) {
    BITELINE_ASSIGN(text, read_regular_file(file, k_most_table_bytes));
    if (!text.starts_with(k_history_head))
      return fail(Errc::BadFormat, "%s: a history of 'biteline capture check' expected", file.c_str());
  }
  return report::write_file_atomically(file, text + row);
}

Result<ExitStatus> check(const CaptureCheckOptions& options, const GlobalOptions& global) {
  if (options.ball_mm.has_value() == options.step_mm.has_value())
    return fail(Errc::InvalidArgument, "capture check: --ball or --step expected, one of them");
  report::Report report;
  BITELINE_ASSIGN(const cloud::CloudFile file, report.timed("read", [&] {
    return cloud::read_cloud_file(options.cloud, options.reading);
  }));
  std::vector<Vec3> points;
  points.reserve(file.cloud.size());
  for (const Eigen::Vector3f& point : file.cloud.points) points.push_back(point.cast<double>());
  const double known_mm = options.ball_mm ? *options.ball_mm : *options.step_mm;
  BITELINE_ASSIGN(const capture::PieceSize size, report.timed("measure", [&] {
    return options.ball_mm ? capture::measure_ball(points, known_mm)
                           : capture::measure_step(points, known_mm);
  }));
  const char* piece = options.ball_mm ? "ball" : "step";
  const double off_mm = size.size_mm - known_mm;
  const bool passed = std::abs(off_mm) <= options.limit_mm;
  const char* verdict = passed ? "pass" : "fail";
  if (!options.history.empty()) {
    char row[300];
    std::snprintf(row, sizeof row, "%s,%s,%s,%.4f,%.4f,%.4f,%.4f,%.4f,%s\n", utc_now().c_str(),
                  scan_name(options.cloud).c_str(), piece, known_mm, size.size_mm, off_mm, size.sigma_mm,
                  options.limit_mm, verdict);
    BITELINE_TRY(add_to_history(options.history, row));
  }
  if (global.json) {
    report.fields["check"] = {
        {"piece", piece},        {"known_mm", known_mm},         {"measured_mm", size.size_mm},
        {"off_mm", off_mm},      {"sigma_mm", size.sigma_mm},    {"rms_mm", size.rms_mm},
        {"points", size.points}, {"limit_mm", options.limit_mm}, {"passed", passed}};
    std::fputs(report.text().c_str(), stdout);
  } else if (!global.quiet) {
    std::printf("%s: %s of %.3f mm is %.3f mm in the scan, off by %+.3f mm (known to %.3f), limit %.3f mm\n",
                verdict, piece, known_mm, size.size_mm, off_mm, size.sigma_mm, options.limit_mm);
    if (!passed) std::printf("look with: biteline calibrate CALIB --out result --compare sensor.yaml\n");
  }
  return passed ? ExitStatus::Done : ExitStatus::Refused;
}

}  // namespace

void add_capture_check(options::Command& capture, Context& context) {
  auto options = std::make_shared<CaptureCheckOptions>();
  options::Command* command = capture.add_subcommand(
      "check", "A piece of known size in a scan: is what the scan says within a limit?");
  command->add_option("CLOUD", options->cloud, std::string{"The scan's cloud: "} + k_cloud_kinds)->required();
  add_reading_options(*command, options->reading);
  command->add_option("--ball", options->ball_mm, "A ball of this diameter")
      ->check(options::number({.minimum = 1, .maximum = 1000}, "mm"));
  command->add_option("--step", options->step_mm, "A step of this height between two parallel faces")
      ->check(options::number({.minimum = 1, .maximum = 500}, "mm"));
  command->add_option("--limit-mm", options->limit_mm, "Farther off than this fails")
      ->check(options::number({.minimum = 0.001, .maximum = 100}, "mm"))
      ->capture_default_str();
  command->add_option("--history", options->history, "A table that gets a row for each check");
  command->callback([options, &context] {
    context.run = [options, &context] { return check(*options, context.options); };
  });
}

}  // namespace biteline::app
