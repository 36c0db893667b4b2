// SPDX-License-Identifier: MIT
#pragma once
/// \file From a shoe's point cloud to its bite line, or to the reason why there is none.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/bite_line/unrolled.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::bite_line {

enum class Method : std::uint8_t {
  Ours,       ///< shortest closed path on the unrolled shoe, then placed in the raw points
  Published,  ///< the article's greedy tracing, joining, back-projection and thinning
};

struct ExtractConfig {
  Method method{Method::Ours};
  double point_spacing_mm{0.5};     ///< of the resulting line
  double curvature_radius_mm{1.5};  ///< neighbourhood of normals and curvature
  std::size_t surface_point_limit{
      250'000};  ///< denser clouds are thinned to about this for finding the line; never for placing it
  double min_confidence_ratio{0.5};  ///< a line less sure than this is refused
  bool keep_products{true};          ///< fill Extraction::products
};

/// A closed crease that could be the bite line.  The first of a list is the best one.
struct Candidate {
  double confidence{0};      ///< 0 to 1, in comparison with its rivals
  double mean_height_mm{0};  ///< above the sole's bottom, as far as the cloud shows it
  double length_mm{0};
  double closure_mm{0};      ///< height between the path's two ends at the seam of the unrolled picture
  double crease_deg{0};      ///< median turn of the surface across it, positive when concave
  double seen_share{0};      ///< share of its length where the surface was seen
  std::vector<Vec3> points;  ///< base, mm, in order
};

struct Stage {
  const char* name;
  double seconds;
};

/// What the stages handed on: the article's Figures 24 to 26.  Indices point into `surface`.
struct Products {
  cloud::PointCloud surface;  ///< the shoe's points (table and outliers left out), with normals
  std::vector<float> mean_curvature_per_mm;  ///< convex > 0
  std::vector<float> gaussian_curvature_per_mm2;
  std::vector<std::uint32_t> feature_points;  ///< strongly concave
  /// The published method only: the same by the article's plain SVD, which its weighted PCA is measured
  /// against.
  std::vector<std::uint32_t> plain_svd_features;
  std::vector<std::uint32_t> denoised_points;  ///< without specks
  std::vector<std::uint32_t> coarse_line;      ///< thick: those around the path
  std::vector<Vec3> thinned_line;              ///< coarse line moved onto its middle, in order
  Unrolled unrolled;                           ///< mean curvature, eight sections side by side
  std::vector<float> path_row;                 ///< per column of `unrolled`; negative: not found
};

struct Extraction {
  bool found{false};
  std::string reason;      ///< one plain sentence when not found
  cloud::ClosedLine line;  ///< empty when not found
  double confidence{0};    ///< that the line as a whole is the bite line
  double closure_mm{0};
  double length_mm{0};
  double bridged_mm{0};               ///< length without a visible crease, bridged from both sides
  std::vector<Candidate> candidates;  ///< found or not, best first
  SE3 T_base_shoe{SE3::Identity()};
  std::vector<Stage> stages;  ///< in order, wall time
  Products products;
};

/// Called when a stage begins, on the calling thread: for progress displays.
using StageCallback = std::function<void(const char* stage)>;

/// Finds the bite line.  Takes clouds in any order; an organised one is faster.  Works on all cores (oneTBB).
/// Pre: finite points.  A cloud in which nothing can be found is refused, with the reason; nothing is thrown.
[[nodiscard]] Extraction extract(const cloud::PointCloud& cloud, const ExtractConfig& config,
                                 const StageCallback& on_stage = {});

}  // namespace biteline::bite_line
