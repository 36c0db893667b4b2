// SPDX-License-Identifier: MIT
#include "host/intake/capture/picture_judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "host/calibration/laser/stripe.hpp"
#include "host/calibration/rings/mosaic.hpp"

namespace biteline::capture {
namespace {

/// A lens of the head's kind blurs by 1.1 px; from 2.5 px on rings touch their neighbours' fits.
constexpr double k_soft_px = 2.0, k_blurred_px = 3.5;
constexpr int k_saturated_grey = 254;
constexpr double k_saturated_ratio = 0.02;
constexpr int k_dark_white_grey = 60;
constexpr double k_least_stripe_ratio = 0.1, k_stripe_saturated_ratio = 0.3;

std::string text(const char* pattern, double value) {
  char words[160];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
  std::snprintf(words, sizeof words, pattern, value);
#pragma GCC diagnostic pop
  return words;
}

/// The part of the picture that the grids take.
struct Box {
  int left{0}, top{0}, right{0}, bottom{0};

  void include(const Vec2& place_px) {
    left = std::min(left, static_cast<int>(place_px.x()));
    right = std::max(right, static_cast<int>(place_px.x()) + 1);
    top = std::min(top, static_cast<int>(place_px.y()));
    bottom = std::max(bottom, static_cast<int>(place_px.y()) + 1);
  }
};

Box box_of(const std::vector<calibration::GridView>& grids, const image::GreyImage& picture) {
  Box box{picture.width_px, picture.height_px, 0, 0};
  for (const calibration::GridView& grid : grids) {
    for (const calibration::GridRing& ring : grid.rings) {
      for (const Vec2& edge : ring.ring.outer_edge) box.include(edge);
      box.include(ring.ring.centre_px);  // a chessboard's corner is all there is
    }
  }
  return {std::max(box.left, 1), std::max(box.top, 1), std::min(box.right, picture.width_px - 1),
          std::min(box.bottom, picture.height_px - 1)};
}

using Histogram = std::array<std::size_t, 256>;

int quantile(const Histogram& histogram, double share) {
  std::size_t total = 0, seen = 0;
  for (const std::size_t count : histogram) total += count;
  for (std::size_t grey = 0; grey < histogram.size(); ++grey) {
    seen += histogram[grey];
    if (static_cast<double>(seen) >= share * static_cast<double>(total)) return static_cast<int>(grey);
  }
  return 255;
}

/// A board's edges run in two directions only, along neither of the picture's: each corner has its own fit.
double corner_blur_px(const std::vector<calibration::GridView>& grids) {
  std::vector<double> blurs_px;
  for (const calibration::GridView& grid : grids) {
    for (const calibration::GridRing& corner : grid.rings) blurs_px.push_back(corner.ring.blur_px);
  }
  if (blurs_px.empty()) return 0;
  const auto middle = blurs_px.begin() + static_cast<std::ptrdiff_t>(blurs_px.size() / 2);
  std::nth_element(blurs_px.begin(), middle, blurs_px.end());
  return *middle;
}

/// An edge of a given blur and contrast has its steepest slope of contrast / (sigma sqrt(2 pi)).
double blur_px(double contrast, int slope) {
  return slope <= 0 ? 1e3 : contrast / (slope * std::sqrt(2 * std::numbers::pi));
}

}  // namespace

PictureVerdict judge_rings(const image::GreyImage& picture, const std::vector<calibration::GridView>& grids,
                           const calibration::RingTarget& target) {
  PictureVerdict verdict;
  for (const calibration::GridView& grid : grids) verdict.rings += static_cast<int>(grid.rings.size());
  if (calibration::is_mosaic(picture)) {
    verdict.refused = std::string{"the picture "} + calibration::k_mosaic_words +
                      ": set the camera to a grey (mono) format";
    return verdict;
  }
  if (static_cast<int>(grids.size()) < target.planes) {
    verdict.refused = target.planes == 1
                          ? std::string(target.chessboard() ? "the chessboard" : "the ring target") +
                                " is not seen: is all of it in the picture, is the lamp on?"
                          : std::string("both planes of ") + target.marks() + " must be seen whole; " +
                                std::to_string(grids.size()) + " of 2 are";
    if (target.chessboard())
      verdict.refused += " Does target.yaml count its squares, and name the upper left one's colour?";
    return verdict;
  }
  const Box box = box_of(grids, picture);
  Histogram grey{}, slope_u{}, slope_v{};
  const auto at = [&](int u, int v) {
    return int{picture.pixels[static_cast<std::size_t>(v) * static_cast<std::size_t>(picture.width_px) +
                              static_cast<std::size_t>(u)]};
  };
  for (int v = box.top; v < box.bottom; ++v) {
    for (int u = box.left; u < box.right; ++u) {
      ++grey[static_cast<std::size_t>(at(u, v))];
      ++slope_u[static_cast<std::size_t>(std::abs(at(u + 1, v) - at(u - 1, v)) / 2)];
      ++slope_v[static_cast<std::size_t>(std::abs(at(u, v + 1) - at(u, v - 1)) / 2)];
    }
  }
  // A hundredth of the pixels lies on edges that run across the slope's direction.
  constexpr double k_steepest = 0.995, k_white = 0.95, k_black = 0.05;
  const int white = quantile(grey, k_white), black = quantile(grey, k_black);
  std::size_t saturated = 0, all = 0;
  for (std::size_t i = 0; i < grey.size(); ++i) {
    all += grey[i];
    if (static_cast<int>(i) >= k_saturated_grey) saturated += grey[i];
  }
  verdict.blur_px = target.chessboard() ? corner_blur_px(grids)
                                        : std::max(blur_px(white - black, quantile(slope_u, k_steepest)),
                                                   blur_px(white - black, quantile(slope_v, k_steepest)));
  const double saturated_ratio =
      static_cast<double>(saturated) / static_cast<double>(std::max<std::size_t>(all, 1));
  if (verdict.blur_px > k_blurred_px) {
    verdict.refused = text("blurred by %.1f px: focus, or let the arm come to rest", verdict.blur_px);
  } else if (saturated_ratio > k_saturated_ratio) {
    verdict.refused =
        text("too bright, %.0f % of it at full scale: less exposure or lamp", 100 * saturated_ratio);
  } else if (white < k_dark_white_grey) {
    verdict.refused = text("too dark, its white is at %.0f of 255: more exposure or lamp", white);
  } else if (verdict.blur_px > k_soft_px) {
    verdict.warnings.push_back(text("a little blurred (%.1f px): check the focus", verdict.blur_px));
  }
  const int expected = target.planes * target.rings();
  if (verdict.rings < expected)
    verdict.warnings.push_back(std::to_string(expected - verdict.rings) + " " + target.marks() +
                               " are not seen");
  return verdict;
}

PictureVerdict judge_stripe(const image::GreyImage& picture) {
  PictureVerdict verdict;
  const auto stripe = calibration::find_stripe(picture);
  const double columns = stripe ? static_cast<double>(stripe->points.size()) : 0;
  // A stripe at full scale has no sound peaks: it is looked for in the pixels themselves.
  const auto width = static_cast<std::size_t>(picture.width_px);
  std::vector<bool> full(width, false);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    if (picture.pixels[i] >= k_saturated_grey) full[i % width] = true;
  }
  const auto full_columns = static_cast<double>(std::ranges::count(full, true));
  if (columns < k_least_stripe_ratio * picture.width_px) {
    verdict.refused =
        calibration::runs_along_columns(picture)
            ? "the stripe runs along the columns: turn camera or laser by 90 degrees"
        : full_columns > columns
            ? text("the stripe is at full scale in %.0f columns: less laser exposure", full_columns)
            : text(
                  "the stripe is seen in %.0f columns only: more laser exposure, or does it miss the target?",
                  columns);
  } else if (full_columns > k_stripe_saturated_ratio * columns) {
    verdict.warnings.emplace_back(
        "much of the stripe is at full scale: less laser exposure is more accurate");
  }
  return verdict;
}

}  // namespace biteline::capture
