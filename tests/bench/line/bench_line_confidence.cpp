// SPDX-License-Identifier: MIT
// Is confidence the probability that a point lies within 0.3 mm of the bite line?  The sweep's made shoes,
// with decoys, faults and missing sectors; on shapes with label truth, within 1.3 mm.
//
// --points: one row for each fourth station of every line that was placed, written or refused: what its
// confidence is made of.  Prints the tenths of what was written; shoes are resampled for the interval.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/parallel_for_each.h>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/place/point_spread.hpp"
#include "host/cloud/ply.hpp"
#include "host/cloud/uncertainty/radius.hpp"
#include "tests/bench/line/drawn_anew.hpp"
#include "tests/bench/line/sweep_options.hpp"
#include "tests/support/line_distance.hpp"
#include "tests/support/line_sweep.hpp"
#include "tests/support/shape_truth.hpp"

namespace biteline::bench {
namespace {

/// Of one shoe, per tenth of the confidence.
struct Tenth {
  double points{0}, claimed{0}, held{0};
};
using Tenths = std::array<Tenth, 10>;

/// Beside a chord, a step of more than 3 mm where the truth is not known, it is not a number.
double error_mm_of(const Vec3& point, const cloud::ClosedLine& truth) {
  constexpr double k_chord_mm = 3;
  const test::NearestOnLine nearest = test::nearest_on(truth, point);
  const Vec3 edge =
      truth.points[(nearest.edge + 1) % truth.points.size()].position - truth.points[nearest.edge].position;
  return edge.norm() > k_chord_mm ? std::numeric_limits<double>::quiet_NaN() : nearest.distance_mm;
}

/// Beside a chord, a step of more than 3 mm where the truth is not known, it is not a number.
Tenths tenths_of(const cloud::ClosedLine& line, const cloud::ClosedLine& truth, double within_mm) {
  Tenths tenths{};
  for (const cloud::LinePoint& p : line.points) {
    const double error_mm = error_mm_of(p.position, truth);
    if (std::isnan(error_mm)) continue;
    Tenth& tenth = tenths.at(static_cast<std::size_t>(std::clamp(p.confidence * 10, 0.0, 9.0)));
    tenth.points += 1;
    tenth.claimed += p.confidence;
    tenth.held += error_mm <= within_mm ? 1 : 0;
  }
  return tenths;
}

void print(const char* what, double within_mm, const std::vector<Tenths>& shoes) {
  for (std::size_t i = 0; i < Tenths{}.size(); ++i) {
    Tenth sum;
    int with = 0;
    std::vector<ShoeShare> differences;
    for (const Tenths& one : shoes) {
      differences.push_back({.part = one.at(i).held - one.at(i).claimed, .whole = one.at(i).points});
      sum.points += one.at(i).points;
      sum.claimed += one.at(i).claimed;
      sum.held += one.at(i).held;
      with += one.at(i).points > 0 ? 1 : 0;
    }
    if (sum.points < 1) continue;
    const auto [low, high] = drawn_anew(differences);
    std::printf(
        "{\"bench\":\"line.confidence\",\"what\":\"%s: share within %.1f mm of points that claim %.3f\","
        "\"ours\":%.4f,\"unit\":\"share\",\"target\":%.4f,\"points\":%.0f,\"shoes\":%d,"
        "\"difference\":%.4f,\"from\":%.4f,\"to\":%.4f}\n",
        what, within_mm, sum.claimed / sum.points, sum.held / sum.points, sum.claimed / sum.points,
        sum.points, with, (sum.held - sum.claimed) / sum.points, low, high);
  }
}

/// What the confidence is made of, and how far off the point is.
void write_points(std::FILE* out, const std::string& name, const bite_line::Workings& workings,
                  const bite_line::Extraction& found, const cloud::ClosedLine& truth) {
  const auto& placed = workings.placed.points;
  for (std::size_t i = 0; i < placed.size(); i += 4) {
    const bite_line::PlacedStation& p = placed[i];
    const double error_mm = error_mm_of(found.T_base_shoe * p.position, truth);
    if (std::isnan(error_mm)) continue;
    const bite_line::PointSpread own = bite_line::spread_of(p);
    const double u95_mm =
        uncertainty::u95_mm(uncertainty::principal_axes(own.covariance_mm2), own.hold, own.other_mm);
    std::fprintf(
        out, "%s,%d,%.5f,%.5f,%.3f,%.5f,%.4f,%.4f,%.4f,%.4f,%.4f,%.5f,%.5f,%.4f,%.2f,%.5f,%.4f,%.4f\n",
        name.c_str(), found.found ? 1 : 0, workings.decision.of_line, p.hold, p.other_mm, p.doubt,
        p.corner_mm, p.tried_out_mm, p.tried_up_mm, p.sharp, p.own_z_mm - p.position.z(), p.scatter_mm,
        p.noise.outward_mm, p.noise.slope, p.to_visible_mm, own.within, u95_mm, error_mm);
  }
}

int run(int argc, char** argv) {
  SweepOptions asked;
  std::size_t threads = 2;
  std::string points_file, fault;
  options::Command command{"Is confidence a probability?", "bench_line_confidence"};
  asked.add_to(command);
  command.add_option("--fault", fault, "clouds with this fault alone");
  command.add_option("--threads", threads, "so many at once");
  command.add_option("--points", points_file, "rows of stations go there");
  if (const std::optional<int> status = read_options(command, argc, argv)) return *status;
  std::FILE* out = points_file.empty() ? nullptr : std::fopen(points_file.c_str(), "w");
  if (out != nullptr)
    std::fprintf(out,
                 "class,decoy,fault,seed,written,of_line,hold,other_mm,doubt,corner_mm,tried_out_mm,"
                 "tried_up_mm,sharp,jump_mm,scatter_mm,outward_mm,slope,to_visible_mm,within,u95_mm,"
                 "error_mm\n");
  const tbb::global_control limit{tbb::global_control::max_allowed_parallelism, threads};
  std::mutex mutex;
  std::map<std::uint64_t, Tenths> made;
  tbb::parallel_for_each(asked.indices(), [&](std::uint64_t index) {
    const test::SweepCell cell = test::sweep_cell(asked.seed, index);
    const bool fits = asked.asks_for(cell) && (fault.empty() || fault == test::name_of(cell.fault));
    if (!cell.is_shoe() || !fits) return;
    const test::SweepScan scan = test::scan_of(cell);
    std::optional<bite_line::Workings> workings;
    const bite_line::Extraction found = bite_line::find_bite_line(scan.cloud, {}, &workings);
    const Tenths tenths = tenths_of(found.line, scan.truth, 0.3);
    const std::scoped_lock lock{mutex};
    if (found.found) made[index] = tenths;
    if (out != nullptr && workings)
      write_points(out,
                   std::string{sim::name_of(cell.shoe.shoe_class)} + "," +
                       std::string{sim::name_of(cell.shoe.decoy)} + "," +
                       std::string{test::name_of(cell.fault)} + "," + std::to_string(index),
                   *workings, found, scan.truth);
  });
  std::vector<Tenths> shoes;
  for (const auto& [index, tenths] : made) shoes.push_back(tenths);
  if (!shoes.empty()) print((std::to_string(shoes.size()) + " made shoes").c_str(), 0.3, shoes);

  std::vector<Tenths> shapes;
  for (const test::Shape& shape : test::k_shapes) {
    const auto cloud = test::cloud_of(shape);
    const auto truth = test::truth_of(shape);
    if (!cloud || !truth || truth->line.points.empty()) continue;
    std::optional<bite_line::Workings> workings;
    const bite_line::Extraction found = bite_line::find_bite_line(*cloud, {}, &workings);
    if (found.found) shapes.push_back(tenths_of(found.line, truth->line, 1.3));
    if (out != nullptr && workings)
      write_points(out, std::string{"shape,"} + shape.name + ",none,0", *workings, found, truth->line);
  }
  if (!shapes.empty())
    print((std::to_string(shapes.size()) + " shapes with label truth").c_str(), 1.3, shapes);
  if (out != nullptr) std::fclose(out);
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  return biteline::bench::run(argc, argv);
}
