// SPDX-License-Identifier: MIT
#pragma once
/// \file A tapped frame as an observer wants it: cut out, scaled down, packed.

#include "common/core/result.hpp"
#include "common/wire/messages.hpp"
#include "firmware/pipeline/picture_tap.hpp"

namespace biteline::sensor {

/// Scaled by the least whole number that keeps to the wish's width and to what a message may hold.  A region
/// beside what the camera shows gives Errc::OutOfReach.  `head`: the region that the tap was made for.
[[nodiscard]] Result<wire::Picture> make_picture(const pipeline::TappedPicture& tapped,
                                                 const geometry::Region& head, const wire::PictureWish& wish);

}  // namespace biteline::sensor
