// SPDX-License-Identifier: MIT
#include "tests/support/mesh_cloud.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace biteline::test {

namespace {

constexpr float k_pixel_mm = 0.5F;
constexpr float k_behind_mm = 0.5F;

std::vector<Eigen::Vector3f> spread(const cloud::TriangleMesh& mesh, std::size_t count,
                                    std::mt19937& random) {
  std::vector<double> area{0};
  for (const auto& face : mesh.faces) {
    const Eigen::Vector3f ab = mesh.vertices[face[1]] - mesh.vertices[face[0]];
    const Eigen::Vector3f ac = mesh.vertices[face[2]] - mesh.vertices[face[0]];
    area.push_back(area.back() + 0.5 * static_cast<double>(ab.cross(ac).norm()));
  }
  std::uniform_real_distribution<double> any{0, area.back()};
  std::uniform_real_distribution<float> share{0, 1};
  std::vector<Eigen::Vector3f> points(count);
  for (Eigen::Vector3f& p : points) {
    const auto above = std::upper_bound(area.begin() + 1, area.end() - 1, any(random));
    const auto& face = mesh.faces[static_cast<std::size_t>(above - area.begin() - 1)];
    float u = share(random);
    float v = share(random);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const Eigen::Vector3f& a = mesh.vertices[face[0]];
    p = a + u * (mesh.vertices[face[1]] - a) + v * (mesh.vertices[face[2]] - a);
  }
  return points;
}

/// Marks what the direction towards the eye sees; the points themselves fill the depth picture.
void look(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& to_eye,
          std::vector<bool>& seen) {
  const Eigen::Vector3f right = Eigen::Vector3f::UnitZ().cross(to_eye).normalized();
  const Eigen::Vector3f up = to_eye.cross(right);
  constexpr int k_size = 1600;  // 800 mm: any shoe from any side
  std::vector<float> nearest(static_cast<std::size_t>(k_size) * k_size, -1e9F);
  std::vector<std::size_t> pixel(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int x = std::clamp(static_cast<int>(points[i].dot(right) / k_pixel_mm) + k_size / 2, 0, k_size - 1);
    const int y = std::clamp(static_cast<int>(points[i].dot(up) / k_pixel_mm) + k_size / 2, 0, k_size - 1);
    pixel[i] = static_cast<std::size_t>(y) * k_size + static_cast<std::size_t>(x);
    nearest[pixel[i]] = std::max(nearest[pixel[i]], points[i].dot(to_eye));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].dot(to_eye) > nearest[pixel[i]] - k_behind_mm) seen[i] = true;
  }
}

}  // namespace

cloud::PointCloud scan_mesh(const cloud::TriangleMesh& mesh, const MeshScan& scan) {
  std::mt19937 random{scan.seed};
  // Dense enough that the depth pictures have no holes: some ten points per pixel of a shoe's side.
  const std::vector<Eigen::Vector3f> points =
      spread(mesh, std::max<std::size_t>(2'000'000, 4 * scan.points), random);
  std::vector<bool> seen(points.size(), false);
  for (const float elevation_deg : {0.0F, 25.0F}) {
    for (int azimuth_deg = 0; azimuth_deg < 360; azimuth_deg += 20) {
      const float azimuth = static_cast<float>(azimuth_deg) * std::numbers::pi_v<float> / 180;
      const float elevation = elevation_deg * std::numbers::pi_v<float> / 180;
      look(points,
           {std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
            std::sin(elevation)},
           seen);
    }
  }
  const auto visible = static_cast<double>(std::count(seen.begin(), seen.end(), true));
  std::bernoulli_distribution keep{std::min(1.0, static_cast<double>(scan.points) / visible)};
  std::normal_distribution<float> noise{0, static_cast<float>(scan.noise_mm)};
  cloud::PointCloud cloud;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (seen[i] && keep(random))
      cloud.points.emplace_back(points[i] + Eigen::Vector3f{noise(random), noise(random), noise(random)});
  }
  return cloud;
}

}  // namespace biteline::test
