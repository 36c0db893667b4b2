// SPDX-License-Identifier: MIT
#include "host/bite_line/edit/edit.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/core/fixed_text.hpp"
#include "host/geometry/closed_curve.hpp"

namespace biteline::edit {
namespace {

using cloud::ClosedLine;
using cloud::LinePoint;
using cloud::PointSource;
using Text = FixedText<240>;

constexpr double k_shortest_mm = 2.0;

geometry::ArcLength arc_of(const ClosedLine& line) {
  return {line.points.size(), [&](std::size_t i) { return line.points[i].position; }};
}

/// What calibration, poses and clock leave is in each U95 of a line that was found, so it is no more than
/// that of its surest place.  A crease or a hand knows nothing of it.  A place that may be on another crease
/// tells nothing of it either: where all may be, a hand's own counts.
double least_u95_mm(const Surface& surface, const ClosedLine& line) {
  std::optional<double> least;
  bool known = false;
  for (const LinePoint& point : line.points) {
    if (!point.u95_mm) continue;
    known = true;
    if (surface.sure_beside(point.position)) least = std::min(least.value_or(*point.u95_mm), *point.u95_mm);
  }
  return least.value_or(known ? k_hand_u95_mm : 0);
}

class Mending {
 public:
  Mending(const Surface& surface, const ClosedLine& base, const OldLine& old_line, By by,
          std::vector<Snap>* snaps)
      : surface_{surface}, base_{base}, old_line_{old_line}, by_{by}, snaps_{snaps}, line_{base} {}

  OrRefusal<void> run(const Step& step) {
    switch (step.kind) {
      case Step::Kind::Candidate:
        return take_candidate(step);
      case Step::Kind::Through:
        return lead_through(step);
      case Step::Kind::Cut:
        return cut(step);
      case Step::Kind::BackTo:
        return go_back(step.line_version);
    }
    return {};
  }
  ClosedLine take() {
    const double least_mm = least_u95_mm(surface_, base_);
    for (LinePoint& point : line_.points)
      if (point.source == PointSource::Mended && point.u95_mm)
        point.u95_mm = std::max(*point.u95_mm, least_mm);
    return std::move(line_);
  }

 private:
  OrRefusal<void> take_candidate(const Step& step) {
    const int candidate = step.candidate;
    const auto& paths = surface_.decision().paths;
    if (candidate < 1 || static_cast<std::size_t>(candidate) > paths.size()) {
      return refuse(Refused::NoSuchCandidate,
                    Text::format("candidate %d: the scan has %zu", candidate, paths.size()).c_str());
    }
    ClosedLine taken = surface_.candidate(candidate);
    if (step.stretch.from_mm != 0 || step.stretch.to_mm != 0) {
      const OrRefusal<Ends> ends = ends_of(step.stretch);
      if (!ends) return tl::unexpected<Refusal>(ends.error());
      line_ = splice(line_, *ends, led_stretch(taken, line_, *ends, {.chosen = true}));
      return {};
    }
    for (LinePoint& point : taken.points) take_point(point);
    line_ = std::move(taken);
    return {};
  }

  /// What was sure already and stays where it is needs no hand.
  void take_point(LinePoint& point) const {
    constexpr double k_same_mm = 0.1;
    LinePoint before;
    before.confidence = surface_.decision().confidence;
    before.flags = cloud::k_line_unsure;
    bool same = false;
    if (!line_.points.empty()) {
      before = line_.points[nearest_index(line_, point.position)];
      same = (before.position - point.position).norm() <= k_same_mm;
    }
    const bool sure = (before.flags & cloud::k_line_unsure) == 0 && before.confidence >= cloud::k_sure_ratio;
    if (same && (sure || by_ == By::Model)) {
      point.confidence = before.confidence;
      point.u95_mm = before.u95_mm;
      point.flags = before.flags;
      point.source = before.source;
    } else if (by_ == By::Person) {
      mark_by_hand(point);
    } else {
      mark_mended(point, before);
    }
  }

  OrRefusal<Ends> ends_of(const Stretch& stretch) const {
    if (line_.points.empty()) return refuse(Refused::NoLine, "the scan has no line that could be mended");
    // Lengths are those of the version that is mended, whatever the steps before have done.
    const ClosedLine& measured = base_.points.empty() ? line_ : base_;
    const geometry::ArcLength arc = arc_of(measured);
    const auto place = [&](double mm) {
      const geometry::OnCurve at = arc.at(mm);
      return at.between<Vec3>(measured.points[at.before].position, measured.points[at.after].position);
    };
    const double total_mm = arc.total_mm();
    double length_mm = stretch.to_mm - stretch.from_mm;
    if (length_mm < 0) length_mm += total_mm;
    const bool inside = stretch.from_mm >= 0 && stretch.to_mm >= 0 && stretch.from_mm <= total_mm &&
                        stretch.to_mm <= total_mm;
    if (!inside || !(length_mm >= k_shortest_mm) || !(length_mm <= total_mm / 2)) {
      return refuse(
          Refused::BadStretch,
          Text::format("from %.1f to %.1f mm: the line is %.1f mm long, and a stretch from %.0f mm to "
                       "half of it can be mended",
                       stretch.from_mm, stretch.to_mm, total_mm, k_shortest_mm)
              .c_str());
    }
    const Ends ends{.first = nearest_index(line_, place(stretch.from_mm)),
                    .last = nearest_index(line_, place(stretch.to_mm))};
    if (ends.first == ends.last)
      return refuse(Refused::BadStretch,
                    "A and B are the same place of the line as the steps before left it");
    return ends;
  }

  OrRefusal<void> lead_through(const Step& step) {
    const OrRefusal<Ends> ends = ends_of(step.stretch);
    if (!ends) return tl::unexpected<Refusal>(ends.error());
    const OrRefusal<std::vector<bite_line::CurveLead>> leads = leads_of(*ends, step.points);
    if (!leads) return tl::unexpected<Refusal>(leads.error());
    const std::optional<std::vector<Vec2>> led = surface_.lead(bite_line::in_order(*leads));
    if (!led) {
      return refuse(Refused::NoCourse,
                    Text::format("no way from %.1f to %.1f mm leads through the %zu points",
                                 step.stretch.from_mm, step.stretch.to_mm, step.points.size())
                        .c_str());
    }
    const OrRefusal<ClosedLine> placed = surface_.place_along(guide_with(*led, *ends));
    if (!placed) return tl::unexpected<Refusal>(placed.error());
    line_ = splice(line_, *ends, led_stretch(*placed, line_, *ends, {.hints = step.points}, snaps_));
    return {};
  }

  /// A, what lies between, and B; s goes on from A.
  OrRefusal<std::vector<bite_line::CurveLead>> leads_of(const Ends& ends,
                                                        std::span<const Vec3> points) const {
    constexpr double k_end_mm = 0.8;    // a cell
    constexpr double k_reach_mm = 1.0;  // a hand's; within it the crease decides
    const std::optional<Vec2> first = surface_.locate(line_.points[ends.first].position);
    const std::optional<Vec2> last = surface_.locate(line_.points[ends.last].position);
    if (!first || !last) return refuse(Refused::HintOffSide, "A or B lies nowhere on the shoe's side");
    const auto beyond_first = [&](Vec2 place) {
      while (place.x() < first->x()) place.x() += surface_.turn_mm();
      return place;
    };
    const Vec2 end = beyond_first(*last);
    std::vector<bite_line::CurveLead> leads{{.place = *first, .reach_mm = k_end_mm}};
    for (const Vec3& point : points) {
      const auto told = [&](const char* what) {
        return Text::format("the point %.1f, %.1f, %.1f %s", point.x(), point.y(), point.z(), what);
      };
      const std::optional<Vec2> at = surface_.locate(point);
      if (!at) return refuse(Refused::HintOffSide, told("lies nowhere on the shoe's side").c_str());
      const Vec2 place = beyond_first(*at);
      if (place.x() >= end.x()) return refuse(Refused::HintOutside, told("lies not between A and B").c_str());
      leads.push_back({.place = place, .reach_mm = k_reach_mm});
    }
    leads.push_back({.place = end, .reach_mm = k_end_mm});
    return leads;
  }

  /// The line's own places from B on to A, and then those that were led, up to B again.
  std::vector<Vec2> guide_with(std::span<const Vec2> led, const Ends& ends) const {
    const double turn_mm = surface_.turn_mm();
    std::vector<Vec2> guide;
    const auto put = [&](Vec2 place) {
      if (!guide.empty()) place.x() -= turn_mm * std::round((place.x() - guide.back().x()) / turn_mm);
      guide.push_back(place);
    };
    for (const LinePoint& point : between(line_, {.first = ends.last, .last = ends.first}))
      if (const std::optional<Vec2> at = surface_.locate(point.position)) put(*at);
    for (const Vec2& place : led.subspan(1, led.size() - 2)) put(place);
    return guide;
  }

  OrRefusal<void> cut(const Step& step) {
    const OrRefusal<Ends> ends = ends_of(step.stretch);
    if (!ends) return tl::unexpected<Refusal>(ends.error());
    line_ = splice(line_, *ends, bridged_stretch(line_, *ends));
    return {};
  }

  OrRefusal<void> go_back(int version) {
    std::optional<ClosedLine> line = old_line_ ? old_line_(version) : std::nullopt;
    if (!line)
      return refuse(Refused::NoSuchVersion, Text::format("no line of version %d is kept", version).c_str());
    line_ = std::move(*line);
    return {};
  }

  const Surface& surface_;
  const ClosedLine& base_;
  const OldLine& old_line_;
  By by_;
  std::vector<Snap>* snaps_;
  ClosedLine line_;
};

}  // namespace

OrRefusal<ClosedLine> mend(const Surface& surface, const ClosedLine& base, std::span<const Step> steps,
                           const OldLine& old_line, By by, std::vector<Snap>* snaps) {
  Mending mending{surface, base, old_line, by, snaps};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (const OrRefusal<void> done = mending.run(steps[i]); !done) {
      Refusal refusal = done.error();
      if (steps.size() > 1) refusal.reason = "step " + std::to_string(i + 1) + ": " + refusal.reason;
      return tl::unexpected<Refusal>(std::move(refusal));
    }
  }
  return mending.take();
}

Stretch stretch_about(const ClosedLine& line, std::span<const Vec3> points) {
  constexpr double k_about_mm = 20.0;
  if (line.points.empty() || points.empty()) return {};
  const double total_mm = cloud::length_mm(line);
  const double spacing_mm = total_mm / static_cast<double>(line.points.size());
  const auto mm_of = [&](const Vec3& point) {
    return static_cast<double>(nearest_index(line, point)) * spacing_mm;
  };
  // About the first one, so that a stretch across the first row stays whole.
  const double middle_mm = mm_of(points.front());
  double before_mm = 0, behind_mm = 0;
  for (const Vec3& point : points) {
    const double off_mm = std::remainder(mm_of(point) - middle_mm, total_mm);
    before_mm = std::min(before_mm, off_mm);
    behind_mm = std::max(behind_mm, off_mm);
  }
  const auto around = [&](double mm) { return std::fmod(mm + 2 * total_mm, total_mm); };
  return {.from_mm = around(middle_mm + before_mm - k_about_mm),
          .to_mm = around(middle_mm + behind_mm + k_about_mm)};
}

}  // namespace biteline::edit
