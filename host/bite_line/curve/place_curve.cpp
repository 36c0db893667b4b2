// SPDX-License-Identifier: MIT
#include "host/bite_line/curve/place_curve.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "host/bite_line/path/creases.hpp"
#include "host/bite_line/path/layers.hpp"
#include "host/bite_line/place/place_along.hpp"
#include "host/bite_line/place/place_path.hpp"
#include "host/bite_line/place/straightened.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "host/geometry/bridge.hpp"

namespace biteline::bite_line {

namespace {

constexpr std::size_t k_most_rivals = 6;  // that are told
/// Where a place is doubted and no other one is known: what lies nearer would be the same crease.
constexpr double k_nearest_other_mm = RivalConfig{}.same_mm;

/// The station beside each column, by where a station lies along the columns.
template <class Along>
std::vector<const CurveStation*> on_columns(const std::vector<CurveStation>& stations, const SideGrid& grid,
                                            Along&& along_mm) {
  std::vector<const CurveStation*> beside(static_cast<std::size_t>(grid.cols), nullptr);
  for (const CurveStation& station : stations) {
    const double col = along_mm(station.place) / grid.col_mm;
    beside[std::min(static_cast<std::size_t>(col), beside.size() - 1)] = &station;
  }
  const CurveStation* last = &stations.back();
  for (const CurveStation*& station : beside) {
    if (station == nullptr) station = last;
    last = station;
  }
  return beside;
}

/// What else the line may be on one side of it, a stretch of columns after the other.  `rise_mm`: how much
/// higher an alternative lies.
template <class Rise>
void add_rivals(std::span<const CurveStation* const> stations, const SideField& field,
                std::span<const int> path, double evidence, bool above, Rise&& rise_mm,
                std::vector<Rival>& rivals) {
  constexpr double k_jump_mm = 3.0, k_least_mm = 5.0;
  const SideGrid& grid = field.grid;
  const std::size_t cols = path.size();
  std::vector<double> by_mm(cols, 0.0);
  for (std::size_t c = 0; c < cols; ++c) {
    const auto& others = stations[c]->alternatives;
    const auto at =
        std::ranges::find_if(others, [&](const auto& other) { return (other.off_mm > 0) == above; });
    if (at != others.end()) by_mm[c] = rise_mm(*stations[c], *at);
  }
  std::vector<std::uint8_t> ends(cols);
  for (std::size_t c = 0; c < cols; ++c)
    ends[c] = by_mm[c] == 0 || std::abs(by_mm[c] - by_mm[(c + cols - 1) % cols]) > k_jump_mm ? 1 : 0;
  std::vector<geometry::Gap> stretches = geometry::gaps_of(ends);
  const bool all_round = std::ranges::find(ends, 1) == ends.end();
  if (all_round) stretches.push_back({.first = 0, .steps = cols + 1});
  for (const geometry::Gap& stretch : stretches) {
    if (static_cast<double>(stretch.steps - 1) * grid.col_mm < k_least_mm) continue;
    std::vector<int> row(path.begin(), path.end());
    for (std::size_t k = 1; k < stretch.steps; ++k) {
      const std::size_t c = (stretch.first + k) % cols;
      row[c] = std::clamp(row[c] + static_cast<int>(std::lround(by_mm[c] / grid.row_mm)), 0, grid.rows - 1);
    }
    Crease crease = describe(field, on_crest(field, row, Raster::k_cell_mm), {});
    crease.evidence = evidence;
    rivals.push_back({.crease = std::move(crease),
                      .first_col = static_cast<int>((stretch.first + 1) % cols),
                      .cols = static_cast<int>(stretch.steps - 1),
                      .above = above,
                      .all_round = all_round});
  }
}

/// The curve as the gates and the placing steps take it: a crease along a path, and what the posterior holds
/// of it.
template <class Rise>
Layers layers_of(const CurveOnSide& found, std::span<const CurveStation* const> stations,
                 const SideField& field, std::span<const int> path, Rise&& rise_mm) {
  Layers layers;
  layers.line = describe(field, on_crest(field, path, Raster::k_cell_mm), {});
  layers.line.evidence = found.evidence;
  for (const CurveStation* station : stations) {
    layers.hold.push_back(static_cast<float>(station->hold));
    layers.other_mm.push_back(static_cast<float>(
        station->alternatives.empty() ? k_nearest_other_mm : std::abs(station->alternatives.front().off_mm)));
  }
  layers.sharp = sharp_along(field, layers.line);
  for (const bool above : {true, false})
    add_rivals(stations, field, path, found.evidence, above, rise_mm, layers.rivals);
  std::ranges::sort(layers.rivals, std::ranges::greater{}, &Rival::cols);
  layers.rivals.resize(std::min(layers.rivals.size(), k_most_rivals));
  return layers;
}

/// How a curve is judged and placed.
class CurvePlacer {
 public:
  /// All borrowed.
  CurvePlacer(const ScanPoints& scan, const Side& side, const CurveOnSide& found, double spacing_mm)
      : scan_{scan}, side_{side}, found_{found}, spacing_mm_{spacing_mm} {}

  /// `judge`: of its layers, whether it is the line.
  template <class Judge>
  [[nodiscard]] PlacedCurve run(Judge&& judge) const {
    constexpr double k_steep = 0.9;
    const SideGrid& grid = side_.field.grid;
    const double turn_mm = side_.outline.length_mm();
    const auto stations = on_columns(found_.stations, grid, [&](const Vec2& at) {
      return at.x() - turn_mm * std::floor(at.x() / turn_mm);
    });
    std::vector<int> path;
    for (const CurveStation* station : stations)
      path.push_back(
          std::clamp(static_cast<int>(std::lround((station->place.y() - grid.z_low_mm) / grid.row_mm - 0.5)),
                     0, grid.rows - 1));
    const std::vector<double> row = smooth_rows(grid, path);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double rise_mm = (row[(i + 1) % row.size()] - row[i]) * grid.row_mm;
      if (std::abs(rise_mm) > k_steep * grid.col_mm) return along_curve(judge);
    }
    PlacedCurve result;
    const Layers layers = layers_of(
        found_, stations, side_.field, path, [](const CurveStation& station, const CurveAlternative& other) {
          // Square to a curve that climbs a little; the path is told upright.
          return other.off_mm * other.off_mm / (other.place.y() - station.place.y());
        });
    result.decision = judge(layers);
    if (!shows(result.decision)) return result;
    result.placed =
        place_path(scan_, side_, layers.line.row,
                   {.hold = layers.hold, .other_mm = layers.other_mm, .sharp = layers.sharp}, spacing_mm_);
    return result;
  }

 private:
  static bool shows(const Decision& decision) { return !decision.refusal || decision.for_review; }

  template <class Judge>
  [[nodiscard]] PlacedCurve along_curve(Judge&& judge) const {
    PlacedCurve result;
    std::vector<Vec2> guide;
    for (const CurveStation& station : found_.stations) guide.push_back(station.place);
    const OrRefusal<Straightened> straightened =
        Straightened::along(side_, smooth_guide(guide, side_.outline.length_mm(), k_guide_sigma_mm));
    if (!straightened) {
      result.decision.refusal = straightened.error();
      return result;
    }
    const Side level = side_along(*straightened);
    const SideGrid& grid = level.field.grid;
    const double row = (straightened->height_mm() - grid.z_low_mm) / grid.row_mm - 0.5;
    const std::vector<int> path(static_cast<std::size_t>(grid.cols), static_cast<int>(std::lround(row)));
    const auto stations =
        on_columns(found_.stations, grid, [&](const Vec2& at) { return straightened->u_mm(at); });
    const Layers layers =
        layers_of(found_, stations, level.field, path,
                  [](const CurveStation&, const CurveAlternative& other) { return other.off_mm; });
    result.decision = judge(layers);
    if (shows(result.decision)) {
      OrRefusal<PlacedLine> placed = place_along(
          scan_, side_,
          {.straightened = *straightened, .grid = grid, .path_row = layers.line.row, .layers = layers},
          spacing_mm_);
      if (placed) {
        result.placed = std::move(*placed);
      } else {
        result.decision.refusal = placed.error();
        result.decision.for_review = false;
      }
    }
    for (JudgedPath& path_of : result.decision.paths) {
      path_of.row = straightened->back(level.field, path_of.row);
      path_of.lacks = lacks_back(*straightened, grid, path_of, guide.front().x());
    }
    return result;
  }

  /// What a path of the straightened side lacks, per column of the side: that of the column beside each
  /// place.
  [[nodiscard]] std::vector<std::uint8_t> lacks_back(const Straightened& straightened, const SideGrid& level,
                                                     const JudgedPath& path, double begin_mm) const {
    if (path.lacks.empty()) return {};
    const SideGrid& grid = side_.field.grid;
    std::vector<std::uint8_t> lacks;
    for (std::size_t c = 0; c < path.row.size(); ++c) {
      double s_mm = (static_cast<double>(c) + 0.5) * grid.col_mm;
      if (s_mm < begin_mm) s_mm += side_.outline.length_mm();
      const double col = straightened.u_mm({s_mm, grid.z_mm(path.row[c])}) / level.col_mm;
      lacks.push_back(path.lacks[std::min(static_cast<std::size_t>(col), path.lacks.size() - 1)]);
    }
    return lacks;
  }

  const ScanPoints& scan_;
  const Side& side_;
  const CurveOnSide& found_;
  double spacing_mm_;
};

}  // namespace

PlacedCurve place_curve(const ScanPoints& scan, const Side& side, const CurveOnSide& found,
                        const std::optional<SeamStep>& seam, const Config& config) {
  return CurvePlacer{scan, side, found, config.point_spacing_mm}.run([&](const Layers& layers) {
    return decide(layers, plan_shape(side_reach(side)), seam, config.min_confidence_ratio);
  });
}

OrRefusal<PlacedLine> place_guide(const ScanPoints& scan, const Side& side, std::span<const Vec2> guide,
                                  double spacing_mm) {
  CurveOnSide as_found;
  for (const Vec2& place : guide) as_found.stations.push_back({.place = place});
  PlacedCurve placed =
      CurvePlacer{scan, side, as_found, spacing_mm}.run([](const Layers&) { return Decision{}; });
  if (placed.decision.refusal) return tl::unexpected<Refusal>(std::move(*placed.decision.refusal));
  return std::move(placed.placed);
}

}  // namespace biteline::bite_line
