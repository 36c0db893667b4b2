// SPDX-License-Identifier: MIT
#include "tests/bench/stripe/peers.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace biteline::bench {
namespace {

constexpr int k_half_window = 8;
constexpr float k_threshold_grey = 12;

template <class Pixel>
float gravity(const cv::Mat& picture, int column, int top) {
  float sum = 0, moment = 0;
  for (int row = std::max(0, top - k_half_window); row <= std::min(picture.rows - 1, top + k_half_window);
       ++row) {
    const auto grey = static_cast<float>(picture.at<Pixel>(row, column));
    sum += grey;
    moment += grey * static_cast<float>(row);
  }
  return sum > 0 ? moment / sum : -1.0F;
}

}  // namespace

void opencv_gravity(const PeerFrame& frame, std::span<float> row_px) {
  const cv::Mat picture(frame.height_px, frame.width_px, CV_8U, const_cast<std::uint8_t*>(frame.pixels));
  cv::Mat blurred, maximum;
  cv::GaussianBlur(picture, blurred, {5, 5}, 0);
  cv::reduce(blurred, maximum, 0, cv::REDUCE_MAX);
  // OpenCV 4.5.4 and later have the index too.
  cv::Mat top;
  cv::reduceArgMax(blurred, top, 0);
  for (int column = 0; column < frame.width_px; ++column) {
    const bool lit = static_cast<float>(maximum.at<std::uint8_t>(0, column)) >= k_threshold_grey;
    row_px[static_cast<std::size_t>(column)] =
        lit ? gravity<std::uint8_t>(blurred, column, top.at<int>(0, column)) : -1.0F;
  }
}

void opencv_steger(const PeerFrame& frame, double sigma_px, std::span<float> row_px) {
  const cv::Mat picture(frame.height_px, frame.width_px, CV_8U, const_cast<std::uint8_t*>(frame.pixels));
  const int half = static_cast<int>(std::ceil(4 * sigma_px));
  cv::Mat g(2 * half + 1, 1, CV_32F), g1 = g.clone(), g2 = g.clone();
  for (int i = -half; i <= half; ++i) {
    const double value = std::exp(-0.5 * i * i / (sigma_px * sigma_px)) / (std::sqrt(2 * CV_PI) * sigma_px);
    g.at<float>(i + half) = static_cast<float>(value);
    g1.at<float>(i + half) = static_cast<float>(value * i / (sigma_px * sigma_px));
    g2.at<float>(i + half) =
        static_cast<float>(value * (i * i / std::pow(sigma_px, 4) - 1 / (sigma_px * sigma_px)));
  }
  cv::Mat rx, ry, rxx, rxy, ryy;
  cv::sepFilter2D(picture, rx, CV_32F, g1, g);
  cv::sepFilter2D(picture, ry, CV_32F, g, g1);
  cv::sepFilter2D(picture, rxx, CV_32F, g2, g);
  cv::sepFilter2D(picture, ryy, CV_32F, g, g2);
  cv::sepFilter2D(picture, rxy, CV_32F, g1, g1);

  std::vector<float> strength(static_cast<std::size_t>(frame.width_px), 0.5F);  // weaker ridges are noise
  std::fill(row_px.begin(), row_px.end(), -1.0F);
  for (int row = 0; row < frame.height_px; ++row) {
    for (int column = 0; column < frame.width_px; ++column) {
      const float a = rxx.at<float>(row, column), b = rxy.at<float>(row, column),
                  c = ryy.at<float>(row, column);
      // Eigenvalue of largest magnitude, and its vector.
      const float mean = 0.5F * (a + c), root = std::sqrt(0.25F * (a - c) * (a - c) + b * b);
      const float lambda = mean - root;
      if (-lambda <= strength[static_cast<std::size_t>(column)]) continue;
      float nx = b, ny = lambda - a;
      const float length = std::hypot(nx, ny);
      if (length < 1e-6F) {
        nx = a <= c ? 1.0F : 0.0F;
        ny = 1 - nx;
      } else {
        nx /= length;
        ny /= length;
      }
      // The kernels correlate: rx, ry are the derivatives as they stand.
      const float gx = rx.at<float>(row, column), gy = ry.at<float>(row, column);
      const float t = -(gx * nx + gy * ny) / (a * nx * nx + 2 * b * nx * ny + c * ny * ny);
      const float px = t * nx, py = t * ny;
      if (std::fabs(px) > 0.6F || std::fabs(py) > 0.6F) continue;
      strength[static_cast<std::size_t>(column)] = -lambda;
      row_px[static_cast<std::size_t>(column)] = static_cast<float>(row) + py;
    }
  }
}

}  // namespace biteline::bench
