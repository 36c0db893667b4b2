// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor's raw pictures as GigE Vision frames.

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/sensor_model.hpp"
#include "common/wire/messages.hpp"

namespace biteline::gige {

/// All of a head's region, each pixel the mean of step x step of the sensor's.
struct PictureShape {
  geometry::Region region{};
  int step{1};

  [[nodiscard]] std::uint32_t columns() const { return static_cast<std::uint32_t>(region.width_px / step); }
  [[nodiscard]] std::uint32_t rows() const { return static_cast<std::uint32_t>(region.height_px / step); }
  [[nodiscard]] bool same_as(const PictureShape& other) const {
    return step == other.step && region.offset_u_px == other.region.offset_u_px &&
           region.offset_v_px == other.region.offset_v_px && region.width_px == other.region.width_px &&
           region.height_px == other.region.height_px;
  }
  [[nodiscard]] std::size_t bytes() const { return std::size_t{columns()} * rows(); }
};

/// As fine as one message of the sensor allows.
[[nodiscard]] PictureShape picture_shape(const geometry::Region& head);

/// What an observer says to get such pictures, as many as there are.
[[nodiscard]] wire::PictureWish wish_for(const PictureShape& shape);

/// Row by row; 0 where the camera showed nothing.  Nothing: a picture that is not raw, or of another step.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> whole_picture(const PictureShape& shape,
                                                                     const wire::Picture& picture);

/// As a profile's line_record(), with the profile that the picture completed; without a pose.
[[nodiscard]] std::vector<std::uint8_t> picture_record(std::uint64_t scan, const wire::Picture& picture,
                                                       Nanoseconds exposure);

}  // namespace biteline::gige
