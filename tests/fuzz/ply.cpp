// SPDX-License-Identifier: MIT
// PLY files as clouds and as meshes: what is read is near, and of one length in all its parts.
#include "host/cloud/ply.hpp"
#include "common/core/numbers.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file{data, size};
  if (const auto cloud = cloud::read_cloud(file.path())) {
    for (const Eigen::Vector3f& point : cloud->points)
      fuzz::demand(is_plausible_place(point), "points are near");
    const std::size_t count = cloud->size();
    const auto whole = [count](const auto& part) { return part.empty() || part.size() == count; };
    fuzz::demand(whole(cloud->normals) && whole(cloud->profile) && whole(cloud->column) &&
                     whole(cloud->sigma_mm) && whole(cloud->flags) && whole(cloud->mean_per_mm),
                 "every part has one entry a point");
  } else {
    fuzz::demand_clean(cloud.error());
  }
  if (const auto mesh = cloud::read_mesh(file.path())) {
    for (const auto& face : mesh->faces) {
      for (const std::uint32_t corner : face)
        fuzz::demand(corner < mesh->vertices.size(), "corners are vertices");
    }
  } else {
    fuzz::demand_clean(mesh.error());
  }
  return 0;
}
