// SPDX-License-Identifier: MIT
#include "host/records/results/pictures/shoe_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace biteline::results {
namespace {

constexpr int k_width_px = 1400;
constexpr int k_margin_px = 40;
// A line point this far behind the nearest surface is on the far side.
constexpr double k_hidden_mm = 4.0;

const cv::Vec3b k_background{255, 255, 255};
const cv::Scalar k_ink{60, 50, 40};

cv::Vec3b mix(const cv::Vec3b& a, const cv::Vec3b& b, double share) {
  cv::Vec3b out;
  for (int i = 0; i < 3; ++i) out[i] = cv::saturate_cast<unsigned char>((1 - share) * a[i] + share * b[i]);
  return out;
}

}  // namespace

cv::Vec3b curvature_colour(float curvature_per_mm, float limit_per_mm) {
  const double share = std::clamp<double>(std::abs(curvature_per_mm) / limit_per_mm, 0.0, 1.0);
  const cv::Vec3b blue{200, 60, 20}, red{40, 40, 210}, white{235, 235, 235};
  return mix(white, curvature_per_mm < 0 ? blue : red, share);
}

cv::Vec3b confidence_colour(double confidence) {
  const cv::Vec3b red{30, 30, 220}, yellow{30, 190, 230}, green{60, 160, 30};
  const double c = std::clamp(confidence, 0.0, 1.0);
  return c < 0.5 ? mix(red, yellow, 2 * c) : mix(yellow, green, 2 * c - 1);
}

ShoeView::ShoeView(const cloud::PointCloud& cloud, const SE3& T_base_shoe)
    : cloud_{cloud}, T_shoe_base_{T_base_shoe.inverse()} {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const auto& point : cloud.points) {
    const Vec3 p = T_shoe_base_ * point.cast<double>();
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3 size = high - low;
  px_per_mm_ = (k_width_px - 2 * k_margin_px) / std::max({size.x(), size.y(), 1.0});
  const auto height_of = [&](double mm) { return static_cast<int>(mm * px_per_mm_) + 2 * k_margin_px; };
  const int side_px = height_of(size.z()), top_px = height_of(size.y());
  const double left_px = k_margin_px - low.x() * px_per_mm_;
  // From the left side y points away from the viewer's back, so the nearest points have the largest y; x then
  // runs to the left.  Mirrored here to run to the right would swap left and right shoes, so we look from the
  // right side: smallest y.
  panels_.push_back({.right_axis = 0,
                     .up_axis = 2,
                     .depth_axis = 1,
                     .depth_sign = -1,
                     .origin_px = {left_px, k_margin_px + high.z() * px_per_mm_},
                     .area = {0, 0, k_width_px, side_px}});
  panels_.push_back({.right_axis = 0,
                     .up_axis = 1,
                     .depth_axis = 2,
                     .depth_sign = 1,
                     .origin_px = {left_px, side_px + k_margin_px + high.y() * px_per_mm_},
                     .area = {0, side_px, k_width_px, top_px}});
  picture_ = cv::Mat(side_px + top_px, k_width_px, CV_8UC3, k_background);
  depth_mm_ = cv::Mat(picture_.size(), CV_32F, cv::Scalar(-std::numeric_limits<float>::max()));
}

cv::Point ShoeView::place(const Panel& panel, const Vec3& point_shoe) const {
  return {static_cast<int>(std::lround(panel.origin_px.x + px_per_mm_ * point_shoe[panel.right_axis])),
          static_cast<int>(std::lround(panel.origin_px.y - px_per_mm_ * point_shoe[panel.up_axis]))};
}

bool ShoeView::is_hidden(const Panel& panel, const Vec3& point_shoe) const {
  const cv::Point at = place(panel, point_shoe);
  if (!panel.area.contains(at)) return true;
  // The cloud may have gaps of a pixel or two between its points.
  constexpr int k_reach_px = 2;
  const cv::Rect around =
      cv::Rect(at.x - k_reach_px, at.y - k_reach_px, 2 * k_reach_px + 1, 2 * k_reach_px + 1) & panel.area;
  double nearest_mm = 0;
  cv::minMaxLoc(depth_mm_(around), nullptr, &nearest_mm);
  return panel.depth_sign * point_shoe[panel.depth_axis] < nearest_mm - k_hidden_mm;
}

void ShoeView::draw_cloud(std::span<const cv::Vec3b> colours) {
  // Profiles lie about a millimetre apart: discs of that size close the surface.
  const int half_px = static_cast<int>(std::lround(0.5 * std::min(px_per_mm_, 8.0)));
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const Vec3 p = T_shoe_base_ * cloud_.points[i].cast<double>();
    for (const Panel& panel : panels_) {
      const cv::Point at = place(panel, p);
      double light = 0.85;
      if (!cloud_.normals.empty()) {
        const Vec3 n = T_shoe_base_.linear() * cloud_.normals[i].cast<double>();
        light =
            0.35 + 0.65 * std::clamp(panel.depth_sign * n[panel.depth_axis] * 0.8 + 0.35 * n.z(), 0.0, 1.0);
      }
      const cv::Vec3b base = colours.empty() ? cv::Vec3b{205, 200, 195} : colours[i];
      const cv::Vec3b colour = mix({0, 0, 0}, base, light);
      const auto depth = static_cast<float>(panel.depth_sign * p[panel.depth_axis]);
      for (int dv = -half_px; dv <= half_px; ++dv) {
        for (int du = -half_px; du <= half_px; ++du) {
          const cv::Point q{at.x + du, at.y + dv};
          if (!panel.area.contains(q) || depth < depth_mm_.at<float>(q)) continue;
          depth_mm_.at<float>(q) = depth;
          picture_.at<cv::Vec3b>(q) = colour;
        }
      }
    }
  }
}

void ShoeView::draw_points(std::span<const std::uint32_t> indices, const cv::Vec3b& colour) {
  for (const std::uint32_t index : indices) {
    const Vec3 p = T_shoe_base_ * cloud_.points[index].cast<double>();
    for (const Panel& panel : panels_) {
      if (!is_hidden(panel, p)) cv::circle(picture_, place(panel, p), 1, cv::Scalar(colour), cv::FILLED);
    }
  }
}

void ShoeView::draw_line(std::span<const Vec3> points_base, std::span<const cv::Vec3b> colours) {
  for (std::size_t i = 0; i < points_base.size(); ++i) {
    const Vec3 a = T_shoe_base_ * points_base[i],
               b = T_shoe_base_ * points_base[(i + 1) % points_base.size()];
    for (const Panel& panel : panels_) {
      const int thickness = is_hidden(panel, a) || is_hidden(panel, b) ? 1 : 3;
      cv::line(picture_, place(panel, a), place(panel, b), cv::Scalar(colours[i]), thickness, cv::LINE_AA);
    }
  }
}

void ShoeView::draw_normals(std::span<const Vec3> points_base, std::span<const Vec3> normals,
                            std::size_t stride) {
  constexpr double k_length_mm = 10.0;
  for (std::size_t i = 0; i < points_base.size(); i += stride) {
    const Vec3 a = T_shoe_base_ * points_base[i];
    const Vec3 b = T_shoe_base_ * Vec3(points_base[i] + k_length_mm * normals[i]);
    for (const Panel& panel : panels_) {
      if (!is_hidden(panel, a))
        cv::arrowedLine(picture_, place(panel, a), place(panel, b), {160, 70, 20}, 1, cv::LINE_AA, 0, 0.25);
    }
  }
}

void ShoeView::draw_discs(std::span<const Vec3> points_base, std::span<const cv::Vec3b> colours,
                          double radius_mm) {
  const int radius_px = std::max(1, static_cast<int>(std::lround(radius_mm * px_per_mm_)));
  for (std::size_t i = 0; i < points_base.size(); ++i) {
    const Vec3 p = T_shoe_base_ * points_base[i];
    for (const Panel& panel : panels_) {
      if (!is_hidden(panel, p))
        cv::circle(picture_, place(panel, p), radius_px, cv::Scalar(colours[i]), cv::FILLED);
    }
  }
}

void ShoeView::caption(const std::string& text) {
  cv::putText(picture_, text, {12, 24}, cv::FONT_HERSHEY_SIMPLEX, 0.6, k_ink, 1, cv::LINE_AA);
}

Result<void> write_picture(const std::filesystem::path& file, const cv::Mat& picture) {
  const std::filesystem::path beside = file.parent_path() / (".part." + file.filename().string());
  bool written = false;
  try {
    written = cv::imwrite(beside.string(), picture, {cv::IMWRITE_PNG_COMPRESSION, 3});
  } catch (const cv::Exception&) {
    written = false;  // told below, as every failure to write
  }
  std::error_code error;
  if (written) std::filesystem::rename(beside, file, error);
  if (!written || error) return fail(Errc::WriteFailed, "%s", file.c_str());
  return {};
}

}  // namespace biteline::results
