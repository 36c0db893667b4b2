// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/recognise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/fixed_text.hpp"

namespace biteline::service {

Result<Recognised> recognise(const transfer::Library& library, const cloud::PointCloud& scan) {
  BITELINE_ASSIGN(const transfer::Identification found, transfer::identify(library, scan, {}));
  Recognised out;
  if (!found.matches.empty() && found.matches[0].alignment.accepted()) {
    const transfer::Match& best = found.matches[0];
    out.name = best.name;
    out.probability = best.probability;
    out.second = found.matches.size() > 1 ? found.matches[1].probability : 0;
    out.alignment = best.alignment;
    out.words =
        FixedText<160>::format("looks like %.64s (%.2f)", best.name.c_str(), best.probability).c_str();
  } else {
    out.words = found.refusal ? found.refusal->reason : "the library has no model";
  }
  return out;
}

memory::Places places_of(const cloud::ClosedLine& line, const cloud::ClosedLine& model,
                         const SE3& T_scan_model) {
  memory::Places places{};
  if (line.points.empty() || model.points.empty()) return places;
  for (std::size_t place = 0; place < memory::k_places; ++place) {
    const cloud::LinePoint& at = model.points[place * model.points.size() / memory::k_places];
    const Vec3 wanted = T_scan_model * at.position;
    const Vec3 outwards = T_scan_model.linear() * at.normal;
    double best = std::numeric_limits<double>::max();
    Vec3 off = Vec3::Zero();
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      const Vec3& a = line.points[i].position;
      const Vec3 along = line.points[(i + 1) % line.points.size()].position - a;
      const double length2 = along.squaredNorm();
      const double t = length2 > 0 ? std::clamp((wanted - a).dot(along) / length2, 0.0, 1.0) : 0.0;
      const Vec3 from = a + t * along - wanted;
      if (from.squaredNorm() < best) {
        best = from.squaredNorm();
        off = from;
      }
    }
    places[place] = static_cast<float>(std::copysign(off.norm(), off.dot(outwards)));
  }
  return places;
}

}  // namespace biteline::service
