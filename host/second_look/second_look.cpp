// SPDX-License-Identifier: MIT
#include "host/second_look/second_look.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <tbb/parallel_invoke.h>

#include "host/geometry/closed_curve.hpp"
#include "host/geometry/robust.hpp"
#include "host/second_look/bands.hpp"
#include "host/second_look/change.hpp"
#include "host/second_look/faults.hpp"
#include "host/second_look/judge.hpp"
#include "host/second_look/raster.hpp"

namespace biteline::second_look {
namespace {

/// Unworked surface is taken from here to here beside the plan; drops and wide edges are seen so far.
constexpr double k_beside_from_mm = 1.5, k_beside_to_mm = 10;
/// A station's plan is seen where so much of it is.
constexpr double k_least_seen_ratio = 0.25;
/// Where the tool goes is smooth along the line, standard deviation of its mean.
constexpr double k_middle_along_mm = 2;
/// A step or a groove makes ways on the surface longer by so much at most.
constexpr double k_longer_way_mm = 6;

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

bool has_stripe(const cloud::PointCloud& cloud) {
  return !cloud.amplitude.empty() && !cloud.width_px.empty();
}

Zones zones_of(const PlannedBand& plan, const Across& across) {
  const auto cell = [&](double mm) {
    return static_cast<std::size_t>(std::lround((mm - across.low_mm) / k_cell_mm));
  };
  return {.low_cell = cell(plan.low_mm),
          .end_cell = cell(plan.high_mm),
          .below_end_cell = cell(plan.low_mm - k_beside_from_mm),
          .above_first_cell = cell(plan.high_mm + k_beside_from_mm)};
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
  const Zones zones = zones_of(plan, wish.across);
  RasterWish by_profile = wish;
  by_profile.by_profile = !second.profile.empty();
  // At the same time: a second look holds a shoe up.
  Change change;
  tbb::parallel_invoke(
      [&] {
        findings.moved =
            transfer::moved_since(without_band(first, frame, ways, plan, wish.reach_mm),
                                  without_band(second, frame, ways, plan, wish.reach_mm), places);
      },
      [&] {
        change = change_of(raster_of(first, frame, ways, wish), raster_of(second, frame, ways, by_profile),
                           zones, frame.step_mm(), wish.stripe);
      });
  findings.refusal = refusal_of(findings.moved);
  if (findings.refusal) return findings;

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
  findings.faults = judge({.frame = frame,
                           .ways = ways,
                           .plan = plan,
                           .zones = zones,
                           .change = change,
                           .expected = expected,
                           .shown = shown,
                           .rows = rows},
                          findings.places);
  sum_up(findings, expected, change, rows);
  return findings;
}

}  // namespace biteline::second_look
