// SPDX-License-Identifier: MIT
#pragma once
/// \file A program that answers as `biteline extract` does: each cloud's file is its line.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "host/records/batch/run.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::test {

/// `spoil` names a cloud whose line this build moves by half a millimetre in x.
/// Clouds called crash.., hang.., refuse.., review.., eat.., bad.. do as their names say.
inline std::string fake_program(const std::string& spoil = "nothing") {
  return R"sh(#!/bin/sh
cloud=$2
while [ "$1" != --out ]; do shift; done
out=$2
mkdir -p "$out"
echo "$cloud" >> "$(dirname "$0")/asked.txt"
case $(basename "$cloud") in
  crash*) kill -SEGV $$ ;;
  hang*) sleep 1000 & wait ;;
  eat*) echo 'fake: out of memory: raise the limit' >&2; exit 4 ;;
  bad*) echo "fake: $cloud row 3: 3 numbers expected" >&2; exit 2 ;;
  refuse*) echo '{"status": "refused", "reason_code": "no_crease", "reason": "made so"}' > "$out/report.json"; exit 3 ;;
esac
status=ok
ends=0
case $(basename "$cloud") in review*) status=review; ends=5 ;; esac
echo '{"status": "'$status'", "length_mm": 400, "confidence": 0.9, "u95": {"pooled_mm": 0.05, "max_mm": 0.06}}' > "$out/report.json"
if [ "$(basename "$cloud")" = )sh" +
         spoil + R"sh( ]; then
  awk -F, 'BEGIN { OFS = "," } /^#/ { print; next } { $1 += 0.5; print }' "$cloud" > "$out/line.csv"
else
  cp "$cloud" "$out/line.csv"
fi
exit $ends
)sh";
}

/// A circle of 63 mm as line.csv, its points' U95 0.06 mm.
inline std::string circle_csv(double x_mm) {
  std::string text =
      "#x [mm],y [mm],z [mm],nx [],ny [],nz [],tx [],ty [],tz [],confidence [],u95 [mm],flags [],source []\n";
  constexpr int k_points = 200;
  for (int i = 0; i < k_points; ++i) {
    const double a = 2 * 3.14159265358979 * i / k_points;
    char row[256];
    std::snprintf(row, sizeof row, "%.9f,%.9f,10,%.9f,%.9f,0,%.9f,%.9f,0,0.9,0.06,0,seen\n",
                  x_mm + 63 * std::cos(a), 63 * std::sin(a), std::cos(a), std::sin(a), -std::sin(a),
                  std::cos(a));
    text += row;
  }
  return text;
}

/// A folder of made clouds, a program and a batch.
class FakeBatch {
 public:
  void add_cloud(const std::string& name, double x_mm = 0) {
    // Equal contents are one recording to the store.
    folder_.write("clouds/" + name, circle_csv(x_mm) + "# " + name + "\n");
  }

  /// A plan of what was added, with one recording a shard, run by a build of its own.
  batch::BatchRun planned(const std::string& program, const std::string& name = "bin") {
    namespace fs = std::filesystem;
    const fs::path file = folder_.write(name + "/biteline", program);
    fs::permissions(file, fs::perms::owner_all);
    auto recordings = batch::find_recordings(folder_.path() / "clouds");
    SUCCEEDS(recordings);
    auto plan = batch::make_plan({.recordings = *recordings, .settings = {}, .shard_s = 0, .jobs = 2});
    SUCCEEDS(plan);
    auto build = batch::build_of(file, {});
    SUCCEEDS(build);
    batch::BatchRun run{.folder = folder_.path() / "batch", .plan = *plan, .build = *build, .limits = {}};
    SUCCEEDS(batch::write_plan(run.folder, run.plan));
    SUCCEEDS(batch::begin_run(run));
    return run;
  }
  [[nodiscard]] std::string read(const std::filesystem::path& file) const {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  /// How often the program of `bin` was started.
  [[nodiscard]] long asked() const {
    const std::string text = read(folder_.path() / "bin/asked.txt");
    return std::count(text.begin(), text.end(), '\n');
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace biteline::test
