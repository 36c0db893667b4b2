// SPDX-License-Identifier: MIT
#pragma once
/// \file The stripe in a calibration picture: the sensor's own peak finder, thinned to well-determined
/// points.

#include <optional>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "common/image/grey_image.hpp"

namespace biteline::calibration {

/// A place on the stripe, full-sensor pixels; `sigma_px` is along the rows.
struct StripePoint {
  Vec2 pixel_px{Vec2::Zero()};
  double sigma_px{0};
};

struct PictureStripe {
  std::vector<StripePoint> points;  ///< one per column that shows exactly one sound peak; empty: no stripe
  std::optional<double> speckle_contrast;  ///< of the laser's light, where enough columns show it
};
[[nodiscard]] Result<PictureStripe> find_stripe(const image::GreyImage& picture);

/// Runs of up to `columns` neighbouring points replaced by their mean (a line over so few columns), single
/// ones off their run's line left out: a tenth of the equations with all of the information.
[[nodiscard]] std::vector<StripePoint> thin_stripe(const std::vector<StripePoint>& points, int columns);

/// The light is far longer along the columns than across them: camera or laser hangs turned by 90 degrees.
[[nodiscard]] bool runs_along_columns(const image::GreyImage& picture);

}  // namespace biteline::calibration
