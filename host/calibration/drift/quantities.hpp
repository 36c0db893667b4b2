// SPDX-License-Identifier: MIT
#pragma once
/// \file What of a scanning head may drift, thirteen quantities in four parts, and the table that it sees.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "host/cloud/uncertainty/head_uncertainty.hpp"

namespace biteline::drift {

/// What a person would mend.  Head: its camera.  Table: no calibration's fault, but it looks like one.
enum class Part : std::uint8_t { Head, Laser, Mounting, Clock, Table };
inline constexpr std::size_t k_parts = 5;
inline constexpr std::array<std::string_view, k_parts> k_part_names{"head", "laser", "mounting", "clock",
                                                                    "table"};

struct Quantity {
  std::string_view name;
  Part part;
  std::string_view unit;  ///< of `size`, as a person reads it
  double size;            ///< of a fault worth telling; all numbers of this room count in it
  double si;              ///< the same in the unit of uncertainty::Parameters: px, mm, rad, s
};

inline constexpr int k_head_quantities = 13, k_table_quantities = 3;
inline constexpr int k_quantities = k_head_quantities + k_table_quantities;
/// The table's three are the last ones.
inline constexpr int k_table_at = k_head_quantities;
inline constexpr double k_turn_rad = 0.05 * 0.017453292519943295;

/// Laser turns are about the stripe's direction (tilt) and about the beam (roll); mounting is T_flange_cam's
/// perturbation, in the camera's axes; the table's height is that of its middle, its tilts are along the
/// base's x and y.
inline constexpr std::array<Quantity, k_quantities> k_table{{
    {"focal length", Part::Head, "px", 4, 4},
    {"principal point u", Part::Head, "px", 2, 2},
    {"principal point v", Part::Head, "px", 2, 2},
    {"laser tilt", Part::Laser, "deg", 0.05, k_turn_rad},
    {"laser roll", Part::Laser, "deg", 0.05, k_turn_rad},
    {"laser offset", Part::Laser, "mm", 0.1, 0.1},
    {"mounting x", Part::Mounting, "mm", 0.1, 0.1},
    {"mounting y", Part::Mounting, "mm", 0.1, 0.1},
    {"mounting z", Part::Mounting, "mm", 0.1, 0.1},
    {"mounting turn x", Part::Mounting, "deg", 0.05, k_turn_rad},
    {"mounting turn y", Part::Mounting, "deg", 0.05, k_turn_rad},
    {"mounting turn z", Part::Mounting, "deg", 0.05, k_turn_rad},
    {"pose clock", Part::Clock, "ms", 2, 2e-3},
    {"table height", Part::Table, "mm", 0.1, 0.1},
    {"table tilt x", Part::Table, "deg", 0.05, k_turn_rad},
    {"table tilt y", Part::Table, "deg", 0.05, k_turn_rad},
}};

/// One number for each quantity, in fault sizes.
using Vector = Eigen::Matrix<double, k_quantities, 1>;
using Matrix = Eigen::Matrix<double, k_quantities, k_quantities>;

/// The laser plane's axes and middle to which its turns belong: the stripe's direction, then the beam's,
/// about the plane's place nearest to the camera.  A laser turns in its holder, which stands beside the
/// camera: at the shoe its light then moves by more than a turn about a place there would tell.
[[nodiscard]] uncertainty::HeadUncertainty axes_of(const geometry::SensorModel& head);

/// `x` as the parameters of uncertainty::perturbed() with axes_of(): a head that has drifted by `x`.  The
/// table is none of them.
[[nodiscard]] uncertainty::Parameters parameters_of(const Vector& x);

/// d(parameters) / d(quantities).
[[nodiscard]] Eigen::Matrix<double, uncertainty::k_parameters, k_quantities> parameters_per_quantity();

}  // namespace biteline::drift
