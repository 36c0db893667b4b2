// SPDX-License-Identifier: MIT
#pragma once
/// \file A scanning head, the laser's stripe in a picture, and the points that it stands for.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "biteline/export.hpp"
#include "biteline/motion.hpp"

namespace biteline::sdk {

/// Camera, laser plane and mounting of one head, as sensor.yaml has them.
class BITELINE_API Head {
 public:
  struct State;  ///< of the library

  explicit Head(std::shared_ptr<const State> state);

  /// Size of the pictures, pixels.
  [[nodiscard]] int width_px() const;
  [[nodiscard]] int height_px() const;
  /// The camera on the robot's flange.
  [[nodiscard]] Motion T_flange_cam() const;
  /// Unit normal n and distance d of the laser's plane, n . X = d, in the camera's frame, mm.
  [[nodiscard]] Eigen::Vector3d laser_normal_cam() const;
  [[nodiscard]] double laser_distance_mm() const;
  /// Pixel (column, row) of a picture at which a point of the camera's frame is seen, z > 0.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& point_cam_mm) const;
  /// Point of the laser's plane that is seen at (column, row) of a picture, in the camera's frame, mm:
  /// X = r d / (n . r) with the viewing ray r.  Throws Error where the ray does not meet the plane.
  [[nodiscard]] Eigen::Vector3d triangulate(double column_px, double row_px) const;
  /// sensor.yaml, with all digits.
  [[nodiscard]] std::string yaml() const;

 private:
  std::shared_ptr<const State> state_;
};

/// Reads sensor.yaml.  Throws Error naming the key and what was expected.
[[nodiscard]] BITELINE_API Head read_head(const std::filesystem::path& file);

/// 8-bit grey levels, row by row; the rows begin `stride_bytes` apart.
struct Picture {
  const std::uint8_t* pixels{nullptr};
  std::size_t stride_bytes{0};
  int width_px{0};
  int height_px{0};
};

struct StripeSettings {
  float threshold_grey{12};  ///< a stripe is at least this high above its background
  float width_min_px{1.5F};  ///< full width at half maximum
  float width_max_px{24};
};

/// The stripe in one column.
struct Peak {
  int column_px{0};
  float row_px{0};        ///< to a fraction of a pixel; 0 is the middle of the first row
  float sigma_row_px{0};  ///< its standard deviation
  float amplitude{0};     ///< above the background, grey levels
  float width_px{0};      ///< full width at half maximum
  bool sound{true};       ///< neither saturated, nor cut by the edge, nor of an odd width or shape
};

/// The stripe's strongest peak in each column that has one, by column.  Throws Error for a picture below
/// 16 x 16 pixels or above 2592 columns.
[[nodiscard]] BITELINE_API std::vector<Peak> find_stripe(const Picture& picture,
                                                         const StripeSettings& settings = {});

}  // namespace biteline::sdk
