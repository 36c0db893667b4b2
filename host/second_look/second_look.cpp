// SPDX-License-Identifier: MIT
#include "host/second_look/second_look.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "host/geometry/closed_curve.hpp"
#include "host/geometry/robust.hpp"
#include "host/second_look/bands.hpp"
#include "host/second_look/change.hpp"
#include "host/second_look/faults.hpp"
#include "host/second_look/raster.hpp"

namespace biteline::second_look {
namespace {

/// Unworked surface is taken from here to here beside the plan; drops and wide edges are seen so far.
constexpr double k_beside_from_mm = 1.5, k_beside_to_mm = 10;
/// A station's plan is seen where so much of it is.
constexpr double k_least_seen_ratio = 0.25;
/// Edges are sought by the stations so far to either side: five profiles of a fast scan.
constexpr double k_edge_along_mm = 2.5;
/// A median's variance against a mean's: 2 / pi.
constexpr double k_median_efficiency = 0.64;
/// Where the tool goes is smooth along the line, standard deviation of its mean.
constexpr double k_middle_along_mm = 2;
/// A step or a groove makes ways on the surface longer by so much at most.
constexpr double k_longer_way_mm = 6;
/// Changed by so many times what one layer changes, surely: two layers.
constexpr double k_doubled_ratio = 1.5;
constexpr double k_sigmas_95 = 1.96;
/// Across the line, of an arm that repeats a place within 0.05 mm (transfer/moved.cpp), one coordinate.
constexpr double k_arm_u95_mm = 0.028;

/// What both scans have of the shoe besides the band: that did not change.
cloud::PointCloud without_band(const cloud::PointCloud& cloud, const LineFrame& frame,
                               const SurfaceWays& ways, const PlannedBand& plan, double reach_mm) {
  cloud::PointCloud kept;
  for (const Eigen::Vector3f& p : cloud.points) {
    LineFrame::Place place;
    if (frame.place(p.cast<double>(), reach_mm, place)) {
      const double way_mm = ways.way_mm(place.station, place.up_mm);
      if (way_mm > plan.low_mm - k_beside_from_mm && way_mm < plan.high_mm + k_beside_from_mm) continue;
    }
    kept.points.push_back(p);
  }
  return kept;
}

/// A motion is told by the clouds.  Where it is not told whether another shoe of the kind stands there, its
/// surface differs from the first one's, and that is the noise that changes are judged by.
std::optional<Refusal> refusal_of(const transfer::Moved& moved) {
  if (moved.verdict == transfer::Moved::Verdict::Moved)
    return Refusal{.code = Refused::ShoeMoved, .reason = moved.words};
  if (moved.u95_mm > 0) return std::nullopt;
  const bool other = moved.verdict == transfer::Moved::Verdict::OtherShoe;
  return Refusal{.code = other ? Refused::OtherShoe : Refused::NotSeen, .reason = moved.words};
}

/// How far the middle of the plan lies above where the plan's ways have it; of each station.  Empty: nobody
/// says where the tool goes.
std::vector<double> off_the_plan(const LineFrame& frame, const SurfaceWays& ways, const PlannedBand& plan,
                                 double reach_mm) {
  struct At {
    double along_mm, off_mm;
  };
  std::vector<At> at;
  for (const Vec3& middle : plan.middle_base) {
    LineFrame::Place place;
    if (!frame.place(middle, reach_mm, place)) continue;
    at.push_back({.along_mm = frame.step_mm() * static_cast<double>(place.station) + place.along_mm,
                  .off_mm = ways.way_mm(place.station, place.up_mm) - (plan.low_mm + plan.high_mm) / 2});
  }
  if (at.empty()) return {};
  std::ranges::sort(at, {}, &At::along_mm);
  // Straight from one to the next, and round.
  std::vector<double> off(frame.size());
  for (std::size_t i = 0; i < off.size(); ++i) {
    const double mm = frame.step_mm() * static_cast<double>(i);
    const auto found = std::ranges::upper_bound(at, mm, {}, &At::along_mm);
    const auto next = static_cast<std::size_t>(found - at.begin());
    const At &a = at[(next + at.size() - 1) % at.size()], &b = at[next % at.size()];
    const double way_mm = std::fmod(b.along_mm - a.along_mm + frame.length_mm(), frame.length_mm()),
                 here_mm = std::fmod(mm - a.along_mm + frame.length_mm(), frame.length_mm());
    const double share = way_mm > 0 ? std::clamp(here_mm / way_mm, 0.0, 1.0) : 0;
    off[i] = a.off_mm + share * (b.off_mm - a.off_mm);
  }
  return geometry::smooth_closed(off, k_middle_along_mm / frame.step_mm());
}

bool within(const Arc& arc, double mm) {
  return arc.from_mm <= arc.to_mm ? mm >= arc.from_mm && mm <= arc.to_mm
                                  : mm >= arc.from_mm || mm <= arc.to_mm;
}

bool has_stripe(const cloud::PointCloud& cloud) {
  return !cloud.amplitude.empty() && !cloud.width_px.empty();
}

/// Rows whose plan is in both scans.
std::vector<std::uint8_t> shown_rows(const Change& change, const Zones& zones) {
  std::vector<std::uint8_t> shown(change.rows(), 0);
  const auto all = static_cast<double>(zones.end_cell - zones.low_cell);
  for (std::size_t i = 0; i < change.rows(); ++i) {
    std::size_t known = 0;
    for (std::size_t j = zones.low_cell; j < zones.end_cell; ++j)
      known += change.known(change.at(i, j)) ? 1 : 0;
    shown[i] = static_cast<double>(known) >= k_least_seen_ratio * all ? 1 : 0;
  }
  return shown;
}

/// Rows that are not shown between ones that are, nearer together than a gap that must be found.
std::vector<std::uint8_t> blank_rows(const std::vector<std::uint8_t>& shown,
                                     const std::vector<double>& along_mm, double line_mm) {
  const std::size_t count = shown.size();
  std::vector<std::uint8_t> blank(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (shown[i] != 0) continue;
    std::size_t before = 1, behind = 1;
    while (before < count && shown[(i + count - before) % count] == 0) ++before;
    while (behind < count && shown[(i + behind) % count] == 0) ++behind;
    const double apart_mm = along_mm[(i + behind) % count] - along_mm[(i + count - before) % count];
    blank[i] = std::fmod(apart_mm + line_mm, line_mm) <= k_most_apart_mm && before + behind < count ? 1 : 0;
  }
  return blank;
}

/// Everything that the rows are judged by.
struct Bench {
  const LineFrame& frame;
  const SurfaceWays& ways;
  const PlannedBand& plan;
  const Zones& zones;
  const Change& change;
  const Expected& expected;
  const std::vector<std::uint8_t>& shown;
  const RowsOnLine& rows;
};

class Judge {
 public:
  explicit Judge(const Bench& bench)
      : bench_{bench}, blank_{bench.rows.blank}, seen_(bench.rows.size()), own_(bench.rows.size()) {}

  void run(Findings& findings) {
    for (std::size_t i = 0; i < findings.places.size(); ++i) {
      likelihood_.push_back(likelihood_of(bench_.change, bench_.expected.change[i], i, SumOver::Piece));
      if (blank_[i] == 0) judge_row(i, findings.places[i]);
    }
    blank_untold(findings.places);
    for (std::size_t i = 0; i < findings.places.size(); ++i)
      if (findings.places[i].worked) find_edges(i, findings.places);
    fill_blanks(findings.places);
    findings.faults = join_faults(
        seen_, {.along_mm = bench_.change.along_mm, .blank = blank_, .line_mm = bench_.frame.length_mm()},
        bench_.frame, bench_.ways);
  }

 private:
  [[nodiscard]] double mm(std::size_t cell) const {
    return bench_.change.across.mm(static_cast<double>(cell));
  }
  [[nodiscard]] bool overlaps_plan(const Piece& piece) const {
    return piece.first < bench_.zones.end_cell && piece.end > bench_.zones.low_cell;
  }

  [[nodiscard]] std::optional<Unclear> unclear_of(std::size_t i) const {
    if (bench_.shown[i] == 0) return Unclear::NotSeen;
    if (bench_.expected.evidence[i] < 2 * k_told) return Unclear::NoContrast;
    return std::nullopt;
  }

  /// By all of the plan: worked, not worked, or neither can be told.
  [[nodiscard]] std::optional<bool> worked_at(std::size_t i) const {
    const std::vector<double> all = likelihood_of(bench_.change, bench_.expected.change[i], i, SumOver::Band);
    const std::span<const double> plan =
        std::span{all}.subspan(bench_.zones.low_cell, bench_.zones.end_cell - bench_.zones.low_cell);
    if (best_piece(plan).told >= k_told) return true;
    if (std::accumulate(plan.begin(), plan.end(), 0.0) <= -k_told) return false;
    return std::nullopt;
  }

  void judge_row(std::size_t i, BandPlace& place) {
    const std::optional<Unclear> unclear = unclear_of(i);
    if (place.planned) place.unclear = unclear;
    if (unclear) return;
    std::vector<Piece> inside, outside;
    for (const Piece& piece : worked_pieces(likelihood_[i])) {
      if (overlaps_plan(piece))
        inside.push_back(piece);
      else
        outside.push_back(piece);
    }
    const std::optional<bool> worked = place.planned ? worked_at(i) : false;
    if (worked != true) {
      if (!place.planned) outside.insert(outside.end(), inside.begin(), inside.end());
      for (const Piece& piece : outside)
        seen_[i].push_back({.kind = FaultKind::Beside, .low_mm = mm(piece.first), .high_mm = mm(piece.end)});
    }
    if (!place.planned) return;
    if (!worked) place.unclear = Unclear::NoContrast;
    if (worked == false)
      seen_[i].push_back(
          {.kind = FaultKind::Missing, .low_mm = bench_.plan.low_mm, .high_mm = bench_.plan.high_mm});
    if (worked != true) return;
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
    const Multiple multiple = multiple_of(bench_.change, bench_.expected.change[i], i, own_[i]);
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

  /// A row that does not tell, between ones that do, hides no gap that must be found.
  void blank_untold(const std::vector<BandPlace>& places) {
    std::vector<std::uint8_t> told;
    for (std::size_t i = 0; i < places.size(); ++i)
      told.push_back(blank_[i] == 0 && !places[i].unclear ? 1 : 0);
    blank_ = blank_rows(told, bench_.change.along_mm, bench_.frame.length_mm());
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
  std::vector<std::uint8_t> blank_;
  SeenAt seen_;
  std::vector<Piece> own_;
  std::vector<std::size_t> low_middle_ = std::vector<std::size_t>(own_.size(), 0),
                           high_middle_ = std::vector<std::size_t>(own_.size(), 0);
  std::vector<std::vector<double>> likelihood_;
};

void sum_up(Findings& findings, const Expected& expected, const Change& change, const RowsOnLine& rows) {
  std::vector<double> contrast;
  const std::size_t count = rows.size();
  for (std::size_t i = 0; i < count; ++i) {
    const BandPlace& place = findings.places[i];
    if (!place.planned) continue;
    const double here_mm = 0.5 * (rows.way_mm((i + count - 1) % count, i) + rows.way_mm(i, (i + 1) % count));
    findings.planned_mm += here_mm;
    if (place.worked) findings.worked_mm += here_mm;
    if (place.unclear) findings.unclear_mm += here_mm;
    if (change.seen[i] != 0) contrast.push_back(std::sqrt(2 * expected.evidence[i]));
  }
  if (!contrast.empty()) findings.contrast_ratio = geometry::median_of(std::span<double>{contrast});
  findings.light_ratio = std::exp(change.log_light);
  findings.cannot_tell = join_unclear(findings.places, rows);
  const bool told =
      std::ranges::any_of(findings.places, [](const BandPlace& p) { return p.planned && !p.unclear; });
  if (!told)
    findings.refusal =
        Refusal{.code = Refused::NothingToTell,
                .reason = "nowhere along the line the two scans differ by more than their noise"};
}

}  // namespace

Findings look_again(const cloud::PointCloud& first, const cloud::PointCloud& second,
                    const cloud::ClosedLine& line, const PlannedBand& plan) {
  const LineFrame frame{line};
  Findings findings{.line_mm = frame.length_mm()};
  const double low_mm = plan.low_mm - k_beside_to_mm, high_mm = plan.high_mm + k_beside_to_mm;
  const double longer_mm = plan.middle_base.empty() ? 0 : k_longer_way_mm;
  const RasterWish wish{
      .reach_mm = std::max(std::abs(low_mm), std::abs(high_mm)) + longer_mm,
      .across = {.low_mm = low_mm,
                 .cells = static_cast<std::size_t>(std::lround((high_mm - low_mm) / k_cell_mm))},
      .stripe = has_stripe(first) && has_stripe(second)};
  SurfaceWays ways{first, frame, wish.reach_mm};
  ways.count_from(off_the_plan(frame, ways, plan, wish.reach_mm));
  std::vector<Vec3> places;
  for (const cloud::LinePoint& p : line.points) places.push_back(p.position);
  const transfer::Moved moved =
      transfer::moved_since(without_band(first, frame, ways, plan, wish.reach_mm),
                            without_band(second, frame, ways, plan, wish.reach_mm), places);
  findings.moved = moved;
  findings.refusal = refusal_of(moved);
  if (findings.refusal) return findings;

  const auto cell = [&](double mm) {
    return static_cast<std::size_t>(std::lround((mm - low_mm) / k_cell_mm));
  };
  const Zones zones{.low_cell = cell(plan.low_mm),
                    .end_cell = cell(plan.high_mm),
                    .below_end_cell = cell(plan.low_mm - k_beside_from_mm),
                    .above_first_cell = cell(plan.high_mm + k_beside_from_mm)};
  RasterWish by_profile = wish;
  by_profile.by_profile = !second.profile.empty();
  const Change change =
      change_of(raster_of(first, frame, ways, wish), raster_of(second, frame, ways, by_profile), zones,
                frame.step_mm(), wish.stripe);
  std::vector<std::uint8_t> planned;
  for (const double along_mm : change.along_mm) {
    const bool left_out =
        std::ranges::any_of(plan.left_out, [&](const Arc& arc) { return within(arc, along_mm); });
    planned.push_back(left_out ? 0 : 1);
    findings.places.push_back({.along_mm = along_mm, .planned = !left_out});
  }
  const Expected expected = expected_change(change, zones, planned);
  const std::vector<std::uint8_t> shown = shown_rows(change, zones);
  const std::vector<std::uint8_t> blank = blank_rows(shown, change.along_mm, frame.length_mm());
  const RowsOnLine rows{.along_mm = change.along_mm, .blank = blank, .line_mm = frame.length_mm()};
  Judge{{.frame = frame,
         .ways = ways,
         .plan = plan,
         .zones = zones,
         .change = change,
         .expected = expected,
         .shown = shown,
         .rows = rows}}
      .run(findings);
  sum_up(findings, expected, change, rows);
  return findings;
}

}  // namespace biteline::second_look
