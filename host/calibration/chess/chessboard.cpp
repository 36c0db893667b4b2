// SPDX-License-Identifier: MIT
#include "host/calibration/chess/chessboard.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/calibration/rings/homography.hpp"
#include "host/calibration/rings/lattice.hpp"

namespace biteline::calibration {

namespace {

/// A neighbour lies along an edge of the corner, and one of its own edges points back.
constexpr double k_along_cos = 0.97;
/// From where its neighbours foretell it, in squares: lens distortion, far below the next corner.
constexpr double k_chess_reach_pitch = 0.15;
/// Pixels of a corner's fit stay this far from the next corners, in squares, and within what a lens bends.
constexpr double k_window_pitch = 0.42, k_least_window_px = 4, k_most_window_px = 14;
/// Cells about the one that is foretold.
constexpr int k_chess_near = 2;

bool has_edge_along(const Corner& corner, const Vec2& direction) {
  return std::max(std::abs(corner.edge_a.dot(direction)), std::abs(corner.edge_b.dot(direction))) >
         k_along_cos * direction.norm();
}

/// A board's corners by cell, and whether the square to the lower right of cell (0, 0) is bright.
struct Board {
  Lattice lattice;
  bool first_bright{false};
};

class BoardGrower {
 public:
  BoardGrower(const std::vector<Corner>& corners, const std::vector<Ring>& marks,
              const std::vector<char>& taken)
      : corners_{corners}, marks_{marks}, taken_{taken} {}

  [[nodiscard]] Board largest() const {
    Board best;
    // A corner of a board that was grown begins no other one.
    std::vector<char> seen = taken_;
    for (std::size_t seed = 0; seed < corners_.size(); ++seed) {
      if (seen[seed]) continue;
      Board grown = grow(seed);
      for (const auto& [cell, index] : grown.lattice) seen[index] = 1;
      if (grown.lattice.size() > best.lattice.size()) best = std::move(grown);
    }
    return best;
  }

 private:
  [[nodiscard]] std::optional<std::size_t> next_along(std::size_t from, const Vec2& direction) const {
    std::optional<std::size_t> best;
    double best_px = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (i == from || taken_[i]) continue;
      const Vec2 way = corners_[i].place_px - corners_[from].place_px;
      const double length_px = way.norm();
      if (length_px >= best_px || way.dot(direction) < k_along_cos * length_px) continue;
      if (!has_edge_along(corners_[i], way)) continue;
      best_px = length_px;
      best = i;
    }
    return best;
  }

  [[nodiscard]] std::optional<std::size_t> nearest_to(const Vec2& place_px, double reach_px) const {
    std::optional<std::size_t> best;
    double best_px = reach_px;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const double off_px = (corners_[i].place_px - place_px).norm();
      if (taken_[i] || off_px >= best_px) continue;
      best_px = off_px;
      best = i;
    }
    return best;
  }

  /// With `seed` as one of its corners, on whichever side there is one.
  [[nodiscard]] std::optional<Board> first_cell(std::size_t seed) const {
    const Corner& at = corners_[seed];
    // Rows follow columns clockwise on the picture, as the target's do: never a mirrored reading.
    for (const auto& [x, y] :
         {std::pair{at.edge_a, at.edge_b}, std::pair{at.edge_b, Vec2(-at.edge_a)},
          std::pair{Vec2(-at.edge_a), Vec2(-at.edge_b)}, std::pair{Vec2(-at.edge_b), at.edge_a}}) {
      const auto right = next_along(seed, x), below = next_along(seed, y);
      if (!right || !below) continue;
      const Vec2 to_right = corners_[*right].place_px - at.place_px,
                 to_below = corners_[*below].place_px - at.place_px;
      const auto diagonal =
          nearest_to(at.place_px + to_right + to_below, 0.4 * std::min(to_right.norm(), to_below.norm()));
      if (!diagonal || *diagonal == *right || *diagonal == *below || *diagonal == seed) continue;
      const Vec2 lower_right = to_right.normalized() + to_below.normalized();
      const bool bright = at.bright_towards(lower_right);
      if (corners_[*right].bright_towards(lower_right) == bright ||
          corners_[*below].bright_towards(lower_right) == bright ||
          corners_[*diagonal].bright_towards(lower_right) != bright)
        continue;
      return Board{.lattice = {{{0, 0}, seed}, {{0, 1}, *right}, {{1, 0}, *below}, {{1, 1}, *diagonal}},
                   .first_bright = bright};
    }
    return std::nullopt;
  }

  /// The corner at a cell, where those about it foretell one of the right colours and directions.
  [[nodiscard]] std::optional<std::size_t> corner_at(const Board& board, Cell cell,
                                                     const std::vector<char>& used) const {
    const std::optional<Mat3> H = local_homography(board.lattice, marks_, cell, k_chess_near);
    if (!H) return std::nullopt;
    const Vec2 at(cell.second, cell.first), place_px = apply_homography(*H, at);
    const Vec2 x = (apply_homography(*H, at + Vec2(0.5, 0)) - apply_homography(*H, at - Vec2(0.5, 0))),
               y = (apply_homography(*H, at + Vec2(0, 0.5)) - apply_homography(*H, at - Vec2(0, 0.5)));
    const auto found = nearest_to(place_px, k_chess_reach_pitch * std::min(x.norm(), y.norm()) + 0.5);
    if (!found || used[*found]) return std::nullopt;
    const Corner& corner = corners_[*found];
    const bool bright = board.first_bright == ((cell.first + cell.second) % 2 == 0);
    if (!has_edge_along(corner, x) || !has_edge_along(corner, y) ||
        corner.bright_towards(x.normalized() + y.normalized()) != bright)
      return std::nullopt;
    return found;
  }

  [[nodiscard]] Board grow(std::size_t seed) const {
    std::optional<Board> board = first_cell(seed);
    if (!board) return {};
    std::vector<char> used = taken_;
    for (const auto& [cell, index] : board->lattice) used[index] = 1;
    for (bool grew = true; grew;) {
      grew = false;
      const Lattice before = board->lattice;
      for (const auto& [cell, index] : before) {
        for (const Cell& step : {Cell{0, 1}, Cell{0, -1}, Cell{1, 0}, Cell{-1, 0}}) {
          const Cell next{cell.first + step.first, cell.second + step.second};
          if (board->lattice.contains(next)) continue;
          const auto found = corner_at(*board, next, used);
          if (!found) continue;
          board->lattice[next] = *found;
          used[*found] = 1;
          grew = true;
        }
      }
    }
    return std::move(*board);
  }

  const std::vector<Corner>& corners_;
  const std::vector<Ring>& marks_;
  const std::vector<char>& taken_;
};

/// Those under which the squares have the colours that they are printed with.
std::vector<Numbering> readings_of(const Board& board, const RingTarget& target) {
  std::vector<Numbering> readings = numberings(board.lattice, target);
  std::erase_if(readings, [&](const Numbering& numbering) {
    const Cell first = numbering.apply({0, 0});
    // A quarter turn puts another square to the lower right; and so does one row or column.
    const bool bright = board.first_bright == (numbering.quarter_turns % 2 == 0);
    const bool printed_bright = target.first_is_white == ((first.first + first.second) % 2 == 0);
    return bright != printed_bright;
  });
  return readings;
}

/// Again with as many pixels as the squares leave.
void refine_board(const image::GreyImage& picture, const Lattice& lattice, std::vector<Corner>& corners) {
  const std::vector<Corner> rough = corners;
  for (const auto& [cell, index] : lattice) {
    double square_px = std::numeric_limits<double>::max();
    for (const Cell& step : {Cell{0, 1}, Cell{0, -1}, Cell{1, 0}, Cell{-1, 0}}) {
      const auto next = lattice.find({cell.first + step.first, cell.second + step.second});
      if (next == lattice.end()) continue;
      square_px = std::min(square_px, (rough[next->second].place_px - rough[index].place_px).norm());
    }
    const double radius_px = std::clamp(k_window_pitch * square_px, k_least_window_px, k_most_window_px);
    if (const auto refined = refine_corner(picture, rough[index], radius_px, 1)) corners[index] = *refined;
  }
}

Ring mark_of(const Corner& corner) {
  Ring mark;
  mark.centre_px = corner.place_px;
  mark.blur_px = std::max(corner.blur_a_px, corner.blur_b_px);
  return mark;
}

}  // namespace

std::vector<GridView> find_chessboards(const image::GreyImage& picture, const RingTarget& target, int count) {
  std::vector<Corner> corners = find_corners(picture);
  std::vector<Ring> marks;
  for (const Corner& corner : corners) marks.push_back(mark_of(corner));
  std::vector<char> taken(corners.size(), 0);
  std::vector<GridView> views;
  for (int i = 0; i < count; ++i) {
    const Board board = BoardGrower(corners, marks, taken).largest();
    refine_board(picture, board.lattice, corners);
    for (const auto& [cell, index] : board.lattice) {
      marks[index] = mark_of(corners[index]);
      taken[index] = 1;
    }
    std::optional<GridView> view = numbered(board.lattice, marks, target, readings_of(board, target));
    if (!view) break;
    views.push_back(std::move(*view));
  }
  return views;
}

}  // namespace biteline::calibration
