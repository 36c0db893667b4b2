// SPDX-License-Identifier: MIT
#include "host/robot/path/certainty.hpp"

#include <algorithm>

#include "host/robot/path/tip_bound.hpp"

namespace biteline::path {

Certainty certainty_of(const PlannedPath& path, const std::optional<double>& tolerance_mm) {
  Certainty out;
  bool first = true;
  bool known = true;
  bool within = false;  // the place before belongs to the last uncertain stretch
  for (const Waypoint& w : path.waypoints) {
    if (w.segment != Segment::Line) {
      within = false;
      continue;
    }
    known = known && w.u95_mm.has_value();
    if (w.u95_mm && (first || !(*w.u95_mm <= *out.u95_mm))) {
      out.u95_mm = w.u95_mm;
      out.at_mm = w.arc_mm;
      first = false;
    }
    const bool good = !tolerance_mm || (w.u95_mm && *w.u95_mm <= *tolerance_mm);
    if (good) {
      within = false;
      continue;
    }
    if (!within) out.places.push_back({.from_mm = w.arc_mm, .to_mm = w.arc_mm, .u95_mm = w.u95_mm});
    UncertainPlace& place = out.places.back();
    place.to_mm = w.arc_mm;
    place.u95_mm =
        place.u95_mm && w.u95_mm ? std::optional{std::max(*place.u95_mm, *w.u95_mm)} : std::nullopt;
    within = true;
  }
  if (!known) out.u95_mm.reset();
  out.tip_bound_mm = tip_bound_mm(parts_of(path, out.u95_mm));
  return out;
}

}  // namespace biteline::path
