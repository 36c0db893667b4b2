// SPDX-License-Identifier: MIT
#pragma once
/// \file Sections of the raw surface along a path, level with it: o(z) at each station, fine enough for the
/// line's place.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/bite_line/buckets.hpp"
#include "host/bite_line/pooled_vector.hpp"
#include "host/bite_line/shoe/plan.hpp"
#include "host/bite_line/simd_kernels.hpp"

namespace biteline::bite_line {

struct SectionConfig {
  double row_mm{0.05};   ///< an eighth of the definition's Gaussian
  double below_mm{4.6};  ///< search 2.5 mm and five standard deviations of the Gaussian
  double above_mm{6.6};  ///< the normals' 6 mm and a margin
  double station_mm{0.5};
  double sigma_z_mm{
      0.06};  ///< merges a scan's points (0.07 mm apart) without touching the definition's 0.4 mm
};

/// o(z) per station; z counts from the path.  A row is unknown where no point is near, and below a jump
/// outwards that shows no point on its way: what lies there stands in front of the shoe and hides it.
struct Sections {
  int stations{0};
  int rows{0};
  int zero_row{0};  ///< the path's own height
  double row_mm{0};
  double station_mm{0};
  std::vector<double> path_z_mm;  ///< per station, in shoe
  PooledVector<float> o_mm;       ///< stations x rows; gaps up to 1.5 mm are filled by straight lines
  enum Known : std::uint8_t { k_nothing = 0, k_seen = 1, k_filled = 2 };
  PooledVector<std::uint8_t> known;
  std::vector<std::uint8_t> ended;  ///< per station: 1 where something stands in front of the shoe

  [[nodiscard]] std::size_t at(int station, int row) const {
    return static_cast<std::size_t>(station) * static_cast<std::size_t>(rows) + static_cast<std::size_t>(row);
  }
  [[nodiscard]] double z_mm(double row) const { return (row - zero_row) * row_mm; }
};

struct SectionInput {
  std::span<const Eigen::Vector3f> points;  ///< in shoe, those near the path
  const Outline& outline;
  std::span<const double> path_z_mm;  ///< per station
};

/// The points sorted into stations and rows; sections are cut out of them as finely along the line as is
/// asked for.
class SectionPoints {
 public:
  SectionPoints(const SectionInput& input, const SectionConfig& config);
  /// `sigma_s_mm`: weights along the line.
  [[nodiscard]] Sections cut(double sigma_s_mm) const;
  /// Distance along the line from one profile to the next, which three of four do not exceed.  What is far
  /// apart was not seen, and does not count.
  [[nodiscard]] double sample_mm() const;

  /// What lies in some rows of one station, unsmoothed.
  struct Patch {
    double points{0};
    double s_mm{0};  ///< mean, from the station's middle
    double row{0};   ///< mean
    double o_mm{0};  ///< mean
  };
  [[nodiscard]] Patch patch(int station, int low_row, int end_row) const;

 private:
  [[nodiscard]] PooledVector<Landing> landings_of(const SectionInput& input) const;
  [[nodiscard]] PooledVector<float> bins_of_landings() const;
  [[nodiscard]] bool any_point(int station, int low_row, int end_row) const;
  /// Whether points lie on the way from `o_mm` out to `far_mm`, seen in the stations `reach` to both sides.
  [[nodiscard]] bool seen_between(int station, int reach, int low_row, int end_row, float o_mm,
                                  float far_mm) const;
  /// The row below which something stands in front of the shoe.
  [[nodiscard]] std::optional<int> hidden_below(int station, int reach, const Sections& sections) const;

  SectionConfig config_;
  Sections frame_;  ///< without values
  PooledVector<Landing> landings_;
  Buckets at_station_;
  PooledVector<float> bins_;  ///< per station, one sum after the other, each over all rows
};

}  // namespace biteline::bite_line
