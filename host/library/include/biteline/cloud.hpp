// SPDX-License-Identifier: MIT
#pragma once
/// \file The points of one scan.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "biteline/export.hpp"

namespace biteline::sdk {

enum class Unit { Millimetre, Centimetre, Metre, Inch };

/// Points in mm, z up.  A copy shares the points; nobody changes them.
class BITELINE_API Cloud {
 public:
  struct State;  ///< of the library

  /// Throws Error where a number is not finite, or there is no point.
  explicit Cloud(std::vector<Eigen::Vector3f> points_mm);
  explicit Cloud(std::shared_ptr<const State> state);

  [[nodiscard]] std::size_t size() const;
  /// Valid as long as a copy of this cloud lives; so are the others.
  [[nodiscard]] std::span<const Eigen::Vector3f> points_mm() const;
  /// Number of each point's profile; empty for a cloud without scan order.
  [[nodiscard]] std::span<const std::uint32_t> profile() const;
  /// Picture column of each point; empty as above.
  [[nodiscard]] std::span<const std::uint16_t> column() const;
  /// Standard deviation of each point along the camera's ray, mm; may be empty.
  [[nodiscard]] std::span<const float> sigma_mm() const;
  [[nodiscard]] const State& state() const { return *state_; }

 private:
  std::shared_ptr<const State> state_;
};

/// Reads .ply .pcd .xyz .txt .asc .csv .pts .stl .obj; a mesh is sampled at 0.35 mm.  `unit`: of the file's
/// numbers.  Throws Error naming file, row and field.
[[nodiscard]] BITELINE_API Cloud read_cloud(const std::filesystem::path& file, Unit unit = Unit::Millimetre);

/// As binary PLY, with all that is known of each point.
BITELINE_API void write_cloud(const std::filesystem::path& file, const Cloud& cloud);

}  // namespace biteline::sdk
