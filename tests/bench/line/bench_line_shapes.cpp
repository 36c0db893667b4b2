// SPDX-License-Identifier: MIT
// The line on shapes that nobody here designed: right, flagged, refused or wrong, as they are and turned,
// tilted, mirrored, noisier.
//
//   bench_line_shapes [--variants] [--published] [--points FILE] [--paths FILE] [NAME CLOUD.ply
//   TRUTH.csv|none|-]
//
// --points: one row for each placed station, written or refused: where it is, what its confidence is made of,
// and how far off the known line.  --paths: the places of all candidates, the chosen or nearest first.
// The last three name one more shape: `none` is no shoe or has no line, `-` has no known line.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/place/point_spread.hpp"
#include "host/bite_line/published/published_line.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/ply.hpp"
#include "host/cloud/uncertainty/radius.hpp"
#include "tests/support/line_distance.hpp"
#include "tests/support/shape_truth.hpp"

namespace biteline::bench {
namespace {

/// One rigid motion, mirror and noise for a cloud and its truth.
struct Variant {
  const char* name;
  double yaw_deg, tilt_deg, noise_mm;
  bool mirrored;
};
constexpr Variant k_variants[] = {{"as it is", 0, 0, 0, false},
                                  {"turned", 140, 0, 0, false},
                                  {"tilted", -40, 5, 0, false},
                                  {"mirrored", 0, 0, 0, true},
                                  {"noisier", 20, 0, 0.05, false}};

Vec3 moved(const Vec3& p, const Variant& variant) {
  const double to_rad = std::numbers::pi / 180;
  const Vec3 mirrored{p.x(), variant.mirrored ? -p.y() : p.y(), p.z()};
  return Eigen::AngleAxisd{variant.yaw_deg * to_rad, Vec3::UnitZ()} *
         (Eigen::AngleAxisd{variant.tilt_deg * to_rad, Vec3{0.8, 0.6, 0}} * mirrored);
}

cloud::PointCloud made(const cloud::PointCloud& cloud, const Variant& variant) {
  cloud::PointCloud out;
  std::mt19937 random{7};
  std::normal_distribution<double> noise{0, 1};
  for (const Eigen::Vector3f& p : cloud.points) {
    Vec3 q = moved(p.cast<double>(), variant);
    if (variant.noise_mm > 0) q += variant.noise_mm * Vec3{noise(random), noise(random), noise(random)};
    out.points.push_back(q.cast<float>());
  }
  if (!variant.mirrored) {
    out.profile = cloud.profile;
    out.column = cloud.column;
  }
  return out;
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
                 name.c_str(), variant.name, at.x(), at.y(), at.z(), p.position.x(), p.position.y(),
                 p.position.z(), p.hold, p.other_mm, p.doubt, p.sharp, p.own_z_mm - p.position.z(),
                 p.curvature_per_mm, own.within * own.hold, u95_mm,
                 truth.points.empty() ? -1.0 : test::distance_mm(at, truth));
  }
}

void write_paths(std::FILE* out, const std::string& name, const Variant& variant,
                 const bite_line::Extraction& found) {
  for (std::size_t i = 0; i < found.candidates.size(); ++i) {
    for (const Vec3& p : found.candidates[i].points)
      std::fprintf(out, "%s,%s,%zu,%.3f,%.3f,%.3f\n", name.c_str(), variant.name, i, p.x(), p.y(), p.z());
  }
}

/// Where rows are written, or nothing.
struct Files {
  std::FILE* points{nullptr};
  std::FILE* paths{nullptr};
};

void run(const std::string& name, const cloud::PointCloud& cloud, const test::ShapeTruth& truth,
         const Variant& variant, bool published, const Files& files) {
  cloud::ClosedLine line = truth.line;
  for (cloud::LinePoint& p : line.points) p.position = moved(p.position, variant);
  const cloud::PointCloud input = made(cloud, variant);
  std::optional<bite_line::Workings> workings;
  const bite_line::Extraction found = published ? published::find_bite_line(input.points, {})
                                                : bite_line::find_bite_line(input, {}, &workings);
  if (files.points != nullptr && workings) write_points(files.points, name, variant, *workings, found, line);
  if (files.paths != nullptr) write_paths(files.paths, name, variant, found);
  std::printf("{\"bench\":\"line.shapes\",\"what\":\"%s, %s\",\"method\":\"%s\",\"confidence\":%.3f,",
              name.c_str(), variant.name, published ? "published" : "ours", found.confidence);
  if (!found.found) {
    std::printf("\"verdict\":\"refused\",\"reason\":\"%s\"}\n",
                found.refusal ? found.refusal->reason.c_str() : "");
    return;
  }
  if (truth.has_none) {
    std::printf("\"verdict\":\"WRONG: a line where there is none\"}\n");
    return;
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
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  using namespace biteline;
  bool variants = false;
  bool published = false;
  std::vector<std::string> own;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> points{nullptr, &std::fclose}, paths{nullptr, &std::fclose};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--variants")
      variants = true;
    else if (argument == "--published")
      published = true;
    else if (argument == "--points" && i + 1 < argc)
      points.reset(std::fopen(argv[++i], "w"));
    else if (argument == "--paths" && i + 1 < argc)
      paths.reset(std::fopen(argv[++i], "w"));
    else
      own.push_back(argument);
  }
  if (points)
    std::fprintf(points.get(),
                 "shape,variant,x_mm,y_mm,z_mm,shoe_x_mm,shoe_y_mm,shoe_z_mm,hold,other_mm,doubt,sharp,"
                 "jump_mm,curvature_per_mm,confidence,u95_mm,error_mm\n");
  if (paths) std::fprintf(paths.get(), "shape,variant,candidate,x_mm,y_mm,z_mm\n");
  const auto each = [&](const std::string& name, const cloud::PointCloud& cloud,
                        const test::ShapeTruth& truth) {
    for (const bench::Variant& variant : bench::k_variants) {
      bench::run(name, cloud, truth, variant, false, {points.get(), paths.get()});
      if (published) bench::run(name, cloud, truth, variant, true, {});
      if (!variants) break;
    }
  };
  if (own.size() == 3) {
    const auto cloud = cloud::read_cloud(own[1]);
    if (!cloud) return 1;
    test::ShapeTruth truth{.line = {}, .has_none = own[2] == "none"};
    if (own[2] != "none" && own[2] != "-") {
      auto line = cloud::read_positions(own[2]);
      if (!line) return 1;
      truth.line = std::move(*line);
    }
    each(own[0], *cloud, truth);
    return 0;
  }
  for (const test::Shape& shape : test::k_shapes) {
    const auto cloud = test::cloud_of(shape);
    const auto truth = test::truth_of(shape);
    if (cloud && truth) each(shape.name, *cloud, *truth);
  }
  return 0;
}
