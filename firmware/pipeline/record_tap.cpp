// SPDX-License-Identifier: MIT
#include "firmware/pipeline/record_tap.hpp"

#include <algorithm>

namespace biteline::pipeline {
namespace {

std::size_t bytes_of(const geometry::Region& region) {
  return static_cast<std::size_t>(region.width_px) * static_cast<std::size_t>(region.height_px);
}

std::size_t frames_for(const geometry::Region& region) {
  constexpr std::size_t k_least = 4;
  return std::clamp(RecordTap::k_room_bytes / std::max<std::size_t>(bytes_of(region), 1), k_least,
                    RecordTap::k_most_frames);
}

}  // namespace

RecordTap::RecordTap(const geometry::Region& region, std::uint32_t every)
    : every_{every}, frames_{frames_for(region)} {
  // Written to, so that the first frames meet no page that is not there yet.
  for (std::size_t i = 0; i < frames_.count(); ++i)
    frames_[static_cast<rt::BufferIndex>(i)].pixels.assign(bytes_of(region), 0);
}

}  // namespace biteline::pipeline
