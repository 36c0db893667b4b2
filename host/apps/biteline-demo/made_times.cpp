// SPDX-License-Identifier: MIT
#include "host/apps/biteline-demo/made_times.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "host/apps/biteline-demo/json_file.hpp"

namespace biteline::demo {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double number(const Json& value, const char* pointer) {
  const Json::json_pointer at{pointer};
  return value.contains(at) && value[at].is_number() ? value[at].get<double>() : 0;
}

/// What of a row is needed here.
struct Row {
  long long stamp_ns{0};
  int program{0}, scans{0};
  double time_ratio{1};
};
std::optional<Row> row_of(const std::string& line) {
  Row row;
  const int read =
      std::sscanf(line.c_str(), "%lld,%*f,%*f,%*f,%*f,%*f,%*f,%*f,%d,%*d,%d,%lf",  // NOLINT(cert-err34-c)
                  &row.stamp_ns, &row.program, &row.scans, &row.time_ratio);
  return read == 4 ? std::optional{row} : std::nullopt;
}

double seconds(long long from_ns, long long to_ns) {
  return 1e-9 * static_cast<double>(to_ns - from_ns);
}

}  // namespace

std::optional<ArmTimes> arm_times(std::istream& track) {
  std::optional<Row> begin, end, stands, sets_out, done;
  bool scanned = false;
  for (std::string line; std::getline(track, line);) {
    const std::optional<Row> row = row_of(line);
    if (!row) continue;
    if (row->scans != 0) {
      if (!scanned) begin = row;
      end = stands = row;
      sets_out = done = std::nullopt;
    } else if (end && row->program != 0) {
      if (!sets_out) sets_out = row;
      done = row;
    } else if (end && !sets_out) {
      stands = row;
    }
    scanned = row->scans != 0;
  }
  if (!done) return std::nullopt;
  const double rest_real_s = seconds(end->stamp_ns, stands->stamp_ns);
  return ArmTimes{.scan_s = end->time_ratio * seconds(begin->stamp_ns, end->stamp_ns),
                  .rest_s = end->time_ratio * rest_real_s,
                  .rest_real_s = rest_real_s,
                  .gap_real_s = seconds(end->stamp_ns, sets_out->stamp_ns),
                  .program_s = seconds(sets_out->stamp_ns, done->stamp_ns)};
}

std::optional<MadeTimes> made_times(const fs::path& cell, const fs::path& scan) {
  std::ifstream track(cell / "track.csv");
  const std::optional<ArmTimes> arm = arm_times(track);
  const Json line = read_json(scan / "report.json"), plan = read_json(scan / "path/report.json"),
             followed = read_json(scan / "followed.json");
  if (!arm || !followed.contains("parts_s")) return std::nullopt;
  MadeTimes times{.scan_s = arm->scan_s,
                  .rest_s = arm->rest_s,
                  .line_and_path_s = number(line, "/stages/last profile to line") +
                                     number(line, "/stages/transfer") + number(plan, "/stages/plan"),
                  .approach_s = number(followed, "/parts_s/approach"),
                  .work_s = number(followed, "/parts_s/line"),
                  .retreat_s = number(followed, "/parts_s/retreat")};
  // Computing goes on in real time while the arm comes to rest; a slowed arm takes longer for that than one
  // in made time.
  times.sets_out_s = std::max(times.rest_s, times.line_and_path_s) + arm->gap_real_s -
                     std::max(arm->rest_real_s, times.line_and_path_s);
  times.way_there_s = arm->program_s - times.approach_s - times.work_s - times.retreat_s;
  return times;
}

std::string words(const MadeTimes& times) {
  char text[300];
  std::snprintf(text, sizeof text,
                "in the arm's time: scan %.2f s, %.2f s until it sets out (line and path %.2f s), way there "
                "%.2f s, approach %.2f s, line %.2f s, retreat %.2f s: %.2f s in all",
                times.scan_s, times.sets_out_s, times.line_and_path_s, times.way_there_s, times.approach_s,
                times.work_s, times.retreat_s, times.whole_s());
  return text;
}

}  // namespace biteline::demo
