// SPDX-License-Identifier: MIT
#pragma once
/// \file What happens to a camera's pictures between two programs: as a whole session, picture by picture,
/// and for one pixel of the stripe.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"
#include "common/image/grey_image.hpp"

namespace biteline::test {

struct Spoil {
  enum class Kind {
    AsTheyAre,
    Mirrored,    ///< left to right
    UpsideDown,  ///< top to bottom
    Turned,      ///< by 180 degrees
    Halved,      ///< binned: half the scale, in the upper left corner of as large a picture
    Small,       ///< binned, and the picture is half as wide and high
    Rows,        ///< the stripe comes `amount` rows lower
    Columns,     ///< and so many columns to the right
  };
  Kind kind{Kind::AsTheyAre};
  int amount{0};
  [[nodiscard]] std::string name() const;
};

/// Where a full-sensor pixel comes then; outside of the region it is gone.
[[nodiscard]] Vec2 spoilt(const Vec2& pixel, const geometry::Region& region, const Spoil& spoil);
[[nodiscard]] image::GreyImage spoilt(const image::GreyImage& picture, const Spoil& spoil);
/// A session with the same sensor.yaml, poses and truth; every `every`-th picture.
[[nodiscard]] Result<void> write_spoilt_session(const std::filesystem::path& session,
                                                const std::filesystem::path& out, const Spoil& spoil,
                                                int every = 1);

}  // namespace biteline::test
