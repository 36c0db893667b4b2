// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/uncertainty_file.hpp"

#include <cmath>
#include <cstdio>

#include "common/config/yaml_reader.hpp"

namespace biteline::uncertainty {
namespace {

using config::YamlReader;

// Written with nine digits; a lost digit or two swapped rows are off by far more.
constexpr double k_rounding = 1e-6;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

template <class Matrix>
std::string rows_of(const Matrix& matrix) {
  std::string text;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    text += row == 0 ? "\n  - [" : "  - [";
    for (Eigen::Index col = 0; col < matrix.cols(); ++col)
      text += (col == 0 ? "" : ", ") + number(matrix(row, col));
    text += "]\n";
  }
  return text;
}

bool is_covariance(const Covariance& matrix) {
  for (int row = 0; row < k_parameters; ++row) {
    if (!(matrix(row, row) >= 0)) return false;
    for (int col = 0; col < row; ++col) {
      const double most = (1 + k_rounding) * std::sqrt(matrix(row, row) * matrix(col, col));
      if (!(std::abs(matrix(row, col)) <= most)) return false;
      if (!(std::abs(matrix(row, col) - matrix(col, row)) <= k_rounding * most)) return false;
    }
  }
  return true;
}

}  // namespace

Result<HeadUncertainty> read_uncertainty(const std::filesystem::path& file) {
  BITELINE_ASSIGN(YamlReader reader, YamlReader::open(file));
  HeadUncertainty out;
  const std::vector<double> middle = reader.numbers("plane_middle_cam", 3, {.minimum = -1e5, .maximum = 1e5});
  out.plane_middle_cam = {middle[0], middle[1], middle[2]};
  const std::vector<double> axes = reader.matrix("plane_axes", 3, 2, {.minimum = -1, .maximum = 1});
  out.plane_axes = Eigen::Map<const Eigen::Matrix<double, 3, 2, Eigen::RowMajor>>(axes.data());
  const std::vector<double> values =
      reader.matrix("covariance", k_parameters, k_parameters, {.minimum = -1e6, .maximum = 1e6});
  out.covariance =
      Eigen::Map<const Eigen::Matrix<double, k_parameters, k_parameters, Eigen::RowMajor>>(values.data());
  if (!is_covariance(out.covariance))
    reader.fault(Errc::BadValue, "covariance", "a symmetric matrix with variances on its diagonal");
  out.pose_sigma_mm = reader.number("pose_sigma_mm", {.minimum = 0, .maximum = 100});
  out.pose_sigma_rad = reader.number("pose_sigma_rad", {.minimum = 0, .maximum = 1});
  constexpr const char* k_give = "arm_give_mm_per_m_s2";
  if (reader.has(k_give)) out.arm_give_mm_per_m_s2 = reader.number(k_give, {.minimum = 0, .maximum = 10});
  BITELINE_TRY(reader.finish());
  return out;
}

Result<std::optional<HeadUncertainty>> read_uncertainty_beside(const std::filesystem::path& sensor_yaml) {
  const std::filesystem::path file = sensor_yaml.parent_path() / k_file_name;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::optional<HeadUncertainty>{};
  BITELINE_ASSIGN(const HeadUncertainty uncertainty, read_uncertainty(file));
  return std::optional{uncertainty};
}

std::string uncertainty_text(const HeadUncertainty& uncertainty) {
  const Vec3& middle = uncertainty.plane_middle_cam;
  return "# How well the head of the sensor.yaml beside this file is known.\n"
         "# Rows: fu, fv, cu, cv [px], k1, k2, p1, p2, k3, plane's turn about two axes [rad], its distance\n"
         "# [mm], T_flange_cam's shift [mm] and turn [rad], pose clock [s].\n"
         "plane_middle_cam: [" +
         number(middle.x()) + ", " + number(middle.y()) + ", " + number(middle.z()) +
         "]\nplane_axes:" + rows_of(uncertainty.plane_axes) +
         "covariance:" + rows_of(uncertainty.covariance) +
         "pose_sigma_mm: " + number(uncertainty.pose_sigma_mm) +
         "\npose_sigma_rad: " + number(uncertainty.pose_sigma_rad) + "\n" +
         (uncertainty.arm_give_mm_per_m_s2
              ? "arm_give_mm_per_m_s2: " + number(*uncertainty.arm_give_mm_per_m_s2) + "\n"
              : "");
}

}  // namespace biteline::uncertainty
