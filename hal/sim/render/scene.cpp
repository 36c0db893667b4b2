// SPDX-License-Identifier: MIT
#include "hal/sim/render/scene.hpp"

#include <embree3/rtcore.h>

#include <cstring>
#include <limits>

namespace biteline::sim {

struct Scene::Embree {
  RTCDevice device{nullptr};
  RTCScene scene{nullptr};
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<SurfaceLook> looks;

  Embree() = default;
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

namespace {

/// Shadow rays stop this far before the surface they come from; far above single precision, far below any
/// detail.
constexpr double k_clearance_mm = 0.01;

RTCIntersectContext coherent_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

RTCRay ray_of(const Vec3& origin, const Vec3& direction, double far_mm) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = 0;
  ray.tfar = static_cast<float>(far_mm);
  ray.mask = std::numeric_limits<unsigned>::max();
  return ray;
}

}  // namespace

Scene::Scene(std::unique_ptr<Embree> embree) : embree_(std::move(embree)) {}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

Result<Scene> Scene::build(const SurfaceMesh& mesh) {
  if (mesh.triangles.empty()) return fail(Errc::InvalidArgument, "scene: a mesh without triangles");
  auto embree = std::make_unique<Embree>();
  // One thread: building takes under a second, and a test machine has other things to do.
  embree->device = rtcNewDevice("threads=1");
  if (embree->device == nullptr)
    return fail(Errc::DeviceError, "embree: no device (%d)", rtcGetDeviceError(nullptr));
  embree->triangles = mesh.triangles;
  embree->looks = mesh.looks;

  RTCGeometry geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                           mesh.vertices.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                          mesh.triangles.size());
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    return fail(Errc::DeviceError, "embree: no memory for %zu triangles", mesh.triangles.size());
  }
  std::memcpy(vertices, mesh.vertices.data(), 12 * mesh.vertices.size());
  std::memcpy(indices, mesh.triangles.data(), 12 * mesh.triangles.size());
  rtcCommitGeometry(geometry);

  embree->scene = rtcNewScene(embree->device);
  // Without it rays slip through between neighbouring triangles now and then.
  rtcSetSceneFlags(embree->scene, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(embree->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(embree->scene);
  if (const RTCError error = rtcGetDeviceError(embree->device); error != RTC_ERROR_NONE) {
    return fail(Errc::DeviceError, "embree: scene (%d)", error);
  }
  return Scene(std::move(embree));
}

std::optional<RayHit> Scene::first_hit(const Vec3& origin, const Vec3& direction) const {
  RTCIntersectContext context = coherent_context();
  RTCRayHit query{};
  query.ray = ray_of(origin, direction, 1e6);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  Vec3 normal = Vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
  if (normal.dot(direction) > 0) normal = -normal;
  const auto& corners = embree_->triangles[query.hit.primID];
  return RayHit{.distance_mm = query.ray.tfar, .normal = normal, .look = embree_->looks[corners[0]]};
}

bool Scene::sees(const Vec3& eye, const Vec3& surface_point) const {
  const Vec3 way = eye - surface_point;
  const double distance_mm = way.norm();
  const Vec3 direction = way / distance_mm;
  RTCIntersectContext context = coherent_context();
  RTCRay ray = ray_of(surface_point + k_clearance_mm * direction, direction, distance_mm - k_clearance_mm);
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar >= 0;  // Embree sets -infinity where something is in the way
}

}  // namespace biteline::sim
