// SPDX-License-Identifier: MIT
#pragma once
/// \file A laser stripe in a colour photograph, found as the sensor finds it.

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/stripe/line_average.hpp"
#include "common/stripe/peak_extractor.hpp"
#include "common/stripe/peak_selector.hpp"

namespace biteline::stripe::test {

struct SeenPoint {
  Vec2 pixel_px{Vec2::Zero()};
  double sigma_px{0};  ///< along the rows
  bool surface{true};  ///< false: reported with its place, but as cut by a step of brightness
};

/// About what a red bandpass filter before a monochrome camera would leave: red less what is as bright over
/// more rows than the stripe has.  Green would show the lamp's light alone, but these pictures were JPEGs
/// with half the rows for colour: a difference of channels loses the stripe's bright core.
inline cv::Mat red_above_lamp(const cv::Mat& colour) {
  constexpr int k_rows = 21;
  cv::Mat red, lamp, picture;
  cv::extractChannel(colour, red, 2);
  cv::morphologyEx(red, lamp, cv::MORPH_OPEN, cv::Mat::ones(k_rows, 1, CV_8U));
  cv::subtract(red, lamp, picture);
  return picture;
}

/// Peaks, the choice among them, the average along the line: the sensor's own, for light that is wider and
/// less of one shape than a scanner's.  Points flagged for anything else than a step of brightness are left
/// out.
inline std::vector<SeenPoint> seen_stripe(const cv::Mat& picture) {
  const auto peaks = std::make_unique<Peaks>();
  const auto selection = std::make_unique<Selection>();
  auto extractor = PeakExtractor::create({.threshold_grey = 20,
                                          .width_max_px = 40,
                                          .noise = {.speckle_contrast = 0.3F, .speckle_contrast_min = 0.3F}},
                                         picture.cols, picture.rows);
  if (!extractor) return {};
  const auto selector = std::make_unique<PeakSelector>(SelectorConfig{});
  extractor->rt_extract({.pixels = picture.data, .stride_bytes = picture.step}, *peaks);
  selector->rt_select(*peaks, *selection);
  const auto columns = static_cast<std::size_t>(picture.cols);
  std::vector<LinePoint> line(columns), work(columns);
  const auto is_surface = [&](std::size_t u) { return line[u].present && selection->columns[u].flags == 0; };
  for (std::size_t u = 0; u < columns; ++u) {
    const Selected& selected = selection->columns[u];
    if (selected.kept_index < 0 || (selected.flags & ~k_selection_brightness_step) != 0) continue;
    const Peak& peak = peaks->columns[u].kept[static_cast<std::size_t>(selected.kept_index)];
    if (peak.flags & k_peak_clipped) continue;
    line[u] = {.row_px = peak.row_px,
               .sigma_row_px = peak.sigma_row_px,
               .present = true,
               .joined = selected.joined && selected.flags == 0 && u > 0 && is_surface(u - 1)};
  }
  LineAverage({}).rt_average(line, work, peaks->speckle.neighbour_correlation);
  std::vector<SeenPoint> seen;
  for (std::size_t u = 0; u < columns; ++u) {
    if (!line[u].present) continue;
    seen.push_back({.pixel_px = {static_cast<double>(u), static_cast<double>(line[u].row_px)},
                    .sigma_px = std::hypot(line[u].sigma_row_px, selection->columns[u].skew_sigma_px),
                    .surface = is_surface(u)});
  }
  return seen;
}

}  // namespace biteline::stripe::test
