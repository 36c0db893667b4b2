// SPDX-License-Identifier: MIT
#include "host/cloud/file_content.hpp"

#include <algorithm>

namespace biteline::cloud {
namespace {

template <class Value>
void keep_only(std::vector<Value>& values, const std::vector<std::uint8_t>& keep) {
  if (values.empty()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (keep[i] != 0) values[kept++] = values[i];
  }
  values.resize(kept);
}

}  // namespace

void leave_out_broken_faces(FileContent& content) {
  content.without_number += std::erase_if(content.faces, [&](const auto& face) {
    return !std::ranges::all_of(face,
                                [&](std::uint32_t corner) { return content.places[corner].allFinite(); });
  });
  std::vector<std::uint8_t> used(content.places.size(), 0);
  for (const auto& face : content.faces) {
    for (const std::uint32_t corner : face) used[corner] = 1;
  }
  std::vector<std::uint32_t> number(used.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < used.size(); ++i) number[i] = used[i] != 0 ? next++ : 0;
  if (next == used.size()) return;
  for (auto& face : content.faces) {
    for (std::uint32_t& corner : face) corner = number[corner];
  }
  keep_only(content.places, used);
}

PointCloud kept_of(FileContent& content, const std::vector<std::uint8_t>& keep) {
  PointCloud cloud = std::move(content.beside);
  cloud.points.clear();
  cloud.points.reserve(content.places.size());
  for (std::size_t i = 0; i < content.places.size(); ++i) {
    if (keep[i] != 0) cloud.points.emplace_back(content.places[i].cast<float>());
  }
  keep_only(cloud.normals, keep);
  keep_only(cloud.mean_per_mm, keep);
  keep_only(cloud.profile, keep);
  keep_only(cloud.column, keep);
  keep_only(cloud.sigma_mm, keep);
  keep_only(cloud.flags, keep);
  keep_only(cloud.amplitude, keep);
  keep_only(cloud.width_px, keep);
  return cloud;
}

}  // namespace biteline::cloud
