// SPDX-License-Identifier: MIT
#pragma once
/// \file What a camera does to its picture before it gives it out: mirror, turn, binning, size, black level.
///
/// A calibration holds for one such state.  A picture in another one gives a sure, wrong line: nothing in it
/// shows that it is mirrored, turned or another part of the sensor.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/numbers.hpp"
#include "common/core/result.hpp"

namespace biteline::geometry {

/// The numbers travel on the wire: only added to at the end.
enum class StateKey : std::uint8_t {
  MirrorX,  ///< left to right: ReverseX, HFLIP
  MirrorY,  ///< top to bottom: ReverseY, VFLIP
  Turn,
  BinningX,
  BinningY,
  DecimationX,  ///< pixels skipped
  DecimationY,
  SensorWidth,  ///< of the full picture in which regions are counted
  SensorHeight,
  BlackLevel,
  Zoom,
  Pan,
  Tilt,
  Focus,
  Aperture,
};
inline constexpr std::size_t k_state_keys = 15;

struct StateRow {
  StateKey key;
  const char* name;             ///< in files
  const char* words;            ///< in sentences
  bool is_switch;               ///< 0 or 1
  std::optional<double> usual;  ///< what a calibration that does not tell means; none: not compared then
  NumberRange range;
};
/// In the order of the keys.
[[nodiscard]] std::span<const StateRow> state_table();

/// A value that is not there was not told: by the device, or by a calibration of before.
struct CameraState {
  std::array<std::optional<double>, k_state_keys> values{};
  std::string pixel_format{};  ///< the device's own word; empty: not told

  [[nodiscard]] std::optional<double>& operator[](StateKey key) {
    return values[static_cast<std::size_t>(key)];
  }
  [[nodiscard]] const std::optional<double>& operator[](StateKey key) const {
    return values[static_cast<std::size_t>(key)];
  }
  [[nodiscard]] bool told() const;
  [[nodiscard]] bool operator==(const CameraState&) const = default;
};

/// Neither mirrored nor turned, no binning, no pixels skipped: what pictures of a new calibration are taken
/// in.
[[nodiscard]] CameraState plain_state();

/// What the camera tells now over what was known of it.
[[nodiscard]] CameraState put_over(const CameraState& known, const CameraState& told);

/// The same value, but for what a device rounds.
[[nodiscard]] bool same_value(double a, double b);

/// What of `seen` is not as calibrated, a sentence each: "the camera mirrors left to right (ReverseX, HFLIP),
/// the calibration was made without".  What the camera does not tell differs from nothing.
[[nodiscard]] std::vector<std::string> differences(const CameraState& calibrated, const CameraState& seen);

/// Errc::Refused with the first of the differences; the others are counted.
[[nodiscard]] Result<void> expect_state(const CameraState& calibrated, const CameraState& seen);

/// The same of two states of which neither is the right one: "binning_x 2 against 1".
[[nodiscard]] std::vector<std::string> contradictions(const CameraState& one, const CameraState& other);

}  // namespace biteline::geometry
