// SPDX-License-Identifier: MIT
#include "host/bite_line/place/finish.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <tbb/parallel_for.h>

#include "common/core/fixed_text.hpp"
#include "host/bite_line/place/confidence.hpp"
#include "host/bite_line/place/point_spread.hpp"
#include "host/cloud/flagged.hpp"
#include "host/cloud/uncertainty/radius.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::bite_line {

namespace {

/// Why a line with so much flagged is a person's to look at; nothing where it is not.
std::optional<Refusal> flagged_refusal(const cloud::Flagged& flagged, const PlacedLine& placed) {
  if (!flagged.too_much()) return std::nullopt;
  using Text = FixedText<240>;
  Text in_front = Text::copy("");
  if (placed.thing_beside_mm > 0) {
    in_front = Text::format(
        "; something stands in front of it over %.0f mm (a pin, a clamp, a cable or the sole's own edge)",
        placed.thing_beside_mm);
  }
  if (flagged.uncertain > flagged.unsure) {
    return Refusal{Refused::TooMuchUncertain,
                   Text::format("U95 is above %.0f mm on %.0f %% of the line's length and %.0f %% is unsure "
                                "(together at most %.0f %%)%s",
                                cloud::k_sure_mm, 100 * flagged.uncertain, 100 * flagged.unsure,
                                100 * cloud::k_most_flagged_share, in_front.c_str())
                       .c_str()};
  }
  return Refusal{
      Refused::TooMuchUnsure,
      Text::format("%.0f %% of the line's length is unsure (at most %.0f %%); %.0f mm were not seen and are "
                   "bridged%s",
                   100 * flagged.all(), 100 * cloud::k_most_flagged_share, placed.bridged_mm,
                   in_front.c_str())
          .c_str()};
}

/// What a person must settle: what the points say already, else what was bridged, else all of it.
void flag_for_review(const Refusal& why, cloud::ClosedLine& line) {
  const auto flag = [&](bool all) {
    for (cloud::LinePoint& point : line.points) {
      if (all || point.source == cloud::PointSource::Bridged) point.flags |= cloud::k_line_unsure;
    }
  };
  if (why.code == Refused::TooMuchBridged || why.code == Refused::NoCreaseAllRound) flag(false);
  // By the flags alone, as whoever plans a path along it reads them.
  if (cloud::flagged_share(line) <= cloud::k_most_flagged_share) flag(true);
}

Candidate candidate_of(const JudgedPath& path, const Side& side) {
  const SideField& field = side.field;
  const Outline& outline = side.outline;
  const SideGrid& grid = field.grid;
  Candidate candidate{.confidence = path.confidence,
                      .mean_height_mm = path.mean_height_mm,
                      .length_mm = 0,
                      .closure_mm = 0,
                      .crease_deg = path.turn_rad * 180.0 / std::numbers::pi,
                      .seen_share = path.seen_share,
                      .points = {},
                      .lacks = path.lacks};
  for (int c = 0; c < grid.cols; ++c) {
    const double path_row = path.row[static_cast<std::size_t>(c)];
    const int row = std::clamp(static_cast<int>(std::lround(path_row)), 0, grid.rows - 1);
    const double s = (c + 0.5) * grid.col_mm;
    const Vec2 plan = outline.point(s) + static_cast<double>(field.o_mm[grid.at(row, c)]) * outline.normal(s);
    candidate.points.push_back(side.shoe.T_base_shoe * Vec3{plan.x(), plan.y(), grid.z_mm(path_row)});
  }
  candidate.length_mm = geometry::ArcLength{
      candidate.points.size(), [&](std::size_t i) {
        return candidate.points[i];
      }}.total_mm();
  return candidate;
}

}  // namespace

cloud::ClosedLine even_line(const PlacedLine& placed_line, const SE3& T_base_shoe, double of_line,
                            const uncertainty::WholeScan& scan, double spacing_mm) {
  const auto& placed = placed_line.points;
  const geometry::ArcLength along{placed.size(), [&](std::size_t i) { return placed[i].position; }};
  const std::size_t count = along.count_for(spacing_mm);
  std::vector<PointSpread> spreads(placed.size());
  tbb::parallel_for(std::size_t{0}, placed.size(), [&](std::size_t i) { spreads[i] = spread_of(placed[i]); });
  cloud::ClosedLine line;
  line.points.reserve(count);
  std::vector<PointSpread> own;
  own.reserve(count);
  for (const geometry::OnCurve& at : along.even(count)) {
    const PlacedStation& a = placed[at.before];
    const PlacedStation& b = placed[at.after];
    line.points.push_back({.position = T_base_shoe * at.between<Vec3>(a.position, b.position),
                           .normal = T_base_shoe.linear() * at.between<Vec3>(a.normal, b.normal).normalized(),
                           .tangent = Vec3::UnitX(),
                           .source = a.to_visible_mm > 0 || b.to_visible_mm > 0 ? cloud::PointSource::Bridged
                                                                                : cloud::PointSource::Seen});
    own.push_back(between(spreads[at.before], spreads[at.after], at.share));
  }
  add_tangents(line);
  turn_normals_across(line);
  const uncertainty::SpreadAlong whole{scan, count, [&](std::size_t k) { return line.points[k].position; }};
  const Vec3 up = T_base_shoe.linear().col(2);
  const double nothing_of_scan = uncertainty::chance_within({}, cloud::k_right_mm);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    cloud::LinePoint& point = line.points[k];
    // In the axes of the own spread: outwards and nearly up.
    const Eigen::Matrix2d of_scan = uncertainty::across(whole.at(k), point.tangent, up);
    const uncertainty::Axes axes = uncertainty::principal_axes(own[k].covariance_mm2 + of_scan);
    const double within_of_scan =
        scan.known() ? uncertainty::chance_within(uncertainty::principal_axes(of_scan), cloud::k_right_mm)
                     : nothing_of_scan;
    point.confidence = of_line * own[k].hold * own[k].within * within_of_scan;
    point.u95_mm = uncertainty::u95_mm(axes, own[k].hold, own[k].other_mm);
    cloud::flag_unsure(point);
  });
  return line;
}

namespace {

/// `use(point, direction)`: of each, between the places so far to either side.
template <class Use>
void for_directions(cloud::ClosedLine& line, double reach_mm, Use&& use) {
  const std::size_t count = line.points.size();
  if (count < 3) return;
  const double spacing_mm = cloud::length_mm(line) / static_cast<double>(count);
  const auto reach = std::clamp<std::size_t>(
      static_cast<std::size_t>(std::lround(reach_mm / std::max(spacing_mm, 1e-6))), 1, (count - 1) / 2);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 chord =
        line.points[(i + reach) % count].position - line.points[(i + count - reach) % count].position;
    if (chord.norm() > 1e-9) use(line.points[i], Vec3{chord.normalized()});
  }
}

}  // namespace

void add_tangents(cloud::ClosedLine& line) {
  // Noise of 0.02 mm in neighbours half a millimetre apart would turn them by degrees.
  constexpr double k_reach_mm = 1.5;
  for_directions(line, k_reach_mm, [](cloud::LinePoint& point, const Vec3& along) { point.tangent = along; });
}

void turn_normals_across(cloud::ClosedLine& line) {
  constexpr double k_reach_mm = 3;
  constexpr double k_most = 0.26;  // 15 degrees; on good lines they are within 10
  for_directions(line, k_reach_mm, [](cloud::LinePoint& point, const Vec3& along) {
    const double lean = point.normal.dot(along);
    if (std::abs(lean) <= k_most) return;
    const Vec3 across = (point.normal - lean * along).normalized();
    point.normal = std::sqrt(1 - k_most * k_most) * across + std::copysign(k_most, lean) * along;
  });
}

Extraction finish(const Side& side, const Decision& decision, const PlacedLine& placed, const Config& config,
                  const uncertainty::WholeScan& whole) {
  Extraction out{.confidence = decision.confidence, .T_base_shoe = side.shoe.T_base_shoe};
  out.gates = decision.gates;
  out.candidates.resize(decision.paths.size());
  tbb::parallel_for(std::size_t{0}, decision.paths.size(),
                    [&](std::size_t i) { out.candidates[i] = candidate_of(decision.paths[i], side); });
  out.refusal = decision.refusal;
  if (out.refusal && !decision.for_review) return out;
  const double bridged_share = placed.bridged_mm / std::max(placed.length_mm, 1.0);
  out.confidence = decision.confidence * (1 - bridged_share);
  out.length_mm = placed.length_mm;
  out.bridged_mm = placed.bridged_mm;
  if (!out.refusal && !(out.confidence >= config.min_confidence_ratio)) {
    out.refusal = Refusal{Refused::TooMuchBridged,
                          FixedText<200>::format("too much was not seen: %.0f of %.0f mm are bridged, which "
                                                 "leaves a confidence of %.2f (at least %.2f)",
                                                 placed.bridged_mm, placed.length_mm, out.confidence,
                                                 config.min_confidence_ratio)
                              .c_str()};
  }
  // What is left of the doubt in a written line is known of those that no gate says no to.
  const double of_line = decision.of_line < 0.5 ? decision.of_line : line_held_of(decision.of_line);
  out.line = even_line(placed, side.shoe.T_base_shoe, of_line, whole, config.point_spacing_mm);
  out.head_in_u95 = whole.head.has_value();
  out.arm = whole.arm;
  const cloud::Flagged flagged = cloud::flagged_of(out.line, config.min_confidence_ratio);
  out.confidence = std::min(out.confidence, 1 - flagged.all());
  if (!out.refusal) out.refusal = flagged_refusal(flagged, placed);
  if (!out.refusal) {
    out.found = true;
    return out;
  }
  out.confidence = std::min(out.confidence, 0.99 * config.min_confidence_ratio);
  flag_for_review(*out.refusal, out.line);
  return out;
}

Extraction refused(Refusal refusal, std::vector<report::StageTime> stages) {
  return {.refusal = std::move(refusal), .stages = std::move(stages)};
}

}  // namespace biteline::bite_line
