// SPDX-License-Identifier: MIT
#include "host/calibration/head/camera_state.hpp"

#include <array>
#include <string>

#include "common/config/camera_state_yaml.hpp"
#include "common/config/sensor_yaml.hpp"

namespace biteline::calibration {
namespace {

namespace fs = std::filesystem;

constexpr std::array k_parts{"camera", "laser", "handeye"};

tl::unexpected<Error> contradiction(const std::string& one, const std::string& other,
                                    const std::vector<std::string>& lines) {
  tl::unexpected<Error> refused =
      fail(Errc::Refused,
           "the pictures were taken in two states of the camera: %s (%s against %s); take the ones again",
           lines.front().c_str(), one.c_str(), other.c_str());
  refused.value().more_faults = static_cast<int>(lines.size()) - 1;
  return refused;
}

}  // namespace

Result<geometry::CameraState> read_folder_state(const fs::path& calib) {
  geometry::CameraState known;
  std::string known_of;
  for (const char* part : k_parts) {
    const fs::path file = calib / part / config::k_camera_state_file;
    std::error_code error;
    if (!fs::exists(file, error)) continue;
    BITELINE_ASSIGN(const geometry::CameraState state, config::read_camera_state(file));
    const auto lines = geometry::contradictions(known, state);
    if (!lines.empty()) return contradiction(known_of, part, lines);
    known = geometry::put_over(known, state);
    known_of += (known_of.empty() ? "" : ", ") + std::string{part};
  }
  return known;
}

Result<void> expect_scan_state(const fs::path& session, const geometry::CameraState& pictures) {
  // What cannot be read is told by who works on the scan.
  const auto head = config::read_sensor_yaml(session / "cam0/sensor.yaml");
  if (!head) return {};
  const auto lines = geometry::contradictions(pictures, head->camera_state);
  if (!lines.empty()) return contradiction("the pictures", session.filename().string(), lines);
  return {};
}

Result<void> expect_folder_state(const fs::path& calib, const geometry::CameraState& now) {
  BITELINE_ASSIGN(const geometry::CameraState before, read_folder_state(calib));
  const auto lines = geometry::contradictions(before, now);
  if (!lines.empty()) return contradiction("those there", "the camera now", lines);
  return {};
}

}  // namespace biteline::calibration
