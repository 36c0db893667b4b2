// SPDX-License-Identifier: MIT
#include "host/second_look/told_along.hpp"

#include <algorithm>
#include <cmath>

#include "host/second_look/bands.hpp"

namespace biteline::second_look {
namespace {

/// Rows of one stretch that count, in order.
struct Stretch {
  std::vector<std::size_t> row{};
  std::vector<double> length_mm{};  ///< half the way to the one before and half the way to the one behind
};

/// Sums over a part of a stretch.
struct Sum {
  double likelihood{0}, evidence{0}, length_mm{0};
  /// As much of it as the shortest gap that must be found would tell whether it is one.
  [[nodiscard]] bool could_tell() const {
    return length_mm > 0 && evidence * std::min(1.0, k_gap_mm / length_mm) >= 2 * k_told;
  }
};

class Line {
 public:
  Line(std::span<const RowScore> rows, double line_mm) : rows_{rows}, line_mm_{line_mm} {}

  [[nodiscard]] std::vector<Told> told() {
    told_.assign(rows_.size(), Told::Unclear);
    for (const Stretch& stretch : stretches()) judge(stretch);
    return told_;
  }

 private:
  using Counts = RowScore::Counts;

  /// The place to begin at: behind a row across which nothing is told, else the surest one.
  [[nodiscard]] std::size_t first_row() const {
    const auto broken = std::ranges::find(rows_, Counts::No, &RowScore::counts);
    if (broken != rows_.end()) return static_cast<std::size_t>(broken - rows_.begin());
    const auto surest = std::ranges::max_element(rows_, {}, &RowScore::likelihood);
    return static_cast<std::size_t>(surest - rows_.begin());
  }

  [[nodiscard]] std::vector<Stretch> stretches() const {
    std::vector<Stretch> all(1);
    if (rows_.empty()) return all;
    const std::size_t begin = first_row();
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const std::size_t i = (begin + k) % rows_.size();
      if (rows_[i].counts == Counts::No && !all.back().row.empty()) all.emplace_back();
      if (rows_[i].counts != Counts::Yes) continue;
      all.back().row.push_back(i);
      all.back().length_mm.push_back(0.5 * (way_mm(i, rows_.size() - 1) + way_mm(i, 1)));
    }
    return all;
  }

  /// To the next row that is not passed, by steps of `step` rows round.
  [[nodiscard]] double way_mm(std::size_t from, std::size_t step) const {
    std::size_t to = (from + step) % rows_.size();
    while (to != from && rows_[to].counts == Counts::Passed) to = (to + step) % rows_.size();
    return std::abs(std::remainder(rows_[to].along_mm - rows_[from].along_mm, line_mm_));
  }

  [[nodiscard]] Sum sum_of(const Stretch& stretch, std::size_t first, std::size_t end) const {
    Sum sum;
    for (std::size_t k = first; k < end; ++k) {
      sum.likelihood += rows_[stretch.row[k]].likelihood;
      sum.evidence += rows_[stretch.row[k]].evidence;
      sum.length_mm += stretch.length_mm[k];
    }
    return sum;
  }

  void set(const Stretch& stretch, std::size_t first, std::size_t end, Told told) {
    for (std::size_t k = first; k < end; ++k) told_[stretch.row[k]] = told;
  }

  void judge(const Stretch& stretch) {
    std::vector<double> unworked;
    for (const std::size_t row : stretch.row) unworked.push_back(-rows_[row].likelihood);
    set(stretch, 0, stretch.row.size(), Told::Worked);
    for (const Piece& piece : worked_pieces(unworked)) {
      const Sum sum = sum_of(stretch, piece.first, piece.end);
      if (sum.length_mm >= k_least_told_mm && sum.could_tell() && !by_one_row(stretch, piece))
        set(stretch, piece.first, piece.end, Told::Missing);
    }
    for (std::size_t first = 0; first < stretch.row.size();) {
      std::size_t end = first;
      while (end < stretch.row.size() && told_[stretch.row[end]] != Told::Missing) ++end;
      doubt(stretch, first, end);
      first = end + 1;
    }
  }

  /// Without one of its rows a missing piece would not be told: that row may lie off.
  [[nodiscard]] bool by_one_row(const Stretch& stretch, const Piece& piece) const {
    for (std::size_t k = piece.first; k < piece.end; ++k) {
      const double others = piece.told + rows_[stretch.row[k]].likelihood;
      if (others < k_told && stretch.length_mm[k] < k_least_told_mm) return true;
    }
    return false;
  }

  /// Of a part without gaps: each piece that could be one.
  void doubt(const Stretch& stretch, std::size_t first, std::size_t part_end) {
    std::vector<std::pair<std::size_t, std::size_t>> unclear;
    for (std::size_t from = first; from < part_end; ++from) {
      std::size_t end = from;
      Sum sum;
      while (end < part_end && sum.length_mm < k_least_told_mm) sum = sum_of(stretch, from, ++end);
      const bool whole = sum.length_mm >= k_least_told_mm || from == first;
      if (whole && (sum.likelihood < k_told || !sum.could_tell())) unclear.emplace_back(from, end);
      if (end == part_end) break;
    }
    for (const auto& [from, end] : unclear) set(stretch, from, end, Told::Unclear);
  }

  std::span<const RowScore> rows_;
  double line_mm_;
  std::vector<Told> told_{};
};

}  // namespace

std::vector<Told> told_along(std::span<const RowScore> rows, double line_mm) {
  return Line{rows, line_mm}.told();
}

}  // namespace biteline::second_look
