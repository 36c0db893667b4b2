// SPDX-License-Identifier: MIT
#include "host/bite_line/evaluation/reference_surface.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cmath>

#include "common/core/contracts.hpp"

namespace biteline::evaluation {
namespace {

using Triangle = std::array<Vec3, 3>;

/// Nearest point of a triangle: Ericson, "Real-Time Collision Detection", 5.1.5.
Vec3 nearest_on_triangle(const Vec3& p, const Triangle& t) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return t[0];
  const Vec3 bp = p - t[1];
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 - d3 > 0) return t[0] + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - t[2];
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 - d6 > 0) return t[0] + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0 && (d4 - d3) + (d5 - d6) > 0) {
    return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  }
  const double sum = va + vb + vc;
  return sum > 0 ? Vec3(t[0] + vb / sum * ab + vc / sum * ac) : t[0];
}

}  // namespace

struct ReferenceSurface::Scene {
  cloud::TriangleMesh mesh;
  RTCDevice device{nullptr};
  RTCScene scene{nullptr};

  [[nodiscard]] Triangle triangle(unsigned face) const {
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = mesh.vertices[mesh.faces[face][k]].cast<double>();
    return corners;
  }

  /// Zero for a triangle without area.
  [[nodiscard]] Vec3 normal(unsigned face) const {
    const Triangle t = triangle(face);
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
    const double length = n.norm();
    return length > 0 ? Vec3(n / length) : Vec3::Zero();
  }

  ~Scene() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

ReferenceSurface::ReferenceSurface(const cloud::TriangleMesh& mesh) : scene_{std::make_unique<Scene>()} {
  BITELINE_EXPECTS(!mesh.faces.empty());
  Scene& s = *scene_;
  s.mesh = mesh;
  s.device = rtcNewDevice(nullptr);
  BITELINE_EXPECTS(s.device != nullptr);
  s.scene = rtcNewScene(s.device);
  rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Copied into Embree's own buffers: those it shares must be padded, which ours are not.
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), s.mesh.vertices.size()));
  for (const Eigen::Vector3f& v : s.mesh.vertices) vertices = std::copy_n(v.data(), 3, vertices);
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), s.mesh.faces.size()));
  for (const auto& face : s.mesh.faces) indices = std::copy_n(face.data(), 3, indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(s.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(s.scene);
}

ReferenceSurface::ReferenceSurface(ReferenceSurface&&) noexcept = default;
ReferenceSurface& ReferenceSurface::operator=(ReferenceSurface&&) noexcept = default;
ReferenceSurface::~ReferenceSurface() = default;

std::optional<ReferenceSurface::Nearest> ReferenceSurface::nearest(const Vec3& point, double reach_mm) const {
  struct Search {
    const Scene& scene;
    Vec3 point;
    double best_mm;
    double best_squareness{-1};
    Vec3 best_point{Vec3::Zero()};
    Vec3 best_normal{Vec3::Zero()};
    bool found{false};
  } search{.scene = *scene_, .point = point, .best_mm = reach_mm};

  const auto visit = [](RTCPointQueryFunctionArguments* arguments) {
    // Ties are told apart in double precision; single precision at 1 m resolves 0.0001 mm.
    constexpr double k_tie_mm = 1e-5;
    auto& s = *static_cast<Search*>(arguments->userPtr);
    const Vec3 q = nearest_on_triangle(s.point, s.scene.triangle(arguments->primID));
    const double distance_mm = (s.point - q).norm();
    if (distance_mm > s.best_mm + k_tie_mm) return false;
    const Vec3 normal = s.scene.normal(arguments->primID);
    const double squareness = distance_mm > 0 ? std::abs(normal.dot(s.point - q)) / distance_mm : 1.0;
    if (s.found && distance_mm > s.best_mm - k_tie_mm && squareness <= s.best_squareness) return false;
    const bool closer = distance_mm < s.best_mm;
    s.best_mm = std::min(distance_mm, s.best_mm);
    s.best_squareness = squareness;
    s.best_point = q;
    s.best_normal = normal;
    s.found = true;
    if (!closer) return false;
    arguments->query->radius = static_cast<float>(s.best_mm + 2 * k_tie_mm + 1e-6 * s.point.norm());
    return true;
  };

  RTCPointQuery query{};
  query.x = static_cast<float>(point.x());
  query.y = static_cast<float>(point.y());
  query.z = static_cast<float>(point.z());
  query.radius = static_cast<float>(reach_mm);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_->scene, &query, &context, visit, &search);
  if (!search.found) return std::nullopt;
  const bool outside = search.best_normal.dot(point - search.best_point) >= 0;
  return Nearest{.point = search.best_point,
                 .normal = search.best_normal,
                 .signed_distance_mm = outside ? search.best_mm : -search.best_mm};
}

std::optional<ReferenceSurface::Hit> ReferenceSurface::first_hit(const Ray& ray) const {
  RTCRayHit query{};
  query.ray.org_x = static_cast<float>(ray.origin.x());
  query.ray.org_y = static_cast<float>(ray.origin.y());
  query.ray.org_z = static_cast<float>(ray.origin.z());
  query.ray.dir_x = static_cast<float>(ray.direction.x());
  query.ray.dir_y = static_cast<float>(ray.direction.y());
  query.ray.dir_z = static_cast<float>(ray.direction.z());
  query.ray.tfar = static_cast<float>(ray.length_mm);
  query.ray.mask = ~0U;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  // Embree multiplies infinite reciprocals of axis-parallel directions by zero and discards the outcome; the
  // flag that this raises must not reach a caller who watches for his own.
  std::fenv_t environment;
  std::feholdexcept(&environment);
  rtcIntersect1(scene_->scene, &context, &query);
  std::fesetenv(&environment);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{.point = ray.origin + static_cast<double>(query.ray.tfar) * ray.direction,
             .normal = scene_->normal(query.hit.primID)};
}

}  // namespace biteline::evaluation
