// SPDX-License-Identifier: MIT
#include "host/transfer/align/advice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "host/geometry/robust.hpp"

namespace biteline::transfer {
namespace {

// A wall leans by less between its highest seen place and the edge above it.
constexpr float k_beside_mm = 6;
// The edge and some points above and below it, so that it is known for one.
constexpr double k_above_edge_mm = 3;
constexpr double k_share_of_edge = 0.9;  // a heel tab that stands up does not ask for more

/// By how much the upper's scan ends below the sample's edge, at each place of that.
std::vector<double> missing_mm(const Sample& sample, const Upper& upper, const SE3& T_upper_shoe) {
  std::vector<double> missing;
  for (const Eigen::Vector3f& position : sample.rim.positions) {
    const Eigen::Vector3f edge = (T_upper_shoe * position.cast<double>()).cast<float>();
    float top_mm = std::numeric_limits<float>::lowest();
    for (const Eigen::Vector3f& p : upper.surfels.positions) {
      if ((p - edge).head<2>().squaredNorm() < k_beside_mm * k_beside_mm) top_mm = std::max(top_mm, p.z());
    }
    if (top_mm > std::numeric_limits<float>::lowest()) missing.push_back(edge.z() - top_mm);
  }
  return missing;
}

}  // namespace

std::string advice_for_sample(const Sample& sample) {
  if (sample.rim.size() > 0) return {};
  return "scan the sample again with the head raised: its collar's edge, which fixes an upper's height, is "
         "out of view";
}

std::string advice_for_upper(const Sample& sample, const Upper& upper, const SE3& T_upper_sample_shoe,
                             bool same_edge) {
  if (same_edge) return {};
  if (sample.rim.size() == 0) return advice_for_sample(sample);
  std::vector<double> missing = missing_mm(sample, upper, T_upper_sample_shoe);
  if (missing.empty()) return {};
  const double most_mm = geometry::quantile_of(std::span<double>{missing}, k_share_of_edge);
  // The upper's highest surfels lie a pitch below its highest points.
  if (most_mm > 2 * upper.surfels.pitch_mm || upper.rim.size() == 0) {
    return FixedText<200>::format("raise the head by %.0f mm: the collar's edge is out of view",
                                  std::ceil(std::max(0.0, most_mm) + k_above_edge_mm))
        .c_str();
  }
  return "take a sample whose collar is cut like this upper's: the two edges differ, so that the wall alone "
         "fixes the height";
}

}  // namespace biteline::transfer
