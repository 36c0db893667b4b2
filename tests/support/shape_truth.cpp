// SPDX-License-Identifier: MIT
#include "tests/support/shape_truth.hpp"

#include <algorithm>
#include <string>

#include "common/core/contracts.hpp"
#include "host/cloud/ply.hpp"
#include "tests/support/line_distance.hpp"
#include "tests/support/mesh_cloud.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::test {

std::optional<cloud::PointCloud> cloud_of(const Shape& shape) {
  const auto file =
      shared_data(std::string{"shoes/"} + shape.name + (shape.mesh ? "/mesh_mm.ply" : "/cloud.ply"));
  if (!file) return std::nullopt;
  if (!shape.mesh) {
    auto cloud = cloud::read_cloud(*file);
    BITELINE_EXPECTS(cloud.has_value());
    return std::move(*cloud);
  }
  const auto mesh = cloud::read_mesh(*file);
  BITELINE_EXPECTS(mesh.has_value());
  return scan_mesh(*mesh, {});
}

std::optional<ShapeTruth> truth_of(const Shape& shape) {
  ShapeTruth truth{.line = {}, .has_none = shape.truth == Shape::Truth::NoLine};
  if (shape.truth != Shape::Truth::Line) return truth;
  const auto file = shared_data(std::string{"shoes/truth/"} + shape.name + "_line.csv");
  if (!file) return std::nullopt;
  auto line = cloud::read_positions(*file);
  BITELINE_EXPECTS(line.has_value());
  truth.line = std::move(*line);
  return truth;
}

namespace {

double step_at(const cloud::ClosedLine& line, std::size_t i) {
  const std::size_t count = line.points.size();
  return (line.points[(i + 1) % count].position - line.points[i % count].position).norm();
}

}  // namespace

bool is_flagged(const cloud::LinePoint& p) {
  return !(p.confidence >= 0.5) || (p.u95_mm && !(*p.u95_mm <= 1.0)) || (p.flags & cloud::k_line_unsure) != 0;
}

LineOnShape line_on_shape(const cloud::ClosedLine& line, const cloud::ClosedLine& truth, double truth_mm) {
  constexpr double k_chord_mm = 3.0;
  constexpr std::size_t k_beside = 8;  // some 4 mm
  LineOnShape on;
  if (line.points.empty()) return on;
  const auto count = static_cast<double>(line.points.size());
  for (const cloud::LinePoint& p : line.points) on.flagged += is_flagged(p) ? 1 / count : 0;
  if (truth.points.empty()) return on;
  const double step_mm = cloud::length_mm(line) / count;
  double judged = 0;
  double unflagged = 0;
  for (const cloud::LinePoint& p : line.points) {
    const auto [nearest, edge] = nearest_on(truth, p.position);
    // Beside its ends, too: there the model's labels stop.
    const std::size_t around = edge + truth.points.size();
    bool on_chord = false;
    for (std::size_t k = around - k_beside; k <= around + k_beside; ++k)
      on_chord = on_chord || step_at(truth, k) > k_chord_mm;
    if (on_chord) continue;
    judged += 1;
    on.mean_mm += nearest;
    on.max_mm = std::max(on.max_mm, nearest);
    on.within_u95 += p.u95_mm && nearest <= *p.u95_mm + truth_mm ? 1 : 0;
    if (is_flagged(p)) continue;
    unflagged += 1;
    on.mean_unflagged_mm += nearest;
    if (nearest > 1.0 + truth_mm) on.wrong_mm += step_mm;
    if (nearest > 2.0) on.beyond_2mm_unflagged += 1 / count;
  }
  on.mean_mm /= std::max(judged, 1.0);
  on.within_u95 /= std::max(judged, 1.0);
  on.mean_unflagged_mm /= std::max(unflagged, 1.0);
  return on;
}

}  // namespace biteline::test
