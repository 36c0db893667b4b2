// SPDX-License-Identifier: MIT
#include "host/calibration/consistency/picture_moves.hpp"

namespace biteline::consistency {
namespace {

/// `pixel`: where the stripe should have come in the region, by where it came.
template <typename Pixel>
ProfilePoints placed_anew(const drift::ScanView& scan, const geometry::SensorModel& head,
                          const Pixel& pixel) {
  ProfilePoints placed;
  const std::vector<std::uint32_t> frames = drift::frames_of(scan);
  const geometry::Region& region = head.region;
  const Vec2 corner(region.offset_u_px, region.offset_v_px);
  std::uint32_t frame = drift::k_no_frame;
  SE3 T_base_cam{SE3::Identity()}, T_cam_base{SE3::Identity()};
  for (std::size_t i = 0; i < scan.points_base.size(); ++i) {
    if (frames[i] == drift::k_no_frame) continue;
    if (frames[i] != frame) {
      frame = frames[i];
      T_base_cam = scan.poses[frame].pose.T_base_flange * head.T_flange_cam;
      T_cam_base = T_base_cam.inverse();
    }
    const Vec3 point_cam = T_cam_base * scan.points_base[i].cast<double>();
    if (!(point_cam.z() > 1)) continue;
    const Vec2 at = pixel(Vec2{head.camera.project(point_cam) - corner});
    if (!(at.minCoeff() > -1) || !(at.x() < region.width_px) || !(at.y() < region.height_px)) continue;
    const Vec3 moved = geometry::triangulate(head.camera, head.laser_plane, at + corner);
    if (!moved.allFinite() || !(moved.z() > 1)) continue;
    placed.points.push_back((T_base_cam * moved).cast<float>());
    placed.profile.push_back(scan.profile[i]);
  }
  return placed;
}

}  // namespace

std::string_view words_of(PictureMove move) {
  switch (move) {
    case PictureMove::Mirrored:
      return "mirrored left to right";
    case PictureMove::UpsideDown:
      return "mirrored top to bottom";
    case PictureMove::Turned:
      return "turned by 180 degrees";
    case PictureMove::Halved:
      return "of half the scale (binned)";
  }
  return "";
}

ProfilePoints taken_back(const drift::ScanView& scan, const geometry::SensorModel& head, PictureMove move) {
  const Vec2 last(head.region.width_px - 1, head.region.height_px - 1);
  return placed_anew(scan, head, [&](const Vec2& at) -> Vec2 {
    switch (move) {
      case PictureMove::Mirrored:
        return {last.x() - at.x(), at.y()};
      case PictureMove::UpsideDown:
        return {at.x(), last.y() - at.y()};
      case PictureMove::Turned:
        return last - at;
      case PictureMove::Halved:
        return 2 * at;
    }
    return at;
  });
}

ProfilePoints place_taken_back(const drift::ScanView& scan, const geometry::SensorModel& head,
                               const Vec2& px) {
  // A moved region holds places that this one has not.
  geometry::SensorModel whole = head;
  constexpr int k_more = 200;
  whole.region.offset_v_px -= k_more;
  whole.region.height_px += 2 * k_more;
  whole.region.offset_u_px -= k_more;
  whole.region.width_px += 2 * k_more;
  return placed_anew(scan, whole, [&](const Vec2& at) -> Vec2 { return at - px; });
}

}  // namespace biteline::consistency
