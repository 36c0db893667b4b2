// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/recognise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/fixed_text.hpp"

namespace biteline::service {

namespace {

Recognised recognised(const transfer::Match& best) {
  return {.model = best.model,
          .sample = best.name,
          .foot = best.foot,
          .size = best.size,
          .probability = best.probability,
          .align = best.align,
          .on_scan = OnScan{.line = best.line, .sigma_mm = best.alignment.line_sigma_mm}};
}

}  // namespace

Result<Recognised> recognise(const transfer::Library& library, const cloud::PointCloud& scan,
                             const transfer::ModelOrder& order) {
  BITELINE_ASSIGN(const transfer::Identification found, transfer::identify(library, scan, order));
  Recognised out;
  const bool against_order = found.refusal && found.refusal->code == transfer::Refused::OrderDisagrees;
  if (!found.matches.empty() && found.matches[0].alignment.accepted() && !against_order) {
    const transfer::Match& best = found.matches[0];
    out = recognised(best);
    out.second = found.matches.size() > 1 ? found.matches[1].probability : 0;
    const std::string foot = best.foot.empty() ? "" : ", " + best.foot,
                      size = best.size.empty() ? "" : ", " + best.size;
    out.words = FixedText<200>::format("looks like %.64s%.8s%.24s (%.2f)", best.model.c_str(), foot.c_str(),
                                       size.c_str(), best.probability)
                    .c_str();
  } else {
    out.words = found.refusal ? found.refusal->reason : "the library has no model";
  }
  return out;
}

Result<Recognised> take_named(const transfer::Library& library, const cloud::PointCloud& scan,
                              const transfer::ModelOrder& order) {
  BITELINE_ASSIGN(const transfer::SavedModel model, transfer::saved_model(library, order.model));
  const transfer::SavedSample& first = model.samples.front();
  Recognised out{.model = model.name,
                 .sample = first.name,
                 .foot = order.foot,
                 .size = order.size,
                 .probability = 1,
                 .words = "named " + model.name};
  const bool tells = !first.made.foot.empty() || !first.made.size.empty();
  if (model.samples.size() == 1 && !tells) return out;
  BITELINE_ASSIGN(const transfer::Identification found, transfer::identify(library, scan, order));
  const bool fits =
      !found.matches.empty() && found.matches[0].alignment.accepted() && found.matches[0].model == model.name;
  if (!fits) return out;
  if (found.refusal && found.refusal->code == transfer::Refused::OrderDisagrees)
    return Recognised{.words = found.refusal->reason};
  std::string words = std::move(out.words);
  out = recognised(found.matches[0]);
  out.words = std::move(words);
  out.probability = 1;
  return out;
}

memory::Places places_of(const cloud::ClosedLine& line, const cloud::ClosedLine& model) {
  memory::Places places{};
  if (line.points.empty() || model.points.empty()) return places;
  for (std::size_t place = 0; place < memory::k_places; ++place) {
    const cloud::LinePoint& at = model.points[place * model.points.size() / memory::k_places];
    const Vec3& wanted = at.position;
    const Vec3& outwards = at.normal;
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
