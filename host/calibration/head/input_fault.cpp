// SPDX-License-Identifier: MIT
#include "host/calibration/head/input_fault.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "common/geometry/se3.hpp"
#include "host/calibration/rings/mosaic.hpp"

namespace biteline::calibration {
namespace {

struct PartPictures {
  const char* folder;
  PictureSize size;
  std::size_t used;
  const std::vector<SetAside>* set_aside;
};

std::vector<PartPictures> parts_of(const HeadInput& input) {
  std::vector<PartPictures> parts;
  if (const auto& part = input.camera)
    parts.push_back({"camera/", part->size, part->views.size(), &part->set_aside});
  if (const auto& part = input.laser)
    parts.push_back({"laser/", part->size, part->places.size(), &part->set_aside});
  if (const auto& part = input.hand_eye)
    parts.push_back({"handeye/", part->size, part->views.size(), &part->set_aside});
  return parts;
}

std::optional<Refusal> mosaics(const std::vector<PartPictures>& parts) {
  for (const PartPictures& part : parts) {
    const auto raw =
        static_cast<std::size_t>(std::ranges::count(*part.set_aside, PictureFault::Mosaic, &SetAside::fault));
    const std::size_t all = part.used + part.set_aside->size();
    // Single ones are set aside by name, and the others count.
    if (raw == 0 || 2 * raw < all) continue;
    return Refusal{.code = Refused::MosaicPictures,
                   .reason = FixedText<200>::format("%s: %zu of %zu pictures: each %s", part.folder, raw, all,
                                                    k_mosaic_words)
                                 .c_str()};
  }
  return std::nullopt;
}

std::optional<Refusal> sizes(const HeadInput& input, const std::vector<PartPictures>& parts) {
  for (const PartPictures& part : parts) {
    const PartPictures& first = parts.front();
    if (part.size.width_px != first.size.width_px || part.size.height_px != first.size.height_px) {
      return Refusal{.code = Refused::PictureSizes,
                     .reason = FixedText<200>::format(
                                   "%s has pictures of %d x %d px, %s of %d x %d px: one camera has one size "
                                   "(binned, scaled or cut?)",
                                   part.folder, part.size.width_px, part.size.height_px, first.folder,
                                   first.size.width_px, first.size.height_px)
                                   .c_str()};
    }
    if (!input.camera && input.known_reach &&
        (part.size.width_px < input.known_reach->width_px ||
         part.size.height_px < input.known_reach->height_px)) {
      return Refusal{.code = Refused::PictureSizes,
                     .reason = FixedText<200>::format(
                                   "%s has pictures of %d x %d px, the known sensor.yaml's region reaches to "
                                   "%d x %d px (binned, scaled or cut?)",
                                   part.folder, part.size.width_px, part.size.height_px,
                                   input.known_reach->width_px, input.known_reach->height_px)
                                   .c_str()};
    }
  }
  return std::nullopt;
}

std::optional<Refusal> turned_laser(const HeadInput& input) {
  if (!input.laser) return std::nullopt;
  const std::vector<LaserPictures>& places = input.laser->places;
  const auto along =
      static_cast<std::size_t>(std::ranges::count(places, true, &LaserPictures::along_columns));
  if (along == 0 || 2 * along < places.size()) return std::nullopt;
  return Refusal{
      .code = Refused::LaserAlongColumns,
      .reason = FixedText<160>::format("laser/: in %zu of %zu pictures the stripe runs along the columns",
                                       along, places.size())
                    .c_str()};
}

std::optional<Refusal> frozen_poses(const HeadInput& input) {
  if (!input.hand_eye) return std::nullopt;
  // An arm that is told to stand still does so to 0.02 mm; a new place of a calibration is far from that.
  constexpr double k_same_mm = 0.1, k_same_rad = 1e-3;
  /// As many places as a mounting needs.
  constexpr std::size_t k_least_places = 4;
  const std::vector<ArmPicture>& views = input.hand_eye->views;
  std::vector<SE3> places;
  for (const ArmPicture& view : views) {
    const bool known = std::ranges::any_of(places, [&](const SE3& place) {
      return (place.translation() - view.T_base_flange.translation()).norm() < k_same_mm &&
             geometry::angle_between_rad(place.linear(), view.T_base_flange.linear()) < k_same_rad;
    });
    if (!known) places.push_back(view.T_base_flange);
  }
  if (views.size() < k_least_places || places.size() >= k_least_places) return std::nullopt;
  return Refusal{
      .code = Refused::PosesFrozen,
      .reason = places.size() == 1
                    ? FixedText<160>::format("handeye/poses.csv: every pose is the same one (%zu of %zu)",
                                             views.size(), views.size())
                          .c_str()
                    : FixedText<160>::format("handeye/poses.csv: %zu poses are only %zu different ones",
                                             views.size(), places.size())
                          .c_str()};
}

}  // namespace

std::optional<Refusal> input_fault(const HeadInput& input) {
  const std::vector<PartPictures> parts = parts_of(input);
  if (auto fault = mosaics(parts)) return fault;
  if (auto fault = sizes(input, parts)) return fault;
  if (auto fault = turned_laser(input)) return fault;
  return frozen_poses(input);
}

}  // namespace biteline::calibration
