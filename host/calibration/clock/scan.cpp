// SPDX-License-Identifier: MIT
#include "host/calibration/clock/scan.hpp"

#include <tbb/parallel_for.h>

#include <optional>

#include "host/calibration/laser/stripe.hpp"

namespace biteline::calibration {

Result<Scan> read_scan(const std::filesystem::path& session_folder, int column_step) {
  BITELINE_ASSIGN(session::Session session, session::read_session(session_folder));
  Scan scan{.frames = std::vector<ScanFrame>(session.frames.size()),
            .poses = std::move(session.poses),
            .sensor = session.sensor};
  std::vector<std::optional<Error>> errors(session.frames.size());
  tbb::parallel_for(std::size_t{0}, session.frames.size(), [&](std::size_t i) {
    const session::FrameEntry& entry = session.frames[i];
    scan.frames[i].exposure_mid = entry.exposure_mid;
    const Result<image::GreyImage> picture = image::read_png(entry.file);
    if (!picture) {
      errors[i] = picture.error();
      return;
    }
    const Result<PictureStripe> stripe = find_stripe(*picture);
    if (!stripe) {
      errors[i] = stripe.error();
      return;
    }
    const Vec2 offset_px(session.sensor.region.offset_u_px, session.sensor.region.offset_v_px);
    for (const StripePoint& p : stripe->points) {
      if (static_cast<int>(p.pixel_px.x()) % column_step == 0)
        scan.frames[i].stripe_px.push_back(p.pixel_px + offset_px);
    }
  });
  for (const auto& error : errors) {
    if (error) return tl::unexpected<Error>(*error);
  }
  return scan;
}

}  // namespace biteline::calibration
