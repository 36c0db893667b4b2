// SPDX-License-Identifier: MIT
#pragma once
/// \file Which camera, pose source, lines and timers this program was built with, and how each is opened.

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/core/result.hpp"
#include "hal/api/can_bus.hpp"
#include "hal/api/clock.hpp"
#include "hal/api/edge_in.hpp"
#include "hal/api/encoder_in.hpp"
#include "hal/api/gpio_out.hpp"
#include "hal/api/line_camera.hpp"
#include "hal/api/pose_source.hpp"
#include "hal/api/pwm_out.hpp"
#include "hal/api/safety_in.hpp"
#include "hal/board/board.hpp"

namespace biteline::sensor {

/// What one backend can open; null: it has nothing of that sort.
struct Backend {
  std::string_view name;
  Result<std::unique_ptr<hal::LineCamera>> (*camera)(const hal::Board&, bool realtime){nullptr};
  Result<std::unique_ptr<hal::GpioOut>> (*output)(const hal::GpioLineAddress&){nullptr};
  Result<std::unique_ptr<hal::EdgeIn>> (*edges)(const hal::GpioLineAddress&){nullptr};
  Result<std::unique_ptr<hal::SafetyIn>> (*safety)(const hal::BoardLaser&){nullptr};
  Result<std::unique_ptr<hal::PwmOut>> (*timer)(const hal::BoardTrigger&){nullptr};
  Result<std::unique_ptr<hal::CanBus>> (*can_bus)(const std::string& interface){nullptr};
  Result<std::unique_ptr<hal::PoseSource>> (*poses)(const hal::BoardPoses&, const hal::Clock&){nullptr};
  Result<std::unique_ptr<hal::EncoderIn>> (*encoder)(const hal::BoardEncoder&){nullptr};
};

/// Those of this build, from CMake's list (CMakeLists.txt beside).
[[nodiscard]] std::span<const Backend* const> built_backends();

// What a board names, opened by the backend that it means.  Errc::NotSupported where this program was built
// without it.
[[nodiscard]] Result<std::unique_ptr<hal::LineCamera>> open_camera(const hal::Board& board, bool realtime);
[[nodiscard]] Result<std::unique_ptr<hal::GpioOut>> open_output(const hal::GpioLineAddress& line);
[[nodiscard]] Result<std::unique_ptr<hal::EdgeIn>> open_edges(const hal::GpioLineAddress& line);
[[nodiscard]] Result<std::unique_ptr<hal::SafetyIn>> open_safety(const hal::BoardLaser& laser);
[[nodiscard]] Result<std::unique_ptr<hal::PwmOut>> open_timer(const hal::BoardTrigger& trigger);
[[nodiscard]] Result<std::unique_ptr<hal::CanBus>> open_can_bus(const std::string& interface);
[[nodiscard]] Result<std::unique_ptr<hal::PoseSource>> open_poses(const hal::BoardPoses& poses,
                                                                  const hal::Clock& clock);
[[nodiscard]] Result<std::unique_ptr<hal::EncoderIn>> open_encoder(const hal::BoardEncoder& encoder);

}  // namespace biteline::sensor
