// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"

#include <algorithm>

namespace biteline::sensor {
namespace {

/// Of an address on the board: simulated wires have their own backend, whatever hangs on them.
std::string_view backend_of(const std::string& address, std::string_view usual) {
  return address.starts_with(hal::k_simulated_wires) ? "sim" : usual;
}

template <class Open, class... Arguments>
auto open_by(std::string_view name, Open Backend::*open, const Arguments&... arguments)
    -> decltype((std::declval<const Backend&>().*open)(arguments...)) {
  const auto backends = built_backends();
  const auto found = std::ranges::find_if(
      backends, [&](const Backend* backend) { return backend->name == name && backend->*open != nullptr; });
  if (found != backends.end()) return ((*found)->*open)(arguments...);
  return fail(Errc::NotSupported, "this biteline-sensor was built without %.*s",
              static_cast<int>(name.size()), name.data());
}

}  // namespace

Result<std::unique_ptr<hal::LineCamera>> open_camera(const hal::Board& board, bool realtime) {
  const bool v4l2 = board.camera.kind == hal::BoardCamera::Kind::V4l2;
  return open_by(v4l2 ? "v4l2" : "aravis", &Backend::camera, board, realtime);
}

Result<std::unique_ptr<hal::GpioOut>> open_output(const hal::GpioLineAddress& line) {
  return open_by(backend_of(line.chip, "gpio"), &Backend::output, line);
}

Result<std::unique_ptr<hal::EdgeIn>> open_edges(const hal::GpioLineAddress& line) {
  return open_by(backend_of(line.chip, "gpio"), &Backend::edges, line);
}

Result<std::unique_ptr<hal::SafetyIn>> open_safety(const hal::BoardLaser& laser) {
  return open_by(backend_of(laser.interlock.chip, "gpio"), &Backend::safety, laser);
}

Result<std::unique_ptr<hal::PwmOut>> open_timer(const hal::BoardTrigger& trigger) {
  return open_by(backend_of(trigger.chip, "pwm"), &Backend::timer, trigger);
}

Result<std::unique_ptr<hal::CanBus>> open_can_bus(const std::string& interface) {
  return open_by(backend_of(interface, "socketcan"), &Backend::can_bus, interface);
}

Result<std::unique_ptr<hal::PoseSource>> open_poses(const hal::BoardPoses& poses, const hal::Clock& clock) {
  using enum hal::BoardPoses::Kind;
  const bool heard = poses.kind == Egm || poses.kind == Rsi;
  return open_by(poses.kind == Rtde      ? "rtde"
                 : poses.kind == ArmLink ? "arm_link_poses"
                 : heard                 ? "udp_poses"
                                         : "socketcan",
                 &Backend::poses, poses, clock);
}

Result<std::unique_ptr<hal::EncoderIn>> open_encoder(const hal::BoardEncoder& encoder) {
  return open_by("socketcan", &Backend::encoder, encoder);
}

}  // namespace biteline::sensor
