// SPDX-License-Identifier: MIT
#include "host/bite_line/edit/surface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/bite_line/curve/place_curve.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/place/finish.hpp"
#include "host/bite_line/place/place_path.hpp"
#include "host/bite_line/side/side_outline.hpp"

namespace biteline::edit {
using namespace bite_line;

OrRefusal<Surface> Surface::of(const cloud::PointCloud& cloud) {
  PointRuns runs = runs_of(cloud);
  std::optional<Workings> workings;
  Extraction found = find_bite_line(runs.scan(cloud.points), {}, &workings);
  if (!workings) return refuse(Refused::NothingToMend, "nothing to mend: " + found.reason());
  return Surface{cloud.points, std::move(runs), std::move(*workings), std::move(found.candidates)};
}

Surface::Surface(std::vector<Eigen::Vector3f> points, PointRuns runs, Workings workings,
                 std::vector<Candidate> candidates)
    : points_{std::move(points)},
      runs_{std::move(runs)},
      side_{std::move(workings.side)},
      decision_{std::move(workings.decision)},
      placed_{std::move(workings.placed)},
      candidates_{std::move(candidates)},
      ground_{new CurveGround(curve_ground(side_))} {}

cloud::ClosedLine Surface::candidate(int number) const {
  if (number > 1 || placed_.points.empty())
    return place(decision_.paths[static_cast<std::size_t>(number) - 1].row, 1.0);
  // As it was found, along guards too.
  PlacedLine placed = placed_;
  for (PlacedStation& station : placed.points) {
    station.hold = 1;
    station.other_mm = 0;
  }
  return even_line(placed, T_base_shoe(), 1.0, {}, Config{}.point_spacing_mm);
}

bool Surface::sure_beside(const Vec3& point) const {
  constexpr double k_beside_mm = 1.0;
  constexpr double k_sure_hold = 0.99;  // the rest widens a U95 by a twentieth
  const Vec3 in_shoe = T_base_shoe().inverse() * point;
  return std::ranges::any_of(placed_.points, [&](const PlacedStation& station) {
    return station.hold >= k_sure_hold && (station.position - in_shoe).norm() <= k_beside_mm;
  });
}

ScanPoints Surface::points() const {
  return runs_.scan(points_);
}

std::optional<Vec2> Surface::locate(const Vec3& point) const {
  // The outline answers behind the surface, too: what lies far off it is no place of the side.
  constexpr double k_near_mm = 15.0;
  const Vec3 in_shoe = T_base_shoe().inverse() * point;
  const OutlinePlace place = side_.outline.locate(in_shoe.cast<float>());
  if (place.s_mm < 0) return std::nullopt;
  const double s_mm = static_cast<double>(place.s_mm);
  const int row = static_cast<int>(std::floor((in_shoe.z() - grid().z_low_mm) / grid().row_mm));
  const int col = std::min(static_cast<int>(s_mm / grid().col_mm), grid().cols - 1);
  if (row < 0 || row >= grid().rows) return std::nullopt;
  const std::size_t cell = grid().at(row, col);
  const double out_mm = (in_shoe.head<2>() - side_.outline.point(s_mm)).dot(side_.outline.normal(s_mm));
  if (side_.field.seen[cell] != 0 &&
      std::abs(out_mm - static_cast<double>(side_.field.o_mm[cell])) > k_near_mm)
    return std::nullopt;
  return Vec2{s_mm, in_shoe.z()};
}

std::vector<int> Surface::rows_of(const cloud::ClosedLine& line) const {
  const auto cols = static_cast<std::size_t>(grid().cols);
  std::vector<double> sum(cols, 0.0), count(cols, 0.0);
  for (const cloud::LinePoint& point : line.points) {
    const std::optional<Vec2> at = locate(point.position);
    if (!at) continue;
    const auto col = std::min(static_cast<std::size_t>(at->x() / grid().col_mm), cols - 1);
    sum[col] += (at->y() - grid().z_low_mm) / grid().row_mm - 0.5;
    count[col] += 1;
  }
  // A column without a point takes the next one's before it, or behind it at the very start.
  std::vector<int> rows(cols, 0);
  std::optional<double> last;
  for (std::size_t k = 0; k < 2 * cols; ++k) {
    const std::size_t col = k % cols;
    if (count[col] > 0) last = sum[col] / count[col];
    if (last) rows[col] = std::clamp(static_cast<int>(std::lround(*last)), 0, grid().rows - 1);
  }
  return rows;
}

std::optional<std::vector<Vec2>> Surface::lead(std::span<const CurveLead> leads) const {
  return led_curve(ground_->raster, ground_->costs, leads, {});
}

OrRefusal<cloud::ClosedLine> Surface::place_along(std::span<const Vec2> guide) const {
  const double spacing_mm = Config{}.point_spacing_mm;
  const bite_line::OrRefusal<PlacedLine> placed = place_guide(points(), side_, guide, spacing_mm);
  if (!placed) return refuse(Refused::NoCourse, placed.error().reason);
  return even_line(*placed, T_base_shoe(), 1.0, {}, spacing_mm);
}

cloud::ClosedLine Surface::place(std::span<const double> path, double of_line) const {
  std::vector<int> rows;
  for (const double row : path) rows.push_back(static_cast<int>(std::lround(row)));
  const Crease crease = describe(side_.field, rows, {});
  const std::vector<float> hold(path.size(), 1.0F), other(path.size(), 0.0F);
  const std::vector<float> sharp = sharp_along(side_.field, crease);
  const double spacing_mm = Config{}.point_spacing_mm;
  const PlacedLine placed =
      place_path(points(), side_, path, {.hold = hold, .other_mm = other, .sharp = sharp}, spacing_mm);
  return even_line(placed, T_base_shoe(), of_line, {}, spacing_mm);
}

}  // namespace biteline::edit
