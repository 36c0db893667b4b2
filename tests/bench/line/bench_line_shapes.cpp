// SPDX-License-Identifier: MIT
// The line on shapes that nobody here designed: right, flagged, refused or wrong, as they are and turned,
// tilted, mirrored, noisier.
//
// Where no truth is known, the sure part of the line on the shape as it is, which was looked at, is all
// others'.
// --points: one row for each placed station, written or refused: where it is, what its confidence is made of,
// and how far off the known line.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/place/point_spread.hpp"
#include "host/bite_line/published/published_line.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/ply.hpp"
#include "host/cloud/uncertainty/radius.hpp"
#include "tests/bench/line/sweep_options.hpp"
#include "tests/support/line_distance.hpp"
#include "tests/support/shape_truth.hpp"
#include "tests/support/shape_warp.hpp"

namespace biteline::bench {
namespace {

/// A shape, or another one made of it.
struct Variant {
  std::string name;
  test::ShapeWarp warp;
};

std::vector<Variant> variants() {
  constexpr double k_to_rad = std::numbers::pi / 180;
  constexpr std::uint32_t k_seed = 7;
  const double tilt_to_rad = std::atan2(0.6, 0.8);
  return {{"turned", {.yaw_rad = 140 * k_to_rad}},
          {"tilted", {.yaw_rad = -40 * k_to_rad, .tilt_rad = 5 * k_to_rad, .tilt_to_rad = tilt_to_rad}},
          {"mirrored", {.mirrored = true}},
          {"noisier", {.yaw_rad = 20 * k_to_rad, .noise_mm = 0.05, .seed = k_seed}}};
}

void write_points(std::FILE* out, const std::string& name, const Variant& variant,
                  const bite_line::Workings& workings, const bite_line::Extraction& found,
                  const cloud::ClosedLine& truth) {
  for (const bite_line::PlacedStation& p : workings.placed.points) {
    const Vec3 at = found.T_base_shoe * p.position;
    const bite_line::PointSpread own = bite_line::spread_of(p);
    const double u95_mm =
        uncertainty::u95_mm(uncertainty::principal_axes(own.covariance_mm2), own.hold, own.other_mm);
    std::fprintf(out, "%s,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.4f,%.3f,%.3f,%.4f,%.4f,%.3f,%.4f,%.3f,%.3f\n",
                 name.c_str(), variant.name.c_str(), at.x(), at.y(), at.z(), p.position.x(), p.position.y(),
                 p.position.z(), p.hold, p.other_mm, p.doubt, p.sharp, p.own_z_mm - p.position.z(),
                 p.curvature_per_mm, own.within * own.hold, u95_mm,
                 truth.points.empty() ? -1.0 : test::distance_mm(at, truth));
  }
}

void write_paths(std::FILE* out, const std::string& name, const Variant& variant,
                 const bite_line::Extraction& found) {
  for (std::size_t i = 0; i < found.candidates.size(); ++i) {
    for (const Vec3& p : found.candidates[i].points)
      std::fprintf(out, "%s,%s,%zu,%.3f,%.3f,%.3f\n", name.c_str(), variant.name.c_str(), i, p.x(), p.y(),
                   p.z());
  }
}

/// What is asked for.
struct Options {
  bool variants{false}, rigid{false};
  std::uint32_t first_warp{0}, warps{0};
  std::string only{};
  bool published{false};
  std::string save{}, points{}, paths{};
  std::vector<std::string> own{};
};

/// Where rows and clouds are written, or nothing.
struct Files {
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> points{nullptr, &std::fclose}, paths{nullptr, &std::fclose};
  std::string save{};

  explicit Files(const Options& options) : save{options.save} {
    if (!options.points.empty()) points.reset(std::fopen(options.points.c_str(), "w"));
    if (!options.paths.empty()) paths.reset(std::fopen(options.paths.c_str(), "w"));
    if (points)
      std::fprintf(points.get(),
                   "shape,variant,x_mm,y_mm,z_mm,shoe_x_mm,shoe_y_mm,shoe_z_mm,hold,other_mm,doubt,sharp,"
                   "jump_mm,curvature_per_mm,confidence,u95_mm,error_mm\n");
    if (paths) std::fprintf(paths.get(), "shape,variant,candidate,x_mm,y_mm,z_mm\n");
  }
};

void save_cloud(const std::string& folder, const std::string& name, const Variant& variant,
                const cloud::PointCloud& cloud, const cloud::ClosedLine& line) {
  const std::string beside = (std::filesystem::path{folder} / (name + " " + variant.name)).string();
  if (!cloud::write_cloud(beside + ".ply", cloud) ||
      (!line.points.empty() && !cloud::write_line(beside + "_truth.csv", line)))
    std::fprintf(stderr, "%s: cannot be written\n", beside.c_str());
}

/// Gives the line that was found, in base; empty where none was.
cloud::ClosedLine run(const std::string& name, const cloud::PointCloud& cloud, const test::ShapeTruth& truth,
                      const Variant& variant, bool published, const Files& files) {
  const cloud::ClosedLine line = variant.warp.line(truth.line);
  const cloud::PointCloud input = variant.warp.cloud(cloud);
  std::optional<bite_line::Workings> workings;
  const bite_line::Extraction found = published ? published::find_bite_line(input.points, {})
                                                : bite_line::find_bite_line(input, {}, &workings);
  if (files.points && workings) write_points(files.points.get(), name, variant, *workings, found, line);
  if (files.paths) write_paths(files.paths.get(), name, variant, found);
  if (!files.save.empty()) save_cloud(files.save, name, variant, input, line);
  std::printf("{\"bench\":\"line.shapes\",\"what\":\"%s, %s\",\"method\":\"%s\",\"confidence\":%.3f,",
              name.c_str(), variant.name.c_str(), published ? "published" : "ours", found.confidence);
  if (!found.found) {
    std::printf("\"verdict\":\"refused\",\"reason\":\"%s\"}\n",
                found.refusal ? found.refusal->reason.c_str() : "");
    return {};
  }
  if (truth.has_none) {
    std::printf("\"verdict\":\"WRONG: a line where there is none\"}\n");
    return found.line;
  }
  const test::LineOnShape on = test::line_on_shape(found.line, line);
  const char* verdict = line.points.empty()           ? "to be looked at"
                        : on.wrong_mm > 5             ? "WRONG"
                        : on.beyond_2mm_unflagged > 0 ? "points beyond 2 mm"
                                                      : "right";
  std::printf(
      "\"verdict\":\"%s\",\"mean_mm\":%.3f,\"max_mm\":%.2f,\"mean_unflagged_mm\":%.3f,"
      "\"wrong_length_mm\":%.1f,\"share_beyond_2mm_unflagged\":%.4f,\"share_flagged\":%.4f,"
      "\"share_within_u95\":%.4f}\n",
      verdict, on.mean_mm, on.max_mm, on.mean_unflagged_mm, on.wrong_mm, on.beyond_2mm_unflagged, on.flagged,
      on.within_u95);
  std::fflush(stdout);
  return found.line;
}

/// A shape as it is, and all that is asked to be made of it.
void run_all(const Options& options, const std::string& name, const cloud::PointCloud& cloud,
             const test::ShapeTruth& truth, const Files& files) {
  std::vector<Variant> others;
  if (options.variants) others = variants();
  for (std::uint32_t seed = options.first_warp; seed < options.first_warp + options.warps; ++seed) {
    const test::ShapeWarp warp = test::ShapeWarp::drawn(seed);
    others.push_back(
        {(options.rigid ? "moved " : "warp ") + std::to_string(seed), options.rigid ? warp.rigid() : warp});
  }
  const Variant itself{"as it is", {}};
  test::ShapeTruth known = truth;
  cloud::ClosedLine own_line = run(name, cloud, truth, itself, false, files);
  if (options.published) run(name, cloud, truth, itself, true, files);
  if (!truth.has_none && truth.line.points.empty()) {
    std::erase_if(own_line.points, test::is_flagged);
    known.line = std::move(own_line);
  }
  for (const Variant& other : others) {
    run(name, cloud, known, other, false, files);
    if (options.published) run(name, cloud, known, other, true, files);
  }
}

int run_own(const Options& options, const Files& files) {
  const auto cloud = cloud::read_cloud(options.own[1]);
  if (!cloud) return 1;
  const std::string& known = options.own[2];
  test::ShapeTruth truth{.line = {}, .has_none = known == "none"};
  if (known != "none" && known != "-") {
    auto line = cloud::read_positions(known);
    if (!line) return 1;
    truth.line = std::move(*line);
  }
  run_all(options, options.own[0], *cloud, truth, files);
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  using namespace biteline;
  bench::Options asked;
  options::Command command{"The line on shapes of public origin", "bench_line_shapes"};
  command.add_flag("--variants", asked.variants, "also turned, tilted, mirrored, noisier");
  command.add_option("--warps", asked.warps, "so many others of each: stretched, bent, thinned, with gaps");
  command.add_option("--first", asked.first_warp, "the first of these")->capture_default_str();
  command.add_option("--only", asked.only, "shapes whose name begins so");
  command.add_flag("--rigid", asked.rigid, "these are turned, tilted and mirrored alone");
  command.add_flag("--published", asked.published, "the published method beside it");
  command.add_option("--save", asked.save, "clouds and known lines go to this folder");
  command.add_option("--points", asked.points, "a row for each placed station goes there");
  command.add_option("--paths", asked.paths, "the places of all candidates go there, the chosen one first");
  command
      .add_option("shape", asked.own, "one more: its name, its cloud, its line (none, or - for not known)")
      ->expected(0, 3);
  if (const std::optional<int> status = bench::read_options(command, argc, argv)) return *status;
  const bench::Files files{asked};
  if (asked.own.size() == 3) return bench::run_own(asked, files);
  for (const test::Shape& shape : test::k_shapes) {
    if (!std::string{shape.name}.starts_with(asked.only)) continue;
    const auto cloud = test::cloud_of(shape);
    const auto truth = test::truth_of(shape);
    if (cloud && truth) bench::run_all(asked, shape.name, *cloud, *truth, files);
  }
  return 0;
}
