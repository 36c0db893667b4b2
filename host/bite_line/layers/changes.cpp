// SPDX-License-Identifier: MIT
#include "host/bite_line/layers/changes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace biteline::bite_line {

namespace {

constexpr double k_near_mm = 100.0;  // lines climb by themselves, so that what lies farther says nothing

/// The side along a closed path.
class OnSide {
 public:
  OnSide(const SideField& field, std::span<const int> path) : field_{field}, path_{path} {}

  [[nodiscard]] std::size_t wrapped(int col) const {
    return static_cast<std::size_t>((col % cols() + cols()) % cols());
  }
  [[nodiscard]] int cols() const { return field_.grid.cols; }
  [[nodiscard]] int row(int col) const { return path_[wrapped(col)]; }
  [[nodiscard]] float turn_rad(int col) const { return field_.turn_rad[cell(col)]; }
  [[nodiscard]] bool seen(int col) const { return field_.seen[cell(col)] != 0; }
  [[nodiscard]] float usual_turn_rad() const {
    std::vector<float> turns;
    for (int col = 0; col < cols(); ++col) turns.push_back(turn_rad(col));
    const auto middle = turns.begin() + cols() / 2;
    std::nth_element(turns.begin(), middle, turns.end());
    return *middle;
  }

 private:
  [[nodiscard]] std::size_t cell(int col) const {
    return field_.grid.at(row(col), static_cast<int>(wrapped(col)));
  }
  const SideField& field_;
  std::span<const int> path_;
};

/// The course's directions before and behind a column, carried on to it.
struct Directions {
  double apart_mm;  ///< in height, of the later one over the earlier one
  double bend;      ///< of their slopes
};
Directions directions_at(const OnSide& course, const SideGrid& grid, int col, int half, int lever) {
  const auto fall = [&](int direction) {
    const int near = course.row(col + direction * half);
    return static_cast<double>(near - course.row(col + direction * (half + lever))) / lever;
  };
  const double before = fall(-1);
  const double behind = fall(1);
  const double rows = course.row(col + half) - course.row(col - half) + half * (behind - before);
  return {.apart_mm = rows * grid.row_mm, .bend = std::abs(before + behind) * grid.row_mm / grid.col_mm};
}

bool leaves_crease(const OnSide& course, int col, int half, float least_turn_rad) {
  bool leaves = false;
  int seen = 0;
  for (int c = col - half; c <= col + half; ++c) {
    leaves = leaves || (course.seen(c) && course.turn_rad(c) < least_turn_rad);
    seen += course.seen(c) ? 1 : 0;
  }
  return leaves && seen > half;
}

/// Columns from `col` on in one direction to the nearest long stretch that was not seen; all without one.
int cols_to_unseen(const OnSide& course, int col, int direction, int least_cols) {
  int run = 0;
  for (int k = 1; k < course.cols(); ++k) {
    run = course.seen(col + direction * k) ? 0 : run + 1;
    if (run == least_cols) return k - run;
  }
  return course.cols();
}

/// Columns from a change on in one direction to where the course has crossed half of its rise again; all
/// without one near by.
int cols_to_way_back(const OnSide& course, const SideGrid& grid, const LayerChange& change, int direction) {
  constexpr double k_beside_mm = 8.0;
  const auto cols_of = [&](double mm) { return static_cast<int>(std::lround(mm / grid.col_mm)); };
  const int beside = cols_of(k_beside_mm);
  const int here = course.row(change.col + direction * beside);
  const int away = course.row(change.col - direction * beside);
  for (int k = beside; k < std::min(cols_of(k_near_mm), course.cols()); ++k) {
    const int row = course.row(change.col + direction * k);
    if (std::abs(row - away) <= std::abs(row - here)) return k;
  }
  return course.cols();
}

/// How far in height another way lies from the course at a column, over it > 0; nothing where it is the
/// course.
std::optional<double> over_mm(const OnSide& course, const SideGrid& grid, const Branch& branch, int col) {
  const std::size_t k = course.wrapped(col - branch.first_col);
  if (k >= branch.row.size()) return std::nullopt;
  return (branch.row[k] - course.row(col)) * grid.row_mm;
}

/// Whether another way begins (ends, for the direction -1) at a change and goes on as if that were not: a
/// reach away from it half of the rise is still between them.
bool goes_on(const OnSide& course, const SideGrid& grid, const Branch& branch, const LayerChange& change,
             int direction, int half, int reach) {
  const int from_end = direction > 0 ? branch.first_col - change.col
                                     : change.col - branch.first_col - static_cast<int>(branch.row.size());
  const int away = static_cast<int>(course.wrapped(from_end + half));
  if (away > 2 * half) return false;
  const std::optional<double> over = over_mm(course, grid, branch, change.col + direction * reach);
  return over && -direction * *over * change.rise_mm >= change.rise_mm * change.rise_mm / 2;
}

/// The part of a course whose crease meets the one that it was on before a change.
OtherCrease until_they_meet(const OnSide& course, const SideGrid& grid, const LayerChange& change,
                            const ChangeConfig& config, std::span<const Branch> branches) {
  const auto cols_of = [&](double mm) { return static_cast<int>(std::lround(mm / grid.col_mm)); };
  const int half = cols_of(config.half_mm);
  const int reach = half + cols_of(config.lever_mm);
  const Branch* cheapest = nullptr;
  for (const Branch& branch : branches) {
    const bool comes_back = branch.row.size() < static_cast<std::size_t>(course.cols());
    const bool goes = comes_back && (goes_on(course, grid, branch, change, 1, half, reach) ||
                                     goes_on(course, grid, branch, change, -1, half, reach));
    if (goes && (cheapest == nullptr || branch.worse < cheapest->worse)) cheapest = &branch;
  }
  if (cheapest == nullptr) {
    const int near = std::min(cols_of(k_near_mm), (course.cols() - 1) / 2);
    return {.first_col = static_cast<int>(course.wrapped(change.col - near)),
            .cols = 2 * near,
            .off_mm = std::abs(change.rise_mm)};
  }
  OtherCrease other{.first_col = cheapest->first_col, .cols = static_cast<int>(cheapest->row.size())};
  for (int k = 0; k < other.cols; ++k) {
    const double over = over_mm(course, grid, *cheapest, other.first_col + k).value_or(0);
    other.off_mm = std::max(other.off_mm, std::abs(over));
  }
  return other;
}

}  // namespace

std::vector<LayerChange> layer_changes(const SideField& field, std::span<const int> path,
                                       const ChangeConfig& config) {
  const OnSide course{field, path};
  const int half = static_cast<int>(std::lround(config.half_mm / field.grid.col_mm));
  const int lever = static_cast<int>(std::lround(config.lever_mm / field.grid.col_mm));
  const float least_turn_rad = config.off_crease_ratio * course.usual_turn_rad();
  std::vector<double> apart;
  for (int col = 0; col < course.cols(); ++col) {
    const Directions here = directions_at(course, field.grid, col, half, lever);
    // Where the course bends, the column in the middle may lie beside the bend by as much.
    const bool is_change = std::abs(here.apart_mm) >= config.least_mm + config.half_mm * here.bend &&
                           leaves_crease(course, col, half, least_turn_rad);
    apart.push_back(is_change ? here.apart_mm : 0);
  }
  std::vector<LayerChange> changes;
  for (int col = 0; col < course.cols(); ++col) {
    const double here = std::abs(apart[static_cast<std::size_t>(col)]);
    bool most = here > 0;
    for (int c = 1; most && c <= 2 * half; ++c)
      most =
          std::abs(apart[course.wrapped(col - c)]) < here && std::abs(apart[course.wrapped(col + c)]) <= here;
    if (most) changes.push_back({.col = col, .rise_mm = apart[static_cast<std::size_t>(col)]});
  }
  return changes;
}

std::vector<OtherCrease> other_creases(const SideField& field, std::span<const int> path,
                                       std::span<const LayerChange> changes, const ChangeConfig& config,
                                       std::span<const Branch> branches) {
  constexpr double k_same_mm = 1.5;    // both steps are between the same two creases, which may draw apart
  constexpr double k_hides_mm = 10.0;  // so much unseen may hide a step
  const OnSide course{field, path};
  const int hides = static_cast<int>(std::lround(k_hides_mm / field.grid.col_mm));
  std::vector<OtherCrease> others;
  for (const LayerChange& change : changes) {
    OtherCrease shortest{.cols = course.cols(), .off_mm = std::abs(change.rise_mm)};
    const auto take = [&](int first, int cols) {
      if (cols >= shortest.cols) return;
      shortest.first_col = static_cast<int>(course.wrapped(first));
      shortest.cols = cols;
    };
    for (const LayerChange& back : changes) {
      if (&back == &change || std::abs(back.rise_mm + change.rise_mm) > k_same_mm) continue;
      const int behind = static_cast<int>(course.wrapped(back.col - change.col));
      take(change.col, behind);
      take(back.col, course.cols() - behind);
    }
    if (shortest.cols == course.cols()) {
      const auto cols_to = [&](int direction) {
        return std::min(cols_to_unseen(course, change.col, direction, hides),
                        cols_to_way_back(course, field.grid, change, direction));
      };
      take(change.col, cols_to(1));
      take(change.col - cols_to(-1), cols_to(-1));
    }
    const bool is_back = shortest.cols < course.cols();
    others.push_back(is_back ? shortest : until_they_meet(course, field.grid, change, config, branches));
  }
  return others;
}

}  // namespace biteline::bite_line
