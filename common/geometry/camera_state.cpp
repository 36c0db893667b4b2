// SPDX-License-Identifier: MIT
#include "common/geometry/camera_state.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace biteline::geometry {
namespace {

/// No camera bins or skips more, no sensor is larger (as in sensor.yaml).
constexpr NumberRange k_switch{0, 1}, k_turn{0, 359}, k_factor{1, 64}, k_size{1, 16384}, k_any{-1e9, 1e9};

constexpr std::array<StateRow, k_state_keys> k_rows{{
    {StateKey::MirrorX, "mirror_x", "mirrors left to right (ReverseX, HFLIP)", true, 0, k_switch},
    {StateKey::MirrorY, "mirror_y", "mirrors top to bottom (ReverseY, VFLIP)", true, 0, k_switch},
    {StateKey::Turn, "turn_deg", "turn in degrees", false, 0, k_turn},
    {StateKey::BinningX, "binning_x", "binning along the rows", false, 1, k_factor},
    {StateKey::BinningY, "binning_y", "binning along the columns", false, 1, k_factor},
    {StateKey::DecimationX, "decimation_x", "decimation along the rows", false, 1, k_factor},
    {StateKey::DecimationY, "decimation_y", "decimation along the columns", false, 1, k_factor},
    {StateKey::SensorWidth, "sensor_width_px", "full width in pixels", false, {}, k_size},
    {StateKey::SensorHeight, "sensor_height_px", "full height in pixels", false, {}, k_size},
    {StateKey::BlackLevel, "black_level", "black level", false, {}, k_any},
    {StateKey::Zoom, "zoom", "zoom", false, {}, k_any},
    {StateKey::Pan, "pan", "pan", false, {}, k_any},
    {StateKey::Tilt, "tilt", "tilt", false, {}, k_any},
    {StateKey::Focus, "focus", "focus", false, {}, k_any},
    {StateKey::Aperture, "aperture", "aperture", false, {}, k_any},
}};

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

}  // namespace

std::span<const StateRow> state_table() {
  return k_rows;
}

bool CameraState::told() const {
  return !pixel_format.empty() ||
         std::ranges::any_of(values, [](const std::optional<double>& value) { return value.has_value(); });
}

CameraState plain_state() {
  CameraState state;
  for (const StateRow& row : k_rows) state[row.key] = row.usual;
  return state;
}

CameraState put_over(const CameraState& known, const CameraState& told) {
  CameraState state = known;
  for (std::size_t i = 0; i < k_state_keys; ++i)
    if (told.values[i]) state.values[i] = told.values[i];
  if (!told.pixel_format.empty()) state.pixel_format = told.pixel_format;
  return state;
}

bool same_value(double a, double b) {
  constexpr double k_rounded_ratio = 1e-6;  // single precision; a size of one pixel more is another size
  return std::abs(a - b) <= k_rounded_ratio * std::max(std::abs(a), std::abs(b));
}

std::vector<std::string> differences(const CameraState& calibrated, const CameraState& seen) {
  std::vector<std::string> out;
  for (const StateRow& row : k_rows) {
    const std::optional<double>& now = seen[row.key];
    const bool was_told = calibrated[row.key].has_value();
    const std::optional<double> before = was_told ? calibrated[row.key] : row.usual;
    if (!now || !before || same_value(*now, *before)) continue;
    std::string line{"the camera"};
    if (row.is_switch) {
      line += std::string{*now != 0 ? " " : " no longer "} + row.words + ", the calibration ";
      line += was_told ? (*before != 0 ? "was made with that" : "was made without")
                       : std::string{"does not tell of it (camera_state, "} + row.name + ")";
    } else {
      line += std::string{"'s "} + row.words + " is " + number(*now) + ", the calibration ";
      line += was_told ? "was made with " + number(*before)
                       : std::string{"does not tell of it (camera_state, "} + row.name + "), which means " +
                             number(*before);
    }
    out.push_back(line);
  }
  if (!seen.pixel_format.empty() && !calibrated.pixel_format.empty() &&
      seen.pixel_format != calibrated.pixel_format) {
    out.push_back("the camera's pixel format is " + seen.pixel_format + ", the calibration was made with " +
                  calibrated.pixel_format);
  }
  return out;
}

Result<void> expect_state(const CameraState& calibrated, const CameraState& seen) {
  const std::vector<std::string> lines = differences(calibrated, seen);
  if (lines.empty()) return {};
  tl::unexpected<Error> refused = fail(Errc::Refused, "%s", lines.front().c_str());
  refused.value().more_faults = static_cast<int>(lines.size()) - 1;
  return refused;
}

std::vector<std::string> contradictions(const CameraState& one, const CameraState& other) {
  std::vector<std::string> out;
  for (const StateRow& row : k_rows) {
    const std::optional<double>&a = one[row.key], &b = other[row.key];
    if (a && b && !same_value(*a, *b))
      out.push_back(std::string{row.name} + " " + number(*a) + " against " + number(*b));
  }
  if (!one.pixel_format.empty() && !other.pixel_format.empty() && one.pixel_format != other.pixel_format)
    out.push_back("pixel_format " + one.pixel_format + " against " + other.pixel_format);
  return out;
}

}  // namespace biteline::geometry
