// SPDX-License-Identifier: MIT
#pragma once
/// \file What the side is made of, as the stripe tells it: whether that changes across a closed path.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/pooled_vector.hpp"
#include "host/bite_line/scan_points.hpp"
#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

struct MaterialConfig {
  /// What lies above a place and below it, each over so much height.  The gap between holds the crease, whose
  /// own slopes and shadows say nothing of a material.
  double from_mm{1.5};
  double to_mm{5.0};
  double row_mm{0.5};  ///< of the cells
  double col_mm{4.0};
  double least_runs{4};           ///< to each side of a place
  double least_known_share{0.6};  ///< of a path's columns
  /// In logarithms, about as in percent: what slopes and shadows leave on one material.
  double least_noise_amplitude{0.06};
  double least_noise_width{0.03};
  /// Of the tangent of the angle that the light comes from: where the slopes above and below differ, that
  /// much of it is not known.
  double light_spread{0.3};
  /// A contrast of so many times the noise is nothing, of so many it is plain.
  double nothing{2.0};
  double plain{4.0};
};

/// Of the stripe's amplitude and width, upwards across a path: logarithm of the ratio, median all round, over
/// the noise.
struct MaterialContrast {
  double amplitude{0};
  double width{0};
};

/// Amplitude and width in cells of the side.
///
/// A stripe is brighter where the laser falls straight on the surface, by Lambert's cosine, and near by.  So
/// only what lies above and below one and the same place of the outline is compared, and of that the cosine
/// is taken off: log cos(a - b) = log cos a + log cos b + log(1 + tan a tan b), with a the surface's slope,
/// and tan b, where the light comes from, by a fit to neighbouring places.  These are mostly of one material,
/// so a change of it does not pass for light.  What is left scatters as the surfaces do: that is the noise.
class Materials {
 public:
  /// `looks`: of the runs that `shoe.index` names.  Nothing where too few are known.
  [[nodiscard]] static std::optional<Materials> of(const Shoe& shoe, const SideField& field,
                                                   std::span<const RunLook> looks,
                                                   const MaterialConfig& config = {});

  /// Across a path, one row per column of the field.  `beside`: another one, which bounds what is looked at
  /// on its side: a change there is none here.  Nothing where too little of the side is known.
  [[nodiscard]] std::optional<MaterialContrast> across(std::span<const int> path,
                                                       std::span<const int> beside) const;
  /// -1 to 1: the material changes at `line` and not at `rival`, or the other way round.  0 where it changes
  /// at both, at none, or is not known at one of them.
  [[nodiscard]] double favours(std::span<const int> line, std::span<const int> rival) const;

 private:
  enum Channel : std::size_t { k_amplitude, k_width, k_channels };
  /// Sums over runs; of a place, differences of means, above over below.
  struct Sums {
    float runs{0};
    std::array<float, k_channels> value{};
    float slope{0};
  };
  struct Window {
    double from_mm, above_mm, below_mm, least_runs;
  };
  Materials(const SideGrid& grid, const MaterialConfig& config);
  void collect(const Shoe& shoe, const SideField& field, std::span<const RunLook> looks);
  [[nodiscard]] bool fit();
  [[nodiscard]] Window whole_window() const {
    return {.from_mm = config_.from_mm,
            .above_mm = config_.to_mm,
            .below_mm = config_.to_mm,
            .least_runs = config_.least_runs};
  }
  [[nodiscard]] std::optional<Sums> mean(int col, int low, int high, double least_runs) const;
  [[nodiscard]] std::optional<Sums> step_at(int col, double height_mm, const Window& window) const;
  [[nodiscard]] std::vector<Sums> steps(const Window& window, double every_mm) const;
  [[nodiscard]] double rest(const Sums& step, std::size_t channel) const {
    return static_cast<double>(step.value[channel]) - by_slope_[channel] * static_cast<double>(step.slope);
  }
  /// 0: one colour; 1: another material begins there, all the way round.
  [[nodiscard]] double change(const MaterialContrast& found) const;
  [[nodiscard]] double contrast(std::span<const Sums> steps, std::size_t channel) const;

  SideGrid grid_;
  MaterialConfig config_;
  int rows_, cols_;           ///< cells
  PooledVector<Sums> below_;  ///< per column of cells and row, one more than there are: of all rows below
  std::array<double, k_channels> by_slope_{}, noise_{};
};

}  // namespace biteline::bite_line
