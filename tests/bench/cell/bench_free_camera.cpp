// SPDX-License-Identifier: MIT
// bench_free_camera [SHOES [FIRST_SEED [RATE]]]: what a camera without a trigger costs the line.  A UR10e
// scans made shoes in the cell's real world, at 50, 100 and 250 mm/s; the same pictures are then stamped as a
// camera that runs freely would have them, and the line is found again.  A shoe takes about a minute of one
// core.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/session/session.hpp"
#include "hal/sim/record/arrival_stamps.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::bench {
namespace {

namespace fs = std::filesystem;

struct Camera {
  const char* name;
  sim::ArrivalStamps stamps;
};
constexpr std::array k_cameras{
    Camera{"stamps of its own clock, arrivals late by 1 ms", {.jitter_ms = 1, .camera_stamps = true}},
    Camera{"stamped at arrival, jitter 1 ms", {.jitter_ms = 1}},
    Camera{"stamped at arrival, jitter 3 ms", {.jitter_ms = 3}},
    Camera{"stamped at arrival, jitter 1 ms, 5 ms of the delay not calibrated",
           {.jitter_ms = 1, .unknown_late_ms = 5}},
};

bool ran(const std::string& command) {
  return std::system((command + " >/dev/null").c_str()) == 0;
}

struct Line {
  double mean_mm{0}, p95_mm{0}, max_mm{0}, complete_ratio{0};
};

/// Nothing when no line was found.
std::optional<Line> line_of(const fs::path& session, const fs::path& work) {
  const std::string result = work / "result", measures = work / "measures.json";
  fs::remove_all(result);
  if (!ran(std::string(BITELINE_TOOL) + " replay " + session.string() + " --quiet --out " + result) ||
      std::system((std::string(BITELINE_TOOL) + " evaluate --json --line " + result + "/line.csv --truth " +
                   session.string() + "/truth/groove.csv >" + measures)
                      .c_str()) != 0)
    return std::nullopt;
  std::ifstream in(measures);
  const auto told = nlohmann::json::parse(in, nullptr, false);
  if (!told.contains("mean") || !told.contains("p95")) return std::nullopt;
  return Line{.mean_mm = told.value("mean", 0.0),
              .p95_mm = told.value("p95", 0.0),
              .max_mm = told.value("max", 0.0),
              .complete_ratio = told.value("complete", 0.0)};
}

/// Of all shoes at one speed: means, and the largest of the largest.
struct Sum {
  int lines{0};
  Line of;

  void add(const std::optional<Line>& line) {
    if (!line) return;
    ++lines;
    of.mean_mm += line->mean_mm;
    of.p95_mm += line->p95_mm;
    of.max_mm = std::max(of.max_mm, line->max_mm);
    of.complete_ratio += line->complete_ratio;
  }
};

void print(int speed_mm_s, const char* camera, const Sum& sum, int shoes) {
  const auto row = [&](const char* what, double value, const char* unit) {
    std::printf(
        "{\"bench\":\"cell.free_camera\",\"what\":\"%d mm/s, %s: %s\",\"ours\":%.4g,\"unit\":\"%s\"}\n",
        speed_mm_s, camera, what, value, unit);
  };
  if (sum.lines < shoes) row("shoes without a line", shoes - sum.lines, "");
  if (sum.lines > 0) {
    row("line, mean error", sum.of.mean_mm / sum.lines, "mm");
    row("line, p95", sum.of.p95_mm / sum.lines, "mm");
    row("line, largest error", sum.of.max_mm, "mm");
    row("line, complete", 100 * sum.of.complete_ratio / sum.lines, "%");
  }
  std::fflush(stdout);
}

struct Sums {
  Sum triggered;
  std::array<Sum, k_cameras.size()> free;
};

struct Scan {
  int speed_mm_s, rate_hz, seed;
};

Result<void> measure(const Scan& scan, Sums& sums) {
  const test::TemporaryFolder folder;
  const fs::path recording = folder.path() / "session";
  if (!ran(std::string(BITELINE_CELL) + " record --arm ur10e --world real --size 42 --seed " +
           std::to_string(scan.seed) + " --speed-mm-s " + std::to_string(scan.speed_mm_s) + " --rate-hz " +
           std::to_string(scan.rate_hz) + " --out " + recording.string()))
    return fail(Errc::InvalidArgument, "the cell did not record seed %d at %d mm/s", scan.seed,
                scan.speed_mm_s);
  sums.triggered.add(line_of(recording, folder.path()));
  BITELINE_ASSIGN(const session::Session exact, session::read_session(recording));
  std::vector<SensorClock::time_point> mids;
  for (const session::FrameEntry& frame : exact.frames) mids.push_back(frame.exposure_mid);
  for (std::size_t camera = 0; camera < k_cameras.size(); ++camera) {
    const auto stamps =
        sim::arrival_stamps(mids, k_cameras[camera].stamps, static_cast<std::uint64_t>(scan.seed));
    std::vector<session::FrameEntry> frames = exact.frames;
    for (std::size_t i = 0; i < frames.size(); ++i) frames[i].exposure_mid = stamps[i];
    BITELINE_TRY(session::write_frame_table(recording / "cam0/data.csv", frames));
    sums.free[camera].add(line_of(recording, folder.path()));
  }
  return {};
}

}  // namespace
}  // namespace biteline::bench

int main(int count, char** words) {
  using namespace biteline::bench;
  const auto number = [&](int at, int otherwise) {
    return count > at ? std::max(1, std::atoi(words[at])) : otherwise;
  };
  const int shoes = number(1, 1), first_seed = number(2, 2), rate_hz = number(3, 100);
  for (const int speed_mm_s : {50, 100, 250}) {
    Sums sums;
    for (int seed = first_seed; seed < first_seed + shoes; ++seed) {
      const auto done = measure({.speed_mm_s = speed_mm_s, .rate_hz = rate_hz, .seed = seed}, sums);
      if (done) continue;
      std::fprintf(stderr, "bench_free_camera: %s\n", biteline::to_line(done.error()).c_str());
      return 1;
    }
    print(speed_mm_s, "triggered", sums.triggered, shoes);
    for (std::size_t i = 0; i < k_cameras.size(); ++i)
      print(speed_mm_s, k_cameras[i].name, sums.free[i], shoes);
  }
}
