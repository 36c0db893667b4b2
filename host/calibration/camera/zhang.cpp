// SPDX-License-Identifier: MIT
#include "host/calibration/camera/zhang.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "host/geometry/symmetric.hpp"

namespace biteline::calibration {

namespace {

using Row5 = Eigen::Matrix<double, 1, 5>;

/// Zhang eq. (7) with B12 = 0: b = (B11, B22, B13, B23, B33).
Row5 v_row(const Mat3& H, int i, int j) {
  const Vec3 h_i = H.col(i), h_j = H.col(j);
  Row5 v;
  v << h_i[0] * h_j[0], h_i[1] * h_j[1], h_i[2] * h_j[0] + h_i[0] * h_j[2], h_i[2] * h_j[1] + h_i[1] * h_j[2],
      h_i[2] * h_j[2];
  return v;
}

std::optional<geometry::Camera> solve_all(std::span<const Mat3> homographies) {
  Eigen::Matrix<double, 5, 5> scatter = Eigen::Matrix<double, 5, 5>::Zero();
  for (const Mat3& H : homographies) {
    for (const Row5& row : {Row5(v_row(H, 0, 1)), Row5(v_row(H, 0, 0) - v_row(H, 1, 1))})
      scatter += row.transpose() * row;
  }
  Eigen::Matrix<double, 5, 1> b = geometry::principal_axes(scatter).vectors.col(0);
  if (b[0] < 0) b = -b;
  if (!(b[0] > 0) || !(b[1] > 0)) return std::nullopt;
  const double cu = -b[2] / b[0], cv = -b[3] / b[1];
  const double lambda = b[4] - b[2] * b[2] / b[0] - b[3] * b[3] / b[1];
  if (!(lambda > 0)) return std::nullopt;
  return geometry::Camera{
      .fu_px = std::sqrt(lambda / b[0]), .fv_px = std::sqrt(lambda / b[1]), .cu_px = cu, .cv_px = cv};
}

/// Principal point known (0, 0): B = diag(1 / fu^2, 1 / fv^2, 1).
std::optional<geometry::Camera> solve_focal(std::span<const Mat3> homographies) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Vec2 right = Vec2::Zero();
  for (const Mat3& H : homographies) {
    for (const Row5& row : {Row5(v_row(H, 0, 1)), Row5(v_row(H, 0, 0) - v_row(H, 1, 1))}) {
      normal += row.head<2>().transpose() * row.head<2>();
      right -= row.head<2>().transpose() * row[4];
    }
  }
  const Vec2 b = geometry::solve_symmetric(normal, right);
  if (!(b[0] > 0) || !(b[1] > 0)) {
    const double both = right.sum() / normal.sum();  // one focal length
    if (!(both > 0)) return std::nullopt;
    return geometry::Camera{.fu_px = 1 / std::sqrt(both), .fv_px = 1 / std::sqrt(both)};
  }
  return geometry::Camera{.fu_px = 1 / std::sqrt(b[0]), .fv_px = 1 / std::sqrt(b[1])};
}

}  // namespace

std::optional<geometry::Camera> closed_form_camera(std::span<const Mat3> homographies, PictureSize size) {
  // Picture coordinates of about unit size, origin in the middle: the squares of B differ by 1e7 otherwise.
  const double scale = std::max(size.width_px, size.height_px);
  const Vec2 middle_px((size.width_px - 1) / 2.0, (size.height_px - 1) / 2.0);
  Mat3 N = Mat3::Identity();
  N(0, 0) = N(1, 1) = 1 / scale;
  N.topRightCorner<2, 1>() = -middle_px / scale;
  std::vector<Mat3> scaled;
  for (const Mat3& H : homographies) {
    const Mat3 NH = N * H;
    scaled.push_back(NH / NH.norm());
  }
  std::optional<geometry::Camera> camera = solve_all(scaled);
  // A principal point outside of the picture or a focal length of another order is a failed solution, not a
  // lens.
  const auto sensible = [](const geometry::Camera& c) {
    return std::abs(c.cu_px) < 0.5 && std::abs(c.cv_px) < 0.5 && c.fu_px > 0.2 && c.fu_px < 50 &&
           c.fv_px / c.fu_px > 0.5 && c.fv_px / c.fu_px < 2;
  };
  if (!camera || !sensible(*camera)) camera = solve_focal(scaled);
  if (!camera || !sensible(*camera)) return std::nullopt;
  camera->fu_px *= scale;
  camera->fv_px *= scale;
  camera->cu_px = camera->cu_px * scale + middle_px.x();
  camera->cv_px = camera->cv_px * scale + middle_px.y();
  return camera;
}

}  // namespace biteline::calibration
