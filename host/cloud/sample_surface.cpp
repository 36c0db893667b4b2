// SPDX-License-Identifier: MIT
#include "host/cloud/sample_surface.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "common/core/plain_number.hpp"

namespace biteline::cloud {

Result<std::vector<Eigen::Vector3f>> sample_surface(const TriangleMesh& mesh, double spacing) {
  constexpr double k_most_points = 5e7;
  // 1/g and 1/g² of the plastic number g: g³ = g + 1.
  constexpr double k_step_a = 0.7548776662466927, k_step_b = 0.5698402909980532;

  std::vector<double> area(mesh.faces.size());
  double whole = 0;
  for (std::size_t i = 0; i < area.size(); ++i) {
    const auto& face = mesh.faces[i];
    const Eigen::Vector3d a = mesh.vertices[face[0]].cast<double>();
    area[i] =
        0.5 *
        (mesh.vertices[face[1]].cast<double>() - a).cross(mesh.vertices[face[2]].cast<double>() - a).norm();
    whole += area[i];
  }
  const double share = spacing * spacing;
  if (!(whole / share <= k_most_points)) {
    return fail(Errc::Refused, "the mesh's surface takes %s points at a spacing of %s: give its unit",
                plain_number(whole / share).c_str(), plain_number(spacing).c_str());
  }
  std::vector<Eigen::Vector3f> points;
  points.reserve(static_cast<std::size_t>(whole / share) + 1);
  double due = 0.5 * share, u = 0.5, v = 0.5;
  for (std::size_t i = 0; i < area.size(); ++i) {
    const auto& face = mesh.faces[i];
    const Eigen::Vector3f a = mesh.vertices[face[0]], b = mesh.vertices[face[1]] - a,
                          c = mesh.vertices[face[2]] - a;
    for (due -= area[i]; due < 0; due += share) {
      u = std::fmod(u + k_step_a, 1.0);
      v = std::fmod(v + k_step_b, 1.0);
      const bool beyond = u + v > 1;  // the other half of the parallelogram, turned back
      points.emplace_back(a + static_cast<float>(beyond ? 1 - u : u) * b +
                          static_cast<float>(beyond ? 1 - v : v) * c);
    }
  }
  return points;
}

}  // namespace biteline::cloud
