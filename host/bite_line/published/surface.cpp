// SPDX-License-Identifier: MIT
#include "host/bite_line/published/surface.hpp"

#include <algorithm>

#include "host/bite_line/published/neighbour_search.hpp"

namespace biteline::published {

CurvedSurface curve_surface(const bite_line::Side& side, std::size_t limit, const CurvatureConfig& config) {
  const bite_line::Shoe& shoe = side.shoe;
  const bite_line::SideField& field = side.field;
  const auto outer =
      static_cast<std::size_t>(std::count_if(field.places.begin(), field.places.end(),
                                             [](const bite_line::OutlinePlace& p) { return p.s_mm >= 0; }));
  const std::size_t kept = std::min(outer, std::max<std::size_t>(limit, 1));
  CurvedSurface surface;
  surface.index.reserve(kept);
  surface.points.reserve(kept);
  std::vector<Eigen::Vector3f> outward;
  outward.reserve(kept);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < shoe.points.size(); ++i) {
    if (field.places[i].s_mm < 0) continue;
    // Every n-th, for any ratio: a point is taken whenever the kept count falls behind its share.
    const bool take = (seen + 1) * kept / outer > seen * kept / outer;
    ++seen;
    if (!take) continue;
    surface.index.push_back(shoe.index[i]);
    surface.points.push_back(shoe.points[i]);
    const Vec2 normal = side.outline.normal(static_cast<double>(field.places[i].s_mm));
    // A side looks outwards, the top of a toe upwards.
    outward.emplace_back(static_cast<float>(normal.x()), static_cast<float>(normal.y()), 0.5F);
  }
  surface.curvature = estimate_curvature(surface.points, outward, config);
  return surface;
}

std::vector<std::uint32_t> feature_points(const CurvedSurface& surface, const FeatureConfig& config) {
  std::vector<std::uint32_t> features;
  for (std::uint32_t i = 0; i < surface.points.size(); ++i) {
    if (surface.curvature.trusted[i] != 0 && surface.curvature.mean_per_mm[i] < -config.strong_per_mm)
      features.push_back(i);
  }
  return features;
}

std::vector<std::uint32_t> denoised(const CurvedSurface& surface, const std::vector<std::uint32_t>& features,
                                    const FeatureConfig& config) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(features.size());
  for (const std::uint32_t i : features) points.push_back(surface.points[i]);
  std::vector<std::uint32_t> kept;
  if (points.empty()) return kept;
  const auto radius = static_cast<float>(config.speck_radius_mm);
  const NeighbourGrid grid{points, {.cell_mm = radius}};
  NeighbourSearch search{grid};
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (search.within(i, radius).size() >= config.speck_points) kept.push_back(features[grid.order()[i]]);
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

Unrolled unroll_features(const CurvedSurface& surface, const std::vector<std::uint32_t>& features,
                         const EightSections& sections) {
  std::vector<float> value(surface.points.size(), 0.0F);
  Unrolled picture = unroll(surface.points, value, sections, {});
  std::vector<std::uint32_t> count(picture.value.size(), 0);
  for (const std::uint32_t i : features) {
    const PixelPlace place = pixel_of(picture, sections, surface.points[i]);
    if (place.row < 0) continue;
    const std::size_t pixel = picture.at(place.row, place.col);
    picture.value[pixel] += surface.curvature.mean_per_mm[i];
    ++count[pixel];
  }
  for (std::size_t i = 0; i < count.size(); ++i) {
    if (count[i] > 0) picture.value[i] /= static_cast<float>(count[i]);
  }
  return picture;
}

}  // namespace biteline::published
