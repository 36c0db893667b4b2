// SPDX-License-Identifier: MIT
#include "host/bite_line/line_stages.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/bite_line/side/side_normal.hpp"

namespace biteline::bite_line {

namespace {

// Pictures and stage clouds of more points show nothing more.
constexpr std::size_t k_most_points = 250'000;
// A turn of 3.5 degrees over 0.75 mm: less is a fold of cloth.
constexpr double k_feature_per_mm = 0.06 / SideField::k_turn_reach_mm;
// A feature point farther from every closed path is on none of them.
constexpr double k_on_path_mm = 1.0;

/// Curvature of the upright section at a cell, convex > 0: the turn is spread over its reach.
float section_curvature_at(const SideField& field, std::size_t cell) {
  return -field.turn_rad[cell] / static_cast<float>(SideField::k_turn_reach_mm);
}

/// One point of the outermost layer.
struct Shown {
  std::uint32_t of_shoe;
  SideCell cell;
};

/// Every n-th, evenly, when there are more than k_most_points.
std::vector<Shown> shown_points(const Side& side) {
  const auto& places = side.field.places;
  const auto outer = static_cast<std::size_t>(
      std::count_if(places.begin(), places.end(), [](const OutlinePlace& p) { return p.s_mm >= 0; }));
  const std::size_t kept = std::min(outer, k_most_points);
  std::vector<Shown> shown;
  shown.reserve(kept);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].s_mm < 0) continue;
    const bool take = (seen + 1) * kept / outer > seen * kept / outer;
    ++seen;
    const SideCell cell = cell_of(side.field.grid, places[i]);
    if (take && cell.row >= 0 && cell.row < side.field.grid.rows)
      shown.push_back({static_cast<std::uint32_t>(i), cell});
  }
  return shown;
}

/// How far from a path a point lies, in its own section.
double off_path_mm(const Side& side, const Shown& point, const JudgedPath& path) {
  const SideGrid& grid = side.field.grid;
  const OutlinePlace& place = side.field.places[point.of_shoe];
  const double row = path.row[static_cast<std::size_t>(point.cell.col)];
  const int nearest = std::clamp(static_cast<int>(std::lround(row)), 0, grid.rows - 1);
  const float o_mm = side.field.o_mm[grid.at(nearest, point.cell.col)];
  return std::hypot(static_cast<double>(place.z_mm) - grid.z_mm(row), static_cast<double>(place.o_mm - o_mm));
}

void add_points(const Workings& workings, const std::vector<Shown>& shown, LineStages& stages) {
  const Side& side = workings.side;
  const Eigen::Isometry3f T_base_shoe = side.shoe.T_base_shoe.cast<float>();
  const bool found = !workings.placed.points.empty();
  for (const Shown& point : shown) {
    const auto index = static_cast<std::uint32_t>(stages.surface.points.size());
    const Vec2 out = side.outline.normal(static_cast<double>(side.field.places[point.of_shoe].s_mm));
    const Vec3 normal = field_normal(side, point.cell).value_or(Vec3{out.x(), out.y(), 0});
    const std::size_t cell = side.field.grid.at(point.cell.row, point.cell.col);
    stages.surface.points.push_back(T_base_shoe * side.shoe.points[point.of_shoe]);
    stages.surface.normals.push_back(T_base_shoe.linear() * normal.cast<float>());
    stages.curvature_per_mm.push_back(section_curvature_at(side.field, cell));
    const auto near = [&](const JudgedPath& path, double reach_mm) {
      return off_path_mm(side, point, path) <= reach_mm;
    };
    const auto& paths = workings.decision.paths;
    if (static_cast<double>(stages.curvature_per_mm.back()) < -k_feature_per_mm) {
      stages.feature_points.push_back(index);
      if (std::any_of(paths.begin(), paths.end(), [&](const auto& path) { return near(path, k_on_path_mm); }))
        stages.denoised_points.push_back(index);
    }
    if (found && near(paths.front(), PlacementConfig{}.search_mm)) stages.coarse_line.push_back(index);
  }
}

std::vector<float> picture_rows(const SideGrid& grid, const JudgedPath& path) {
  std::vector<float> rows;
  for (const double row : path.row) rows.push_back(static_cast<float>(grid.rows - 1 - row));
  return rows;
}

/// Toe, heel and sides by the outline's own extremes: x runs to the toe, y to the left.
std::vector<UnrolledSide::Mark> marks_of(const Side& side) {
  struct Named {
    const char* name;
    Vec2 towards;
  };
  constexpr std::size_t k_names = 4;
  const std::array<Named, k_names> names{Named{"left", Vec2::UnitY()}, Named{"heel", -Vec2::UnitX()},
                                         Named{"right", -Vec2::UnitY()}, Named{"toe", Vec2::UnitX()}};
  const SideGrid& grid = side.field.grid;
  std::vector<UnrolledSide::Mark> marks;
  for (const Named& named : names) {
    int best = 0;
    const auto reach = [&](int col) {
      return side.outline.point((col + 0.5) * grid.col_mm).dot(named.towards);
    };
    for (int col = 1; col < grid.cols; ++col) {
      if (reach(col) > reach(best)) best = col;
    }
    marks.push_back({best, named.name});
  }
  return marks;
}

UnrolledSide unrolled(const Workings& workings) {
  const SideField& field = workings.side.field;
  const SideGrid& grid = field.grid;
  UnrolledSide picture{.rows = grid.rows,
                       .cols = grid.cols,
                       .curvature_per_mm = std::vector<float>(grid.size()),
                       .known = std::vector<unsigned char>(grid.size()),
                       .marks = marks_of(workings.side),
                       .path_row = {},
                       .rival_rows = {}};
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const std::size_t to = picture.at(row, col);
      const std::size_t from = grid.at(grid.rows - 1 - row, col);
      picture.curvature_per_mm[to] = section_curvature_at(field, from);
      picture.known[to] = field.seen[from];
    }
  }
  const auto& paths = workings.decision.paths;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (i == 0 && !workings.placed.points.empty()) {
      picture.path_row = picture_rows(grid, paths[i]);
    } else {
      picture.rival_rows.push_back(picture_rows(grid, paths[i]));
    }
  }
  return picture;
}

}  // namespace

LineStages line_stages(const Workings& workings) {
  LineStages stages;
  add_points(workings, shown_points(workings.side), stages);
  for (const PlacedStation& station : workings.placed.points) {
    const Vec3 own{station.position.x(), station.position.y(), station.own_z_mm};
    stages.thinned_line.push_back(workings.side.shoe.T_base_shoe * own);
  }
  stages.unrolled = unrolled(workings);
  return stages;
}

}  // namespace biteline::bite_line
