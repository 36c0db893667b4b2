// SPDX-License-Identifier: MIT
#include "firmware/pipeline/picture_tap.hpp"

namespace biteline::pipeline {
namespace {

TappedPicture room_for(const geometry::Region& region) {
  TappedPicture picture;
  picture.pixels.resize(static_cast<std::size_t>(region.width_px) *
                        static_cast<std::size_t>(region.height_px));
  picture.peaks.resize(profile::k_max_profile_points);
  return picture;
}

}  // namespace

PictureTap::PictureTap(const geometry::Region& region) : region_{region}, pictures_{room_for(region)} {}

}  // namespace biteline::pipeline
