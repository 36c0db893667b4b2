// SPDX-License-Identifier: MIT
#include "host/second_look/judge.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "host/geometry/closed_curve.hpp"
#include "host/geometry/robust.hpp"
#include "host/second_look/told_along.hpp"

namespace biteline::second_look {
namespace {

/// Edges are sought by the stations so far to either side: five profiles of a fast scan.
constexpr double k_edge_along_mm = 2.5;
/// A median's variance against a mean's: 2 / pi.
constexpr double k_median_efficiency = 0.64;
/// Changed by so many times what one layer changes, surely: two layers.
constexpr double k_doubled_ratio = 1.5;
constexpr double k_sigmas_95 = 1.96;
/// Across the line, of an arm that repeats a place within 0.05 mm (transfer/moved.cpp), one coordinate.
constexpr double k_arm_u95_mm = 0.028;

class Judge {
 public:
  explicit Judge(const Bench& bench)
      : bench_{bench}, blank_{bench.rows.blank}, seen_(bench.rows.size()), own_(bench.rows.size()) {}

  [[nodiscard]] std::vector<Fault> run(std::vector<BandPlace>& places) {
    std::vector<RowScore> scores;
    for (std::size_t i = 0; i < places.size(); ++i) {
      likelihood_.push_back(likelihood_of(bench_.change, bench_.expected.change[i], i, SumOver::Piece));
      scores.push_back(score_of(i, places[i]));
    }
    std::vector<Told> told = told_along(scores, bench_.frame.length_mm());
    // What is told of must have been seen.
    if (std::ranges::count(told, Told::Worked) < static_cast<std::ptrdiff_t>(k_least_shown))
      std::ranges::fill(told, Told::Unclear);
    for (std::size_t i = 0; i < places.size(); ++i)
      if (blank_[i] == 0) judge_row(i, told[i], places[i]);
    for (std::size_t i = 0; i < places.size(); ++i)
      if (places[i].worked) find_edges(i, places);
    fill_blanks(places);
    return join_faults(seen_, bench_.rows, bench_.frame, bench_.ways);
  }

 private:
  void judge_row(std::size_t i, Told told, BandPlace& place) {
    if (!place.planned)
      judge_unplanned(i);
    else if (told == Told::Worked)
      judge_worked(i, place);
    else if (told == Told::Missing)
      judge_missing(i);
    else
      place.unclear = bench_.shown[i] != 0 ? Unclear::NoContrast : Unclear::NotSeen;
  }

  [[nodiscard]] double mm(std::size_t cell) const {
    return bench_.change.across.mm(static_cast<double>(cell));
  }
  [[nodiscard]] bool overlaps_plan(const Piece& piece) const {
    return piece.first < bench_.zones.end_cell && piece.end > bench_.zones.low_cell;
  }

  /// By all of the plan; or, where no more of it was worked, by the piece that was.
  [[nodiscard]] RowScore score_of(std::size_t i, const BandPlace& place) const {
    const std::vector<double> all = likelihood_of(bench_.change, bench_.expected.change[i], i, SumOver::Band);
    const std::span<const double> plan =
        std::span{all}.subspan(bench_.zones.low_cell, bench_.zones.end_cell - bench_.zones.low_cell);
    const double piece = best_piece(plan).told;
    using Counts = RowScore::Counts;
    return {.along_mm = place.along_mm,
            .likelihood = piece >= k_told ? piece : std::accumulate(plan.begin(), plan.end(), 0.0),
            .evidence = bench_.expected.evidence[i],
            .counts = blank_[i] != 0                          ? Counts::Passed
                      : place.planned && bench_.shown[i] != 0 ? Counts::Yes
                                                              : Counts::No};
  }

  /// Pieces of a row that were worked, in the plan and apart from it.
  struct Pieces {
    std::vector<Piece> inside{}, outside{};
  };
  [[nodiscard]] Pieces pieces_of(std::size_t i, bool planned) const {
    Pieces pieces;
    for (const Piece& piece : worked_pieces(likelihood_[i]))
      (planned && overlaps_plan(piece) ? pieces.inside : pieces.outside).push_back(piece);
    return pieces;
  }

  void judge_unplanned(std::size_t i) {
    if (bench_.shown[i] == 0 || bench_.expected.evidence[i] < 2 * k_told) return;
    add_beside(i, pieces_of(i, false).outside);
  }

  void add_beside(std::size_t i, const std::vector<Piece>& pieces) {
    for (const Piece& piece : pieces)
      seen_[i].push_back({.kind = FaultKind::Beside, .low_mm = mm(piece.first), .high_mm = mm(piece.end)});
  }

  void judge_missing(std::size_t i) {
    seen_[i].push_back(
        {.kind = FaultKind::Missing, .low_mm = bench_.plan.low_mm, .high_mm = bench_.plan.high_mm});
    add_beside(i, pieces_of(i, true).outside);
  }

  void judge_worked(std::size_t i, BandPlace& place) {
    std::vector<Piece> inside = pieces_of(i, true).inside;
    // Grain may hide in a piece what all of the band tells.
    if (inside.empty()) inside.push_back({.first = bench_.zones.low_cell, .end = bench_.zones.end_cell});
    place.worked = true;
    std::ranges::sort(inside, {}, &Piece::first);
    own_[i] = {.first = inside.front().first, .end = inside.back().end};
    low_middle_[i] = (inside.front().first + inside.front().end) / 2;
    high_middle_[i] = (inside.back().first + inside.back().end) / 2;
    for (std::size_t k = 1; k < inside.size(); ++k)
      seen_[i].push_back(
          {.kind = FaultKind::Missing, .low_mm = mm(inside[k - 1].end), .high_mm = mm(inside[k].first)});
    const Piece planned{.first = std::max(own_[i].first, bench_.zones.low_cell),
                        .end = std::min(own_[i].end, bench_.zones.end_cell)};
    const Multiple multiple = multiple_of(bench_.change, bench_.expected.change[i], i, planned);
    const bool twice =
        std::ranges::any_of(bench_.plan.twice, [&](const Arc& arc) { return within(arc, place.along_mm); });
    if (!twice && multiple.ratio - k_sigmas_95 * multiple.sigma > k_doubled_ratio)
      seen_[i].push_back(
          {.kind = FaultKind::Doubled, .low_mm = mm(own_[i].first), .high_mm = mm(own_[i].end)});
  }

  /// The row and the worked ones beside it, as far as none between is unworked.
  [[nodiscard]] std::vector<std::size_t> run_about(std::size_t i,
                                                   const std::vector<BandPlace>& places) const {
    std::vector<std::size_t> run{i};
    for (const std::ptrdiff_t side : {-1, 1}) {
      for (std::ptrdiff_t k = 1; k < static_cast<std::ptrdiff_t>(places.size()); ++k) {
        const std::size_t n = geometry::round_index(i, side * k, places.size());
        const double way_mm = side > 0 ? bench_.rows.way_mm(i, n) : bench_.rows.way_mm(n, i);
        if (way_mm > k_edge_along_mm) break;
        if (blank_[n] != 0) continue;
        if (!places[n].worked) break;
        run.push_back(n);
      }
    }
    return run;
  }

  /// What they say together: of each cell the median, so that one profile on a seam moves no edge.
  [[nodiscard]] std::vector<double> along(std::size_t i, const std::vector<BandPlace>& places) const {
    const std::vector<std::size_t> run = run_about(i, places);
    std::vector<double> sum(bench_.change.across.cells, 0.0), values;
    for (std::size_t j = 0; j < sum.size(); ++j) {
      values.clear();
      for (const std::size_t n : run)
        if (bench_.change.known(bench_.change.at(n, j))) values.push_back(likelihood_[n][j]);
      if (values.empty()) continue;
      sum[j] = k_median_efficiency * static_cast<double>(values.size()) *
               geometry::median_of(std::span<double>{values});
    }
    return sum;
  }

  [[nodiscard]] std::optional<BandEdge> edge_of(std::size_t i, const End& end) const {
    const double across_mm = bench_.change.across.mm(end.cell);
    const double u95_mm = std::hypot(k_sigmas_95 * end.sigma_cells * k_cell_mm, k_arm_u95_mm);
    if (u95_mm > bench_.plan.tolerance_mm) return std::nullopt;
    const std::size_t station = bench_.frame.nearest(bench_.rows.along_mm[i]);
    return BandEdge{.across_mm = across_mm,
                    .u95_mm = u95_mm,
                    .base = bench_.ways.point(bench_.frame.at(station), station, across_mm)};
  }

  void find_edges(std::size_t i, std::vector<BandPlace>& places) {
    const std::vector<double> sum = along(i, places);
    places[i].low = edge_of(i, end_of(sum, {.middle = low_middle_[i], .limit = 0}));
    places[i].high = edge_of(i, end_of(sum, {.middle = high_middle_[i], .limit = sum.size()}));
    judge_edges(i, places[i]);
    look_beside(i, places[i]);
  }

  /// What else was worked, apart from the band.
  void look_beside(std::size_t i, const BandPlace& place) {
    const std::span<const double> all{likelihood_[i]};
    const auto cell = [&](double mm) {
      return std::clamp((mm - bench_.change.across.low_mm) / k_cell_mm, 0.0, static_cast<double>(all.size()));
    };
    const auto add = [&](std::size_t first, std::size_t count) {
      for (const Piece& piece : worked_pieces(all.subspan(first, count)))
        seen_[i].push_back(
            {.kind = FaultKind::Beside, .low_mm = mm(first + piece.first), .high_mm = mm(first + piece.end)});
    };
    const double tolerance_mm = bench_.plan.tolerance_mm;
    if (place.low) add(0, static_cast<std::size_t>(cell(place.low->across_mm - tolerance_mm)));
    if (!place.high) return;
    const auto first = static_cast<std::size_t>(std::ceil(cell(place.high->across_mm + tolerance_mm)));
    add(first, all.size() - first);
  }

  void judge_edges(std::size_t i, const BandPlace& place) {
    enum Side { Inside = -1, Right = 0, Outside = 1 };
    const auto side = [&](const std::optional<BandEdge>& edge, double planned_mm, double outward) {
      if (!edge) return Right;
      const double out_mm = outward * (edge->across_mm - planned_mm);
      if (std::abs(out_mm) - edge->u95_mm <= bench_.plan.tolerance_mm) return Right;
      return out_mm > 0 ? Outside : Inside;
    };
    const Side low = side(place.low, bench_.plan.low_mm, -1), high = side(place.high, bench_.plan.high_mm, 1);
    if (low == Right && high == Right) return;
    const FaultKind kind = low * high < 0                    ? FaultKind::Beside
                           : low == Inside || high == Inside ? FaultKind::Narrow
                                                             : FaultKind::Wide;
    // From the edge to where it should be.
    const auto part = [&](const std::optional<BandEdge>& edge, double planned_mm) {
      seen_[i].push_back({.kind = kind,
                          .low_mm = std::min(edge->across_mm, planned_mm),
                          .high_mm = std::max(edge->across_mm, planned_mm)});
    };
    if (low != Right) part(place.low, bench_.plan.low_mm);
    if (high != Right) part(place.high, bench_.plan.high_mm);
  }

  /// A place that tells nothing of its own is as the nearest one before it that does.
  void fill_blanks(std::vector<BandPlace>& places) const {
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (blank_[i] == 0) continue;
      for (std::size_t k = 1; k < places.size(); ++k) {
        const std::size_t n = (i + places.size() - k) % places.size();
        if (blank_[n] != 0) continue;
        places[i].worked = places[i].planned && places[n].worked;
        if (places[i].planned) places[i].unclear = places[n].unclear;
        break;
      }
    }
  }

  Bench bench_;
  const std::vector<std::uint8_t>& blank_;
  SeenAt seen_;
  std::vector<Piece> own_;
  std::vector<std::size_t> low_middle_ = std::vector<std::size_t>(own_.size(), 0),
                           high_middle_ = std::vector<std::size_t>(own_.size(), 0);
  std::vector<std::vector<double>> likelihood_;
};

}  // namespace

bool within(const Arc& arc, double mm) {
  return arc.from_mm <= arc.to_mm ? mm >= arc.from_mm && mm <= arc.to_mm
                                  : mm >= arc.from_mm || mm <= arc.to_mm;
}

std::vector<Fault> judge(const Bench& bench, std::vector<BandPlace>& places) {
  return Judge{bench}.run(places);
}

}  // namespace biteline::second_look
