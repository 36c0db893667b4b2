// SPDX-License-Identifier: MIT
#include "host/calibration/rings/detector.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "host/calibration/rings/edges.hpp"
#include "host/calibration/rings/threshold.hpp"

namespace biteline::calibration {

namespace {

/// Smaller inner circles leave too few pixels between the edges for a level of their own.
constexpr double k_least_inner_semi_px = 2.0;
/// Share of an edge that must be seen for its ellipse to be trusted.
constexpr double k_least_coverage_ratio = 0.6;
/// Each of the four thresholds may show a ring that is not seen whole, and so does not become one.
constexpr std::size_t k_most_tries_per_ring = 4;
/// Printed rings: anything from a thin ring to a small hole.
constexpr double k_least_diameter_ratio = 0.2, k_most_diameter_ratio = 0.9;

std::vector<Vec2> as_points(const std::vector<cv::Point>& contour) {
  std::vector<Vec2> points;
  points.reserve(contour.size());
  for (const cv::Point& p : contour) points.emplace_back(p.x, p.y);
  return points;
}

/// Ellipse of a contour of whole pixels, if it is one.
std::optional<Ellipse> contour_ellipse(const std::vector<cv::Point>& contour, bool touched) {
  if (contour.size() < 8) return std::nullopt;
  const std::vector<Vec2> points = as_points(contour);
  if (!touched) {
    const std::optional<Ellipse> ellipse = fit_ellipse(points);
    if (!ellipse) return std::nullopt;
    double sum = 0;
    for (const Vec2& p : points) sum += std::pow(ellipse->distance(p), 2);
    const double rms_px = std::sqrt(sum / static_cast<double>(points.size()));
    // Whole pixels alone give 0.4 px; print, blur and distortion the rest.
    if (rms_px > 0.7 + 0.03 * ellipse->minor_semi) return std::nullopt;
    return ellipse;
  }
  // A contour that runs on into something else: most of the points must still agree.
  const std::optional<RobustEllipse> robust = fit_ellipse_robustly(points, 0.8);
  if (!robust || robust->coverage_ratio < 0.75 || robust->rms > 0.7 + 0.03 * robust->ellipse.minor_semi)
    return std::nullopt;
  return robust->ellipse;
}

bool plausible_pair(const Ellipse& outer, const Ellipse& inner) {
  if (inner.minor_semi < k_least_inner_semi_px) return false;
  const double ratio = std::sqrt(inner.major_semi * inner.minor_semi / (outer.major_semi * outer.minor_semi));
  if (ratio < k_least_diameter_ratio || ratio > k_most_diameter_ratio) return false;
  // Perspective moves the centres apart by a few percent at most, and hardly changes the shapes.
  if ((outer.centre - inner.centre).norm() > 0.15 * outer.minor_semi + 1) return false;
  const double outer_shape = outer.minor_semi / outer.major_semi,
               inner_shape = inner.minor_semi / inner.major_semi;
  return std::abs(outer_shape - inner_shape) < 0.12 + 1.0 / inner.minor_semi;
}

/// Rough rings of one threshold: each bright hole with the dark region round it.
std::vector<std::pair<Ellipse, Ellipse>> rough_rings(const image::GreyImage& picture, int window_px) {
  std::vector<std::uint8_t> mask = dark_mask(picture, window_px);
  const cv::Mat binary(picture.height_px, picture.width_px, CV_8UC1, mask.data());
  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> links;
  cv::findContours(binary, contours, links, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  std::vector<std::pair<Ellipse, Ellipse>> found;
  // The dark round many holes is fitted once, not for each of them: so the work grows with the length of all
  // contours, and that with the picture.
  std::map<std::size_t, std::optional<Ellipse>> outers;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const int parent = links[i][3];
    if (parent < 0) continue;  // not a hole
    const cv::Rect box = cv::boundingRect(contours[i]);
    if (std::min(box.width, box.height) < 2 * k_least_inner_semi_px) continue;
    const std::optional<Ellipse> inner = contour_ellipse(contours[i], false);
    if (!inner || inner->minor_semi < k_least_inner_semi_px) continue;
    const auto of_dark = static_cast<std::size_t>(parent);
    const auto& around = contours[of_dark];
    // Dark surroundings of the whole board have holes too: their outline is far longer than a ring's.
    if (static_cast<double>(around.size()) > 40 * inner->major_semi / k_least_diameter_ratio) continue;
    const auto [known, is_new] = outers.try_emplace(of_dark);
    std::optional<Ellipse>& outer = known->second;
    if (is_new) outer = contour_ellipse(around, false);
    if (is_new && !outer) outer = contour_ellipse(around, true);
    if (outer && plausible_pair(*outer, *inner)) found.emplace_back(*outer, *inner);
  }
  return found;
}

}  // namespace

std::optional<Ring> refine_ring(const image::GreyImage& picture, const Ellipse& outer, const Ellipse& inner) {
  Ellipse near_outer = outer, near_inner = inner;
  std::optional<RobustEllipse> outer_fit, inner_fit;
  std::vector<Vec2> outer_points, inner_points;
  // The second pass starts from the first one's sub-pixel ellipse, so that the half-way levels are taken
  // symmetrically.
  for (int pass = 0; pass < 2; ++pass) {
    const double thickness_px = near_outer.minor_semi - near_inner.minor_semi;
    const double outer_reach_px = std::max(1.5, 0.42 * thickness_px);
    const double inner_reach_px = std::max(1.5, std::min(0.42 * thickness_px, 0.8 * near_inner.minor_semi));
    outer_points = edge_points(picture, near_outer, {.reach_px = outer_reach_px, .dark_outside = false});
    inner_points = edge_points(picture, near_inner, {.reach_px = inner_reach_px, .dark_outside = true});
    outer_fit = fit_ellipse_robustly(outer_points, 0.1);
    inner_fit = fit_ellipse_robustly(inner_points, 0.1);
    if (!outer_fit || !inner_fit) return std::nullopt;
    near_outer = outer_fit->ellipse;
    near_inner = inner_fit->ellipse;
    if (!plausible_pair(near_outer, near_inner)) return std::nullopt;
  }
  if (outer_fit->coverage_ratio < k_least_coverage_ratio ||
      inner_fit->coverage_ratio < k_least_coverage_ratio)
    return std::nullopt;
  if (outer_fit->rms > 0.5 + 0.02 * near_outer.minor_semi ||
      inner_fit->rms > 0.5 + 0.02 * near_inner.minor_semi)
    return std::nullopt;
  const std::optional<ConcentricCentre> centre = concentric_centre(near_outer, near_inner);
  if (!centre) return std::nullopt;
  Ring ring{.outer = near_outer,
            .inner = near_inner,
            .outer_edge = {},
            .inner_edge = {},
            .centre_px = centre->centre,
            .diameter_ratio = centre->diameter_ratio,
            .edge_rms_px = std::hypot(outer_fit->rms, inner_fit->rms) / std::sqrt(2.0)};
  for (std::size_t i = 0; i < outer_points.size(); ++i) {
    if (outer_fit->kept[i]) ring.outer_edge.push_back(outer_points[i]);
  }
  for (std::size_t i = 0; i < inner_points.size(); ++i) {
    if (inner_fit->kept[i]) ring.inner_edge.push_back(inner_points[i]);
  }
  return ring;
}

std::vector<Ring> find_rings(const image::GreyImage& picture, std::size_t most) {
  std::vector<Ring> rings;
  std::size_t tried = 0;
  const int side_px = std::max(picture.width_px, picture.height_px);
  // From windows that hold one small ring to the whole picture.
  for (const int divisor : {16, 8, 4, 1}) {
    for (const auto& [outer, inner] : rough_rings(picture, std::max(24, side_px / divisor))) {
      const bool known = std::any_of(
          rings.begin(), rings.end(),
          [&, middle = outer.centre](const Ring& ring) { return ring.outer.distance(middle) < 0; });
      if (known) continue;
      // Rings that are none cost as much as those that are.
      if (++tried > k_most_tries_per_ring * most) return {};
      if (std::optional<Ring> ring = refine_ring(picture, outer, inner)) rings.push_back(std::move(*ring));
      if (rings.size() > most) return {};
    }
  }
  return rings;
}

}  // namespace biteline::calibration
