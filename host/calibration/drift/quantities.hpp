// SPDX-License-Identifier: MIT
#pragma once
/// \file What of a scanning head may drift: thirteen quantities in four parts.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>

#include "host/cloud/uncertainty/head_uncertainty.hpp"

namespace biteline::drift {

/// What a person would mend.
enum class Part : std::uint8_t { Head, Laser, Mounting, Clock };
inline constexpr std::size_t k_parts = 4;
inline constexpr std::array<std::string_view, k_parts> k_part_names{"head", "laser", "mounting", "clock"};

struct Quantity {
  std::string_view name;
  Part part;
  std::string_view unit;  ///< of `size`, as a person reads it
  double size;            ///< of a fault worth telling; all numbers of this room count in it
  double si;              ///< the same in the unit of uncertainty::Parameters: px, mm, rad, s
};

inline constexpr int k_quantities = 13;
inline constexpr double k_turn_rad = 0.05 * 0.017453292519943295;

/// The head is the camera itself.  Laser turns are about the stripe's direction (tilt) and about the beam
/// (roll); mounting is T_flange_cam's perturbation, in the camera's axes.
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
}};

/// One number for each quantity, in fault sizes.
using Vector = Eigen::Matrix<double, k_quantities, 1>;
using Matrix = Eigen::Matrix<double, k_quantities, k_quantities>;

/// The laser plane's axes and middle to which its turns belong: the stripe's direction, then the beam's,
/// about the place where the optical axis meets the plane.
[[nodiscard]] uncertainty::HeadUncertainty axes_of(const geometry::SensorModel& head);

/// `x` as the parameters of uncertainty::perturbed() with axes_of(): a head that has drifted by `x`.
[[nodiscard]] uncertainty::Parameters parameters_of(const Vector& x);

/// d(parameters) / d(quantities).
[[nodiscard]] Eigen::Matrix<double, uncertainty::k_parameters, k_quantities> parameters_per_quantity();

}  // namespace biteline::drift
