// SPDX-License-Identifier: MIT
#pragma once
/// \file Exposure and gain of a V4L2 sensor, in our units.

#include <cstdint>
#include <optional>

#include "common/core/result.hpp"
#include "common/time/clocks.hpp"

namespace biteline::hal {

/// How a driver counts exposure: USB cameras in steps of 100 us (EXPOSURE_ABSOLUTE), raw sensors in lines,
/// whose length follows from the pixel rate and the blanking.
struct ExposureRegister {
  std::uint32_t id{0};
  Nanoseconds unit{0};
  std::int64_t minimum{0}, maximum{0}, step{1};

  [[nodiscard]] Nanoseconds shortest() const { return minimum * unit; }
  [[nodiscard]] Nanoseconds longest() const { return maximum * unit; }
  /// The nearest that the driver takes; Errc::BadValue beyond the range.
  [[nodiscard]] Result<std::int64_t> steps_for(Nanoseconds exposure) const;
};

/// Nothing: the driver has no exposure control, or counts lines and does not tell their length.
[[nodiscard]] std::optional<ExposureRegister> find_exposure(int device, int width_px);

/// Gives back what the driver made of it.
[[nodiscard]] Result<Nanoseconds> set_exposure(int device, const ExposureRegister& control,
                                               Nanoseconds exposure);

/// In the driver's steps.
struct GainRange {
  std::uint32_t id{0};
  std::int32_t minimum{0}, maximum{0};
  std::optional<std::int32_t> now{};  ///< none: the driver does not tell
};
[[nodiscard]] std::optional<GainRange> find_gain(int device);

/// Analogue gain in the driver's steps.
[[nodiscard]] Result<void> set_gain(int device, std::int32_t gain);

/// Automatic exposure, gain, black level and focus off, where the driver has them: a made-up exposure would
/// move mid-exposure, another focus every ray.
void turn_automatics_off(int device);

}  // namespace biteline::hal
