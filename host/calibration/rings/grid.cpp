// SPDX-License-Identifier: MIT
#include "host/calibration/rings/grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "host/calibration/chess/chessboard.hpp"
#include "host/calibration/rings/homography.hpp"
#include "host/calibration/rings/lattice.hpp"

namespace biteline::calibration {

namespace {

/// A ring may lie this far from its prediction, in pitches: lens distortion and the first cell's noise, well
/// below the half pitch at which the neighbour would be meant.
constexpr double k_reach_pitch = 0.22;
/// And its size may differ from its prediction by this factor.
constexpr double k_size_tolerance_ratio = 0.25;

double size_of(const Ellipse& ellipse) {
  return std::sqrt(ellipse.major_semi * ellipse.minor_semi);
}

/// How a ring of the target looks at a place of the plane.
struct Expected {
  Ellipse outer;
  Vec2 place_px{Vec2::Zero()};
  double reach_px{0};  ///< it may lie this far from there
};
std::optional<Expected> expected_at(const Mat3& H, Cell cell, double outer_radius_pitch) {
  const std::optional<Ellipse> outer = project_circle(H, Vec2(cell.second, cell.first), outer_radius_pitch);
  if (!outer) return std::nullopt;
  // One pitch in the picture, across the ellipse's narrow side.
  const double pitch_px = outer->minor_semi / outer_radius_pitch;
  return Expected{.outer = *outer,
                  .place_px = apply_homography(H, Vec2(cell.second, cell.first)),
                  .reach_px = k_reach_pitch * pitch_px + 1.0};
}

bool agrees(const Ring& ring, const Expected& expected) {
  if ((ring.centre_px - expected.place_px).norm() > expected.reach_px) return false;
  if (std::abs(std::log(size_of(ring.outer) / size_of(expected.outer))) > k_size_tolerance_ratio)
    return false;
  // The long axis sees the tilt's direction: the other plane of a corner fails here.
  const double major_ratio = ring.outer.major_semi / expected.outer.major_semi,
               minor_ratio = ring.outer.minor_semi / expected.outer.minor_semi;
  return std::abs(std::log(major_ratio)) < k_size_tolerance_ratio &&
         std::abs(std::log(minor_ratio)) < k_size_tolerance_ratio;
}

class Grower {
 public:
  Grower(const std::vector<Ring>& rings, const std::vector<char>& taken, const RingTarget& target)
      : rings_{rings},
        taken_{taken},
        target_{target},
        outer_radius_pitch_{target.outer_diameter_mm / 2 / target.pitch_mm} {}

  /// The largest lattice that can be grown from any cell of neighbours.
  [[nodiscard]] Lattice best() const {
    Lattice best;
    double best_error = std::numeric_limits<double>::max();
    for (std::size_t seed = 0; seed < rings_.size(); ++seed) {
      if (taken_[seed]) continue;
      for (const Lattice& first : first_cells(seed)) {
        const Lattice grown = grow(first);
        if (grown.size() < best.size() || grown.size() < 4) continue;
        const double error = residual(grown);
        if (grown.size() > best.size() || error < best_error) {
          best = grown;
          best_error = error;
        }
      }
      if (best.size() == static_cast<std::size_t>(target_.rings()) && best_error < 0.02) break;
    }
    return best;
  }

 private:
  /// Cells of four rings with `seed` as a corner.  The seed's ellipse gives the plane's local scale, free of
  /// a rotation.
  [[nodiscard]] std::vector<Lattice> first_cells(std::size_t seed) const {
    const Ring& ring = rings_[seed];
    struct Neighbour {
      std::size_t index;
      Vec2 place_pitch;
    };
    std::vector<Neighbour> neighbours;
    const Eigen::Rotation2Dd to_axes(-ring.outer.angle_rad);
    for (std::size_t i = 0; i < rings_.size(); ++i) {
      if (i == seed || taken_[i]) continue;
      const Vec2 d = to_axes * (rings_[i].centre_px - ring.centre_px);
      const Vec2 place_pitch =
          Vec2(d.x() / ring.outer.major_semi, d.y() / ring.outer.minor_semi) * outer_radius_pitch_;
      // Perspective over one pitch changes the scale by a quarter at most.
      if (place_pitch.norm() > 0.7 && place_pitch.norm() < 1.35) neighbours.push_back({i, place_pitch});
    }
    std::vector<Lattice> cells;
    for (const Neighbour& a : neighbours) {
      for (const Neighbour& b : neighbours) {
        const double cross = a.place_pitch.x() * b.place_pitch.y() - a.place_pitch.y() * b.place_pitch.x();
        // Columns to rows in the picture's own sense (u to the right, v down): never a mirrored reading.
        if (cross < 0.8 * a.place_pitch.norm() * b.place_pitch.norm()) continue;
        const Vec2 corner_px = rings_[a.index].centre_px + rings_[b.index].centre_px - ring.centre_px;
        const std::optional<std::size_t> diagonal =
            nearest(corner_px, 0.35 * size_of(ring.outer) / outer_radius_pitch_);
        if (!diagonal || *diagonal == a.index || *diagonal == b.index || *diagonal == seed) continue;
        cells.push_back({{{0, 0}, seed}, {{0, 1}, a.index}, {{1, 0}, b.index}, {{1, 1}, *diagonal}});
      }
    }
    return cells;
  }

  [[nodiscard]] std::optional<std::size_t> nearest(const Vec2& place_px, double reach_px) const {
    std::optional<std::size_t> best;
    double best_px = reach_px;
    for (std::size_t i = 0; i < rings_.size(); ++i) {
      const double distance_px = (rings_[i].centre_px - place_px).norm();
      if (!taken_[i] && distance_px < best_px) {
        best_px = distance_px;
        best = i;
      }
    }
    return best;
  }

  [[nodiscard]] Lattice grow(Lattice lattice) const {
    const std::optional<Mat3> first = lattice_homography(lattice, rings_);
    if (!first || homography_orientation(*first, Vec2(0.5, 0.5)) <= 0) return {};
    for (const auto& [cell, index] : lattice) {
      const auto expected = expected_at(*first, cell, outer_radius_pitch_);
      if (!expected || !agrees(rings_[index], *expected)) return {};
    }
    std::vector<char> used = taken_;
    for (const auto& [cell, index] : lattice) used[index] = 1;
    for (bool grew = true; grew;) {
      grew = false;
      const Lattice before = lattice;
      for (const auto& [cell, index] : before) {
        for (const Cell& step : {Cell{0, 1}, Cell{0, -1}, Cell{1, 0}, Cell{-1, 0}}) {
          const Cell next{cell.first + step.first, cell.second + step.second};
          if (lattice.contains(next)) continue;
          Extent extent = extent_of(lattice);
          extent.include(next);
          if (!extent.fits(target_)) continue;
          const std::optional<Mat3> H = local_homography(lattice, rings_, next, 3);
          if (!H) continue;
          const auto expected = expected_at(*H, next, outer_radius_pitch_);
          if (!expected) continue;
          std::optional<std::size_t> found;
          double found_px = std::numeric_limits<double>::max();
          for (std::size_t i = 0; i < rings_.size(); ++i) {
            const double distance_px = (rings_[i].centre_px - expected->place_px).norm();
            if (used[i] || distance_px >= found_px || !agrees(rings_[i], *expected)) continue;
            found_px = distance_px;
            found = i;
          }
          if (!found) continue;
          lattice[next] = *found;
          used[*found] = 1;
          grew = true;
        }
      }
    }
    return lattice;
  }

  /// RMS distance from the common homography, in pitches: lens distortion and no more.
  [[nodiscard]] double residual(const Lattice& lattice) const {
    const std::optional<Mat3> H = lattice_homography(lattice, rings_);
    if (!H) return std::numeric_limits<double>::max();
    double sum = 0;
    for (const auto& [cell, index] : lattice) {
      const Vec2 place_px = apply_homography(*H, Vec2(cell.second, cell.first));
      const double pitch_px = size_of(rings_[index].outer) / outer_radius_pitch_;
      sum += (rings_[index].centre_px - place_px).squaredNorm() / (pitch_px * pitch_px);
    }
    return std::sqrt(sum / static_cast<double>(lattice.size()));
  }

  const std::vector<Ring>& rings_;
  const std::vector<char>& taken_;
  const RingTarget& target_;
  double outer_radius_pitch_;
};

/// Looks again where the homography expects a ring that is not there: a shadow or a thumb may have hidden it
/// from the threshold while most of its edges can be seen.
std::vector<Ring> second_look(const image::GreyImage& picture, const GridView& view,
                              const RingTarget& target) {
  std::vector<PlanePoint> points;
  std::vector<char> present(static_cast<std::size_t>(target.rings()), 0);
  for (const GridRing& ring : view.rings) {
    points.push_back(
        {.plane = target.ring_target(ring.row, ring.col).head<2>(), .image = ring.ring.centre_px});
    present[static_cast<std::size_t>(ring.row * target.cols + ring.col)] = 1;
  }
  const std::optional<Mat3> H = fit_homography(points);
  std::vector<Ring> found;
  if (!H) return found;
  for (int row = 0; row < target.rows; ++row) {
    for (int col = 0; col < target.cols; ++col) {
      if (present[static_cast<std::size_t>(row * target.cols + col)]) continue;
      const Vec2 place = target.ring_target(row, col).head<2>();
      const std::optional<Ellipse> outer = project_circle(*H, place, target.outer_diameter_mm / 2);
      const std::optional<Ellipse> inner = project_circle(*H, place, target.inner_diameter_mm / 2);
      if (!outer || !inner) continue;
      if (std::optional<Ring> ring = refine_ring(picture, *outer, *inner)) found.push_back(std::move(*ring));
    }
  }
  return found;
}

}  // namespace

std::vector<GridView> find_grids(const std::vector<Ring>& rings, const RingTarget& target, int count) {
  std::vector<GridView> views;
  std::vector<char> taken(rings.size(), 0);
  for (int i = 0; i < count; ++i) {
    const Lattice lattice = Grower(rings, taken, target).best();
    std::optional<GridView> view = numbered(lattice, rings, target, numberings(lattice, target));
    if (!view) break;
    for (const auto& [cell, index] : lattice) taken[index] = 1;
    views.push_back(std::move(*view));
  }
  return views;
}

std::vector<GridView> find_grids(const image::GreyImage& picture, const RingTarget& target, int count) {
  if (target.chessboard()) return find_chessboards(picture, target, count);
  // Beside the target there may be others and much that only looks like rings.  Growing a grid tries every
  // ring with its neighbours against all others, so their number bounds the work.
  constexpr std::size_t k_surplus_ratio = 10, k_least_surplus = 1000;
  const std::size_t most =
      k_least_surplus + k_surplus_ratio * static_cast<std::size_t>(target.rings() * target.planes);
  std::vector<Ring> rings = find_rings(picture, most);
  std::vector<GridView> views = find_grids(rings, target, count);
  const std::size_t before = rings.size();
  for (const GridView& view : views) {
    if (view.missing == 0) continue;
    for (Ring& ring : second_look(picture, view, target)) rings.push_back(std::move(ring));
  }
  return rings.size() > before ? find_grids(rings, target, count) : views;
}

}  // namespace biteline::calibration
