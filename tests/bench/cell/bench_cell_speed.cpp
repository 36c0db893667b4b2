// SPDX-License-Identifier: MIT
// bench_cell_speed [SHOES [FIRST_SEED [SPEED RATE]]]: how good the line is at each speed of the scan, on a
// UR10e whose joints give, and what limits it.  Time is the simulated robot's.  Each shoe is scanned three
// times:
//   ideal  an exact arm and pictures of an instant: what remains comes of the frame rate and the stripe
//   stiff  the real world's light, blur and speckle: what it adds comes of the exposure
//   real   the arm's give, lag and latency too: what they add comes of vibration
// The largest of the three, added as squares, is what limits.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double k_flagged_confidence = 0.5, k_flagged_u95_mm = 1;

struct Figures {
  double mean_mm{0}, p95_mm{0}, complete_ratio{0}, flagged_ratio{0}, u95_mm{0}, within_ratio{0}, scan_s{0};
};

bool ran(const std::string& command) {
  return std::system((command + " >/dev/null").c_str()) == 0;
}

Json read_json(const fs::path& file) {
  std::ifstream in(file);
  return Json::parse(in, nullptr, false);
}

using Place = std::array<double, 3>;

/// From the closed line of `truth`.
double off_mm(const Place& place, const std::vector<Place>& truth) {
  double least_mm2 = HUGE_VAL;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Place &a = truth[i], &b = truth[(i + 1) % truth.size()];
    double along = 0, length = 0, apart = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      along += (place[k] - a[k]) * (b[k] - a[k]);
      length += (b[k] - a[k]) * (b[k] - a[k]);
    }
    const double share = std::clamp(along / std::max(length, 1e-12), 0.0, 1.0);
    for (std::size_t k = 0; k < 3; ++k) apart += std::pow(place[k] - a[k] - share * (b[k] - a[k]), 2);
    least_mm2 = std::min(least_mm2, apart);
  }
  return std::sqrt(least_mm2);
}

Place place_of(const std::vector<std::string>& fields) {
  return {std::atof(fields[0].c_str()), std::atof(fields[1].c_str()), std::atof(fields[2].c_str())};
}

std::vector<std::string> fields_of(const std::string& row) {
  std::vector<std::string> fields;
  std::string field;
  for (std::stringstream text(row); std::getline(text, field, ',');) fields.push_back(field);
  return fields;
}

std::vector<Place> read_truth(const fs::path& file) {
  std::ifstream in(file);
  std::vector<Place> places;
  std::string row;
  std::getline(in, row);
  while (std::getline(in, row)) {
    if (const auto fields = fields_of(row); fields.size() >= 3) places.push_back(place_of(fields));
  }
  return places;
}

/// Shares of flagged points and of those within their U95, and the mean U95 of a line.csv.
void read_line(const fs::path& file, const std::vector<Place>& truth, Figures& figures) {
  std::ifstream in(file);
  std::string row, field;
  std::getline(in, row);
  std::vector<std::string> names;
  for (std::stringstream head(row); std::getline(head, field, ',');)
    names.push_back(field.substr(0, field.find(' ')));
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const std::size_t confidence = column("confidence"), u95 = column("u95");
  int points = 0, flagged = 0, within = 0;
  while (std::getline(in, row)) {
    const std::vector<std::string> fields = fields_of(row);
    if (fields.size() <= std::max(confidence, u95)) continue;
    const double u95_mm = std::atof(fields[u95].c_str());
    ++points;
    figures.u95_mm += u95_mm;
    if (std::atof(fields[confidence].c_str()) < k_flagged_confidence || u95_mm > k_flagged_u95_mm) ++flagged;
    if (off_mm(place_of(fields), truth) <= u95_mm) ++within;
  }
  if (points == 0) return;
  figures.u95_mm /= points;
  figures.flagged_ratio = static_cast<double>(flagged) / points;
  figures.within_ratio = static_cast<double>(within) / points;
}

/// False when there is no line.
bool scan(const std::string& scene, const char* world, Figures& figures) {
  const biteline::test::TemporaryFolder folder;
  const std::string session = folder.path() / "session", result = folder.path() / "result",
                    measures = folder.path() / "measures.json";
  if (!ran(std::string(BITELINE_CELL) + " record --arm ur10e " + scene + " " + world + " --out " + session) ||
      !ran(std::string(BITELINE_TOOL) + " replay " + session + " --quiet --out " + result))
    return false;
  const std::string evaluate = std::string(BITELINE_TOOL) + " evaluate --json --line " + result +
                               "/line.csv --truth " + session + "/truth/groove.csv >" + measures;
  if (std::system(evaluate.c_str()) != 0) return false;
  const Json told = read_json(measures), report = read_json(fs::path(result) / "report.json");
  // A figure that is missing is no perfect one.
  if (!told.contains("mean") || !told.contains("p95") || !report.contains("scan")) return false;
  figures = {.mean_mm = told.value("mean", 0.0),
             .p95_mm = told.value("p95", 0.0),
             .complete_ratio = told.value("complete", 0.0),
             .scan_s = report["scan"].value("duration_s", 0.0)};
  read_line(fs::path(result) / "line.csv", read_truth(fs::path(session) / "truth" / "groove.csv"), figures);
  return true;
}

void row(int speed_mm_s, int rate_hz, const char* what, double value, const char* unit, const char* target) {
  std::printf("{\"bench\":\"cell.speed\",\"what\":\"%d mm/s, %d Hz: %s\",\"ours\":%.4g,\"unit\":\"%s\"",
              speed_mm_s, rate_hz, what, value, unit);
  if (target[0] != '\0') std::printf(",\"target\":\"%s\"", target);
  std::printf("}\n");
  std::fflush(stdout);
}

const char* limit_of(double rate_mm, double exposure_mm, double vibration_mm) {
  if (vibration_mm >= std::max(rate_mm, exposure_mm)) return "limited by vibration";
  return exposure_mm >= rate_mm ? "limited by the exposure" : "limited by the frame rate";
}

/// What `more` has beyond `less`, as squares.
double beyond_mm(double more, double less) {
  return std::sqrt(std::max(0.0, more * more - less * less));
}

bool measure(int speed_mm_s, int rate_hz, int shoes, int first_seed) {
  const std::array worlds{"--world ideal", "--world real --elastic-hz 0 --following-ms 0 --latency-ms 0",
                          "--world real"};
  std::array<double, 3> mean_mm{};
  Figures sum;
  int lines = 0;
  for (int seed = first_seed; seed < first_seed + shoes; ++seed) {
    const std::string scene = "--seed " + std::to_string(seed) + " --size 42 --speed-mm-s " +
                              std::to_string(speed_mm_s) + " --rate-hz " + std::to_string(rate_hz);
    std::array<Figures, 3> figures;
    bool all = true;
    for (std::size_t i = 0; i < worlds.size(); ++i) all = scan(scene, worlds[i], figures[i]) && all;
    if (!all) continue;
    ++lines;
    for (std::size_t i = 0; i < worlds.size(); ++i) mean_mm[i] += figures[i].mean_mm;
    sum.p95_mm += figures[2].p95_mm;
    sum.complete_ratio += figures[2].complete_ratio;
    sum.flagged_ratio += figures[2].flagged_ratio;
    sum.u95_mm += figures[2].u95_mm;
    sum.within_ratio += figures[2].within_ratio;
    sum.scan_s += figures[2].scan_s;
  }
  row(speed_mm_s, rate_hz, "shoes with a line in all three worlds", lines, "", std::to_string(shoes).c_str());
  if (lines == 0) return false;
  for (double& mean : mean_mm) mean /= lines;
  const double rate_mm = mean_mm[0], exposure_mm = beyond_mm(mean_mm[1], mean_mm[0]),
               vibration_mm = beyond_mm(mean_mm[2], mean_mm[1]);
  const char* bar = speed_mm_s <= 250 ? "0.05" : "0.1";
  row(speed_mm_s, rate_hz, "scan, way and ramps within ScanActive", sum.scan_s / lines, "s", "3");
  row(speed_mm_s, rate_hz, "line, mean error", mean_mm[2], "mm", bar);
  row(speed_mm_s, rate_hz, "line, p95", sum.p95_mm / lines, "mm", "");
  row(speed_mm_s, rate_hz, "line, complete", 100 * sum.complete_ratio / lines, "%", "95");
  row(speed_mm_s, rate_hz, "flagged", 100 * sum.flagged_ratio / lines, "%", "5");
  row(speed_mm_s, rate_hz, "U95, mean", sum.u95_mm / lines, "mm", "");
  row(speed_mm_s, rate_hz, "points within their U95", 100 * sum.within_ratio / lines, "%", "95");
  row(speed_mm_s, rate_hz, "of frame rate and stripe", rate_mm, "mm", "");
  row(speed_mm_s, rate_hz, "of exposure, light and speckle", exposure_mm, "mm", "");
  row(speed_mm_s, rate_hz, "of vibration", vibration_mm, "mm", "");
  row(speed_mm_s, rate_hz, limit_of(rate_mm, exposure_mm, vibration_mm),
      std::max({rate_mm, exposure_mm, vibration_mm}), "mm", "");
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const int shoes = argc > 1 ? std::max(1, std::atoi(argv[1])) : 1;
  const int first_seed = argc > 2 ? std::max(1, std::atoi(argv[2])) : 2;
  std::vector<std::pair<int, int>> settings{{100, 100}, {250, 100}, {250, 200}, {500, 100}, {500, 200}};
  if (argc > 4) settings = {{std::max(1, std::atoi(argv[3])), std::max(1, std::atoi(argv[4]))}};
  bool good = true;
  for (const auto& [speed_mm_s, rate_hz] : settings)
    good = measure(speed_mm_s, rate_hz, shoes, first_seed) && good;
  return good ? 0 : 1;
}
