// SPDX-License-Identifier: MIT
#include "tests/bench/line/curve_cases.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "host/cloud/ply.hpp"
#include "tests/support/mesh_cloud.hpp"
#include "tests/support/shape_truth.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::bench {

namespace {

/// Beside test::k_shapes; those whose line is not known by labels come without.
struct LabelledShape {
  const char* name;
  test::Shape::Truth truth;
};
constexpr LabelledShape k_labelled[] = {{"s42_welted_leather_heel", test::Shape::Truth::Line},
                                        {"s45_canvas_13_parts", test::Shape::Truth::Line},
                                        {"s46_adi_8_parts", test::Shape::Truth::Line},
                                        {"s41_low_basketball", test::Shape::Truth::Unknown},
                                        {"s43_running", test::Shape::Truth::Unknown},
                                        {"s44_worn_trainer_scan", test::Shape::Truth::Unknown},
                                        {"s47_stiletto_pump", test::Shape::Truth::Unknown},
                                        {"s48_child_low_poly", test::Shape::Truth::Unknown},
                                        {"n03_real_sole_unit", test::Shape::Truth::NoLine},
                                        {"n04_drill_scan", test::Shape::Truth::NoLine},
                                        {"n05_remote_scan", test::Shape::Truth::NoLine},
                                        {"n06_upper_without_sole", test::Shape::Truth::NoLine}};

const char* kind_of(test::Shape::Truth truth) {
  using enum test::Shape::Truth;
  return truth == Line ? "shape" : truth == Unknown ? "unlabelled" : "thing";
}

struct MadeKind {
  const char* name;
  int count;
  std::uint64_t seed;
  bool guard{false};
  std::optional<double> heel_ratio{};
  bool flush{false};  ///< a tenth to three tenths of the step drawn
  bool sewn{false};   ///< a seam goes all the way round the upper, 7 to 17 mm above the line
};

void made_cases(const MadeKind& kind, const std::function<void(CurveCase&&)>& use) {
  int made = 0;
  for (std::uint64_t index = 0; made < kind.count; ++index) {
    test::SweepCell cell = test::sweep_cell(kind.seed, index);
    cell.shoe.toe_guard = kind.guard;
    cell.shoe.heel_ratio = kind.heel_ratio;
    if (kind.sewn && index % 2 == 0) cell.shoe.shoe_class = sim::ShoeClass::Shallow;
    if (kind.sewn)
      cell.seam = {.u_mm = 7.0 + static_cast<double>(made % 11),
                   .depth_mm = 0.3 + 0.05 * static_cast<double>(made % 5)};
    const bool designed = sim::is_designed(cell.shoe.shoe_class);
    if (!cell.is_shoe() || ((kind.guard || kind.heel_ratio || kind.flush) && !designed)) continue;
    if (kind.flush) cell.crease_ratio = 0.1 + 0.05 * static_cast<double>(made % 5);
    const std::string group{sim::name_of(cell.shoe.shoe_class)};
    ++made;
    use({.kind = kind.name,
         .group = group,
         .name = std::string{kind.name} + " " + std::to_string(kind.seed) + "/" + std::to_string(index) +
                 " " + group + " " + std::string{sim::name_of(cell.shoe.decoy)} + " " +
                 std::string{test::name_of(cell.fault)},
         .scan = test::scan_of(cell),
         .truth_mm = 0});
  }
}

void shape_cases(bool unknown, const std::function<void(CurveCase&&)>& use) {
  constexpr double k_label_mm = 1.0;
  for (const test::Shape& shape : test::k_shapes) {
    const bool known = shape.truth == test::Shape::Truth::Line;
    if (!known && !unknown) continue;
    auto cloud = test::cloud_of(shape);
    auto truth = test::truth_of(shape);
    if (!cloud || !truth) continue;
    use({.kind = kind_of(shape.truth),
         .group = shape.name,
         .name = shape.name,
         .scan = {.cloud = std::move(*cloud), .truth = std::move(truth->line)},
         .truth_mm = k_label_mm});
  }
  for (const LabelledShape& shape : k_labelled) {
    const bool known = shape.truth == test::Shape::Truth::Line;
    if (!known && !unknown) continue;
    const std::string folder = std::string{"shapes3/"} + shape.name;
    const auto file = test::shared_data(folder + "/cloud.ply");
    if (!file) continue;
    auto cloud = cloud::read_cloud(*file);
    if (!cloud) continue;
    CurveCase of{.kind = kind_of(shape.truth),
                 .group = shape.name,
                 .name = shape.name,
                 .scan = {.cloud = std::move(*cloud), .truth = {}},
                 .truth_mm = k_label_mm};
    if (known) {
      const auto labels = test::shared_data(folder + "/truth_label.csv");
      if (!labels) continue;
      auto line = cloud::read_positions(*labels);
      if (!line) continue;
      of.scan.truth = std::move(*line);
    }
    use(std::move(of));
  }
}

}  // namespace

void for_cases(const CaseOptions& options, const std::function<void(CurveCase&&)>& use) {
  made_cases({.name = "ordinary", .count = options.ordinary, .seed = options.seed}, use);
  made_cases({.name = "guard", .count = options.guards, .seed = options.seed + 1, .guard = true}, use);
  made_cases(
      {.name = "heel", .count = options.heels, .seed = options.seed + 2, .heel_ratio = options.heel_ratio},
      use);
  made_cases({.name = "flush", .count = options.flush, .seed = options.seed + 3, .flush = true}, use);
  made_cases({.name = "sewn", .count = options.sewn, .seed = options.seed + 4, .sewn = true}, use);
  if (options.shapes) shape_cases(options.unknown_shapes, use);
}

std::optional<bite_line::Side> side_of(const cloud::PointCloud& cloud) {
  const bite_line::PointRuns runs = bite_line::runs_of(cloud);
  bite_line::OrRefusal<bite_line::Shoe> shoe = bite_line::find_shoe(runs.scan(cloud.points).means);
  if (!shoe) return std::nullopt;
  bite_line::Outline outline = bite_line::side_outline(*shoe);
  bite_line::SideField field = bite_line::SideField::build(*shoe, outline, {});
  return bite_line::Side{std::move(*shoe), std::move(outline), std::move(field)};
}

std::vector<Vec2> truth_on_side(const bite_line::Side& side, const CurveCase& of) {
  constexpr double k_spacing_mm = 0.75, k_chord_mm = 3.0;
  const SE3 T_shoe_base = side.shoe.T_base_shoe.inverse();
  const double turn_mm = side.outline.length_mm();
  std::vector<Vec2> corners;
  double round_mm = 0;
  for (const cloud::LinePoint& point : of.scan.truth.points) {
    const bite_line::OutlinePlace place =
        side.outline.locate(Eigen::Vector3f{(T_shoe_base * point.position).cast<float>()});
    if (place.s_mm < 0) continue;
    Vec2 at{static_cast<double>(place.s_mm), static_cast<double>(place.z_mm)};
    if (!corners.empty()) {
      at.x() += turn_mm * std::round((corners.back().x() - at.x()) / turn_mm);
      round_mm += at.x() - corners.back().x();
    }
    corners.push_back(at);
  }
  if (round_mm < 0) std::ranges::reverse(corners);
  std::vector<Vec2> places;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Vec2 edge = corners[i + 1] - corners[i];
    // A made line knows its upright flanks by their ends; labels know nothing along a chord.
    if (of.truth_mm > 0 && edge.norm() > k_chord_mm) continue;
    const int steps = std::max(1, static_cast<int>(std::lround(edge.norm() / k_spacing_mm)));
    for (int k = 0; k < steps; ++k) {
      const Vec2 at = corners[i] + edge * k / steps;
      if (places.empty() || (at - places.back()).norm() >= 0.9 * k_spacing_mm) places.push_back(at);
    }
  }
  return places;
}

}  // namespace biteline::bench
