// SPDX-License-Identifier: MIT
#include "host/bite_line/published/published_line.hpp"

#include <utility>

#include "host/bite_line/place/finish.hpp"
#include "host/bite_line/published/thin.hpp"
#include "host/bite_line/published/trace.hpp"
#include "host/bite_line/side/side_normal.hpp"
#include "host/bite_line/side/side_outline.hpp"

namespace biteline::published {

namespace {

using bite_line::Extraction;

cloud::ClosedLine line_of(const std::vector<Vec3>& sequence, const bite_line::Side& side, double confidence) {
  const SE3& T_base_shoe = side.shoe.T_base_shoe;
  cloud::ClosedLine line;
  for (const Vec3& p : sequence) {
    line.points.push_back({.position = T_base_shoe * p,
                           .normal = T_base_shoe.linear() * bite_line::normal_above(side, p),
                           .tangent = Vec3::UnitX(),
                           .confidence = confidence});
  }
  bite_line::add_tangents(line);
  return line;
}

Extraction finish(const bite_line::Side& side, const TracedLine& traced, const std::vector<Vec3>& sequence) {
  Extraction out{.refusal = traced.refusal,
                 .confidence = traced.covered_ratio,
                 .closure_mm = traced.closure_mm,
                 .T_base_shoe = side.shoe.T_base_shoe};
  if (!out.refusal && sequence.size() < 3) {
    out.refusal =
        bite_line::Refusal{bite_line::Refused::NoCrease, "no crease: too few points along the traced line"};
  }
  if (out.refusal) return out;
  out.line = line_of(sequence, side, traced.covered_ratio);
  out.length_mm = cloud::length_mm(out.line);
  out.found = true;
  return out;
}

}  // namespace

Extraction find_bite_line(std::span<const Eigen::Vector3f> points, const Config& config,
                          std::optional<Workings>* workings) {
  report::StageClock clock;
  auto shoe = clock.run("shoe", [&] { return bite_line::find_shoe(points); });
  if (!shoe) return bite_line::refused(shoe.error(), clock.take());
  auto outline = clock.run("outline", [&] { return bite_line::side_outline(*shoe); });
  auto field = clock.run("side", [&] { return bite_line::SideField::build(*shoe, outline, {}); });
  bite_line::Side side{std::move(*shoe), std::move(outline), std::move(field)};
  Features features = clock.run("features", [&] { return find_features(side, config); });
  TracedLine traced = clock.run(
      "trace", [&] { return join_segments(features.picture, trace_segments(features.picture, {}), {}); });
  std::vector<std::uint32_t> coarse =
      clock.run("coarse line", [&] { return coarse_line(features, traced.path_row); });
  std::vector<Vec3> thinned = clock.run("thin", [&] { return thin_line(features, coarse); });
  const std::vector<Vec3> sequence =
      clock.run("sequence", [&] { return even_sequence(thinned, config.point_spacing_mm); });
  Extraction extraction = finish(side, traced, sequence);
  extraction.stages = clock.take();
  if (workings != nullptr) {
    workings->emplace(Workings{config, std::move(side), std::move(features), std::move(coarse),
                               std::move(thinned), std::move(traced.path_row)});
  }
  return extraction;
}

bite_line::LineStages line_stages(const Workings& workings) {
  const bite_line::Side& side = workings.side;
  const CurvedSurface& surface = workings.features.surface;
  const Eigen::Isometry3f T_base_shoe = side.shoe.T_base_shoe.cast<float>();
  bite_line::LineStages stages{.surface = {},
                               .curvature_per_mm = surface.curvature.mean_per_mm,
                               .feature_points = workings.features.strong,
                               .denoised_points = workings.features.denoised,
                               .plain_svd_features = plain_svd_features(side, workings.config),
                               .coarse_line = workings.coarse_line,
                               .thinned_line = workings.thinned_line,
                               .unrolled = {}};
  for (const Eigen::Vector3f& p : surface.points) stages.surface.points.push_back(T_base_shoe * p);
  for (const Eigen::Vector3f& n : surface.curvature.normal)
    stages.surface.normals.push_back(T_base_shoe.linear() * n);
  for (Vec3& p : stages.thinned_line) p = side.shoe.T_base_shoe * p;
  // The picture shows all of the mean curvature, not only the features.
  Unrolled picture = unroll(surface.points, surface.curvature.mean_per_mm, workings.features.sections, {});
  stages.unrolled = {.rows = picture.rows,
                     .cols = picture.cols,
                     .curvature_per_mm = std::move(picture.value),
                     .known = std::move(picture.known),
                     .marks = {},
                     .path_row = workings.path_row,
                     .rival_rows = {}};
  for (std::size_t s = 0; s < picture.section_col.size(); ++s) {
    const std::string name{static_cast<char>('A' + s), s == 7 ? 'A' : static_cast<char>('B' + s)};
    stages.unrolled.marks.push_back({picture.section_col[s], name});
  }
  return stages;
}

}  // namespace biteline::published
