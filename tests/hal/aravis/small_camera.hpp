// SPDX-License-Identifier: MIT
#pragma once
/// \file A simulated camera for a test of the Aravis backend: small pictures that tell their own number.

#include <chrono>
#include <cstring>
#include <memory>
#include <span>
#include <thread>

#include "hal/linux/aravis/aravis_camera.hpp"
#include "hal/sim/gvcamera/gv_camera.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::hal {

using sim::GvCamera;
using sim::GvExposure;

inline constexpr Nanoseconds k_second{1'000'000'000};

inline SensorClock::time_point now() {
  return SensorClock::time_point{
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}

/// Every picture tells its own number, size and place, so that a mix-up shows.
inline void paint_number(const GvExposure& exposure, std::span<std::uint8_t> pixels) {
  std::memset(pixels.data(), static_cast<int>(exposure.sequence % 251), pixels.size());
  pixels[1] = static_cast<std::uint8_t>(exposure.region.offset_v_px % 256);
  pixels[pixels.size() - 1] = 77;
}

/// The standard fixes the port, so one camera at a time lives on an address; another test may just be using
/// it.
inline std::unique_ptr<GvCamera> open_server(const GvCamera::Config& config,
                                             GvCamera::Painter painter = paint_number) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    if (auto camera = GvCamera::open(config, painter)) {
      test::note_ran();
      return std::move(*camera);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{100});  // until the other test gives the port back
  }
  test::note_skipped("GigE Vision port 3956 on 127.0.0.1 is not free");
  return nullptr;
}

inline GvCamera::Config small_camera() {
  GvCamera::Config config;
  config.region = {.offset_u_px = 0, .offset_v_px = 456, .width_px = 640, .height_px = 120};
  return config;
}

inline CameraSettings settings(double rate_hz) {
  return {.region = {.offset_u_px = 16, .offset_v_px = 100, .width_px = 640, .height_px = 120},
          .exposure = Nanoseconds{500'000},
          .rate_hz = rate_hz};
}

#define SERVER_OR_SKIP(name, ...)             \
  const auto name = open_server(__VA_ARGS__); \
  if (!name) return

}  // namespace biteline::hal
