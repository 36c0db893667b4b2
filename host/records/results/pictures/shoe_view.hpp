// SPDX-License-Identifier: MIT
#pragma once
/// \file Pictures of points and lines on a shoe: from its left side and from above, to one scale.

#include <filesystem>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/se3.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::results {

/// Two panels, the side view above the view from the top.  Nearer points hide farther ones.
class ShoeView {
 public:
  /// Scale and panels are chosen so that all of `cloud` is seen.  Pre: the cloud is not empty.
  ShoeView(const cloud::PointCloud& cloud, const SE3& T_base_shoe);
  ShoeView(const ShoeView&) = delete;  // a cv::Mat copies its header only: both would draw into one picture
  ShoeView& operator=(const ShoeView&) = delete;

  /// Every point of the cloud, lit from the viewer when it has normals; `colours` (BGR, one per point) or
  /// grey.
  void draw_cloud(std::span<const cv::Vec3b> colours);
  /// Some points of the cloud, larger, over everything drawn so far.
  void draw_points(std::span<const std::uint32_t> indices, const cv::Vec3b& colour);
  /// Discs of `radius_mm` in base, over everything drawn so far.  `colours`: one per point.
  void draw_discs(std::span<const Vec3> points_base, std::span<const cv::Vec3b> colours, double radius_mm);
  /// A closed line in base; what the shoe hides is drawn thin.  `colours`: one per point.
  void draw_line(std::span<const Vec3> points_base, std::span<const cv::Vec3b> colours);
  /// A short stroke of `length_mm` from each `stride`-th point.
  void draw_normals(std::span<const Vec3> points_base, std::span<const Vec3> normals, std::size_t stride);
  void caption(const std::string& text);

  [[nodiscard]] const cv::Mat& picture() const { return picture_; }

 private:
  struct Panel {
    int right_axis, up_axis, depth_axis;  ///< of the shoe frame
    double depth_sign;                    ///< nearer points have the larger depth_sign * depth
    cv::Point2d origin_px;                ///< where shoe's (0, 0) lies
    cv::Rect area;
  };

  [[nodiscard]] cv::Point place(const Panel& panel, const Vec3& point_shoe) const;
  [[nodiscard]] bool is_hidden(const Panel& panel, const Vec3& point_shoe) const;

  const cloud::PointCloud& cloud_;
  SE3 T_shoe_base_;
  double px_per_mm_{1};
  std::vector<Panel> panels_;
  cv::Mat picture_;
  cv::Mat depth_mm_;
};

/// Blue (concave) over white to red (convex); saturates at `limit_per_mm`.
[[nodiscard]] cv::Vec3b curvature_colour(float curvature_per_mm, float limit_per_mm);

/// Red (0) over yellow to green (1).
[[nodiscard]] cv::Vec3b confidence_colour(double confidence);

/// As PNG, beside and renamed.
[[nodiscard]] Result<void> write_picture(const std::filesystem::path& file, const cv::Mat& picture);

}  // namespace biteline::results
