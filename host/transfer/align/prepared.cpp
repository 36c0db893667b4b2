// SPDX-License-Identifier: MIT
#include "host/transfer/align/prepared.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/contracts.hpp"
#include "host/transfer/align/line_beside.hpp"

namespace biteline::transfer {
namespace {

constexpr float k_pitch_mm = 2;
constexpr float k_coarse_pitch_mm = 8;
constexpr std::size_t k_min_surfels = 300;  // 12 cm² at the fine pitch

OnWall on_wall(const LineBeside::Place& beside, const Vec3& point) {
  const double out_mm = (point.head<2>() - beside.foot.place.cast<double>()).norm();
  return {.along_mm = beside.along_mm, .up_mm = std::hypot(out_mm, point.z() - beside.height_mm)};
}

Rim moved(const Rim& rim, const SE3& T_to_from) {
  Rim out = rim;
  for (Eigen::Vector3f& p : out.positions) p = (T_to_from * p.cast<double>()).cast<float>();
  for (Eigen::Vector3f& v : out.across) v = (T_to_from.linear() * v.cast<double>()).cast<float>();
  return out;
}

}  // namespace

Sample mirrored(const Sample& sample) {
  Sample other = sample;
  other.common_table = nullptr;
  for (Surfels* surfels : {&other.common, &other.common_coarse}) {
    for (Eigen::Vector3f& p : surfels->positions) p.y() = -p.y();
    for (Eigen::Vector3f& n : surfels->normals) n.y() = -n.y();
    for (Foot& foot : surfels->feet) foot = mirrored(foot);
  }
  for (Eigen::Vector3f& p : other.rim.positions) p.y() = -p.y();
  for (Eigen::Vector3f& v : other.rim.across) v.y() = -v.y();
  for (Foot& foot : other.rim.feet) foot = mirrored(foot);
  for (Vec3& p : other.line_shoe) p.y() = -p.y();
  std::reverse(other.line_shoe.begin(), other.line_shoe.end());  // anticlockwise again
  return other;
}

Upper turned_over(const Upper& upper) {
  Upper turned{.surfels = upper.surfels};
  for (auto* vectors : {&turned.surfels.positions, &turned.surfels.normals}) {
    for (Eigen::Vector3f& v : *vectors) v = {v.x(), -v.y(), -v.z()};
  }
  turned.axes = shoe_axes(turned.surfels);
  turned.surfels_coarse = coarsened(turned.surfels, k_coarse_pitch_mm);
  return turned;
}

Result<Sample> prepare_sample(const cloud::PointCloud& cloud, const cloud::ClosedLine& line) {
  BITELINE_EXPECTS(line.points.size() >= 3);
  const Surfels surfels = surfels_of(cloud.points, k_pitch_mm);
  if (surfels.size() < k_min_surfels)
    return fail(Errc::Refused, "the sample's cloud holds no surface of a shoe's size");
  Sample sample{.axes = shoe_axes(surfels)};
  sample.T_base_shoe = sample.axes.T_base_shoe;
  const SE3 T_shoe_base = sample.T_base_shoe.inverse();
  for (const cloud::LinePoint& p : line.points) sample.line_shoe.push_back(T_shoe_base * p.position);

  const LineBeside line_beside{sample.line_shoe};
  sample.line_length_mm = line_beside.length_mm();
  sample.common.pitch_mm = surfels.pitch_mm;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const Vec3 p = T_shoe_base * surfels.positions[i].cast<double>();
    const LineBeside::Place beside = line_beside.at(p);
    if (p.z() < beside.height_mm + k_groove_margin_mm) continue;
    sample.common.positions.push_back(p.cast<float>());
    sample.common.feet.push_back(beside.foot);
    sample.common_on_wall.push_back(on_wall(beside, p));
    sample.common.normals.push_back((T_shoe_base.linear() * surfels.normals[i].cast<double>()).cast<float>());
  }
  if (sample.common.size() < k_min_surfels)
    return fail(Errc::Refused, "next to nothing of the sample lies above its line");
  sample.common_coarse = coarsened(sample.common, k_coarse_pitch_mm);
  sample.common_table =
      std::make_shared<const NearestTable>(sample.common, static_cast<float>(k_fine_reach_mm));
  sample.rim = moved(rim_of(cloud, surfels), T_shoe_base);
  for (const Eigen::Vector3f& p : sample.rim.positions) {
    const LineBeside::Place beside = line_beside.at(p.cast<double>());
    sample.rim.feet.push_back(beside.foot);
    sample.rim_on_wall.push_back(on_wall(beside, p.cast<double>()));
  }
  return sample;
}

Result<Upper> prepare_upper(const cloud::PointCloud& cloud) {
  Upper upper{.surfels = surfels_of(cloud.points, k_pitch_mm)};
  if (upper.surfels.size() < k_min_surfels)
    return fail(Errc::Refused, "the upper's cloud holds no surface of a shoe's size");
  upper.axes = shoe_axes(upper.surfels);
  upper.surfels_coarse = coarsened(upper.surfels, k_coarse_pitch_mm);
  upper.rim = rim_of(cloud, upper.surfels);
  return upper;
}

Upper upper_of(const Sample& sample) {
  return {.axes = shoe_axes(sample.common),
          .surfels = sample.common,
          .surfels_coarse = sample.common_coarse,
          .rim = sample.rim};
}

}  // namespace biteline::transfer
