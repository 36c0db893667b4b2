// SPDX-License-Identifier: MIT
#pragma once
/// \file What every LineCamera must do.

#include <CppUTest/TestHarness.h>

#include "hal/api/line_camera.hpp"

namespace biteline::conformance {

using namespace std::chrono_literals;

struct CameraCase {
  hal::CameraSettings settings;  ///< that the device can take, free-running
  Nanoseconds frame_within{5s};
  std::uint64_t frames{20};
};

inline void check_camera(hal::LineCamera& sut, const CameraCase& wanted) {
  const hal::CameraLimits limits = sut.limits().value();
  CHECK(limits.sensor_width_px > 0 && limits.sensor_height_px > 0);

  // Open: nothing runs.
  CHECK(sut.start().error().code == Errc::WrongState);
  CHECK(sut.next_frame(0ns).error().code == Errc::WrongState);
  CHECK(sut.stop().has_value());
  hal::CameraSettings beyond = wanted.settings;
  beyond.region.width_px = limits.sensor_width_px + 16;
  CHECK(sut.configure(beyond).error().code == Errc::BadValue);

  for (int round = 0; round < 2; ++round) {
    const Result<hal::CameraSettings> taken = sut.configure(wanted.settings);
    CHECK(taken.has_value());
    CHECK(sut.adjust_exposure(1ms).error().code == Errc::WrongState);
    CHECK(sut.start().has_value());
    CHECK(sut.start().error().code == Errc::WrongState);
    CHECK(sut.configure(wanted.settings).error().code == Errc::WrongState);

    std::optional<std::uint64_t> last_sequence;
    SensorClock::time_point last_stamp;
    std::uint64_t gaps = 0;
    for (std::uint64_t i = 0; i < wanted.frames; ++i) {
      const Result<hal::FrameView> frame = sut.next_frame(wanted.frame_within);
      CHECK(frame.has_value());
      CHECK_EQUAL(taken->region.width_px, frame->width_px);
      CHECK_EQUAL(taken->region.height_px, frame->height_px);
      CHECK_EQUAL(frame->stride_bytes * static_cast<std::size_t>(frame->height_px), frame->pixels.size());
      CHECK(frame->exposure_mid > last_stamp);
      if (last_sequence) {
        CHECK(frame->sequence > *last_sequence);
        gaps += frame->sequence - *last_sequence - 1;
        CHECK_EQUAL(frame->sequence != *last_sequence + 1, (frame->flags & hal::k_frame_gap_before) != 0);
      }
      last_sequence = frame->sequence;
      last_stamp = frame->exposure_mid;
      sut.release(*frame);
    }
    const hal::CameraHealth health = sut.health();
    CHECK_EQUAL(wanted.frames, health.frames + health.frames_damaged);
    CHECK(health.frames_lost >= gaps);  // and what was lost before the first one
    CHECK(health.connected);
    CHECK(sut.stop().has_value());
    CHECK(sut.next_frame(0ns).error().code == Errc::WrongState);
  }
}

/// What the camera does to its picture: read, set back to what was read, and never told while it runs.
inline void check_camera_state(hal::LineCamera& sut, const hal::CameraSettings& settings) {
  const Result<geometry::CameraState> first = sut.state();
  CHECK(first.has_value());
  const Result<geometry::CameraState> again = sut.set_state(*first);
  CHECK(again.has_value());
  CHECK(geometry::contradictions(*first, *again).empty());
  // Nothing told: nothing changes.
  CHECK(geometry::contradictions(*first, *sut.set_state({})).empty());
  CHECK(geometry::differences(geometry::plain_state(), *sut.set_state(geometry::plain_state())).empty());
  CHECK(sut.configure(settings).has_value());
  CHECK(sut.start().has_value());
  CHECK(sut.set_state(geometry::plain_state()).error().code == Errc::WrongState);
  const Result<geometry::CameraState> running = sut.state();
  CHECK(running.has_value());
  CHECK(geometry::differences(geometry::plain_state(), *running).empty());
  CHECK(sut.stop().has_value());
}

/// All buffers lent: the camera must wait or lose, and say so, and go on when they come back.
inline void check_camera_starved(hal::LineCamera& sut, const CameraCase& wanted) {
  CHECK(sut.configure(wanted.settings).has_value());
  CHECK(sut.start().has_value());
  std::vector<hal::FrameView> held;
  while (true) {
    const Result<hal::FrameView> frame =
        sut.next_frame(held.empty() ? wanted.frame_within : Nanoseconds{500ms});
    if (!frame) {
      CHECK(frame.error().code == Errc::Timeout);
      break;
    }
    held.push_back(*frame);
    CHECK(held.size() < 100);
  }
  CHECK(!held.empty());
  for (const hal::FrameView& frame : held) sut.release(frame);
  for (int i = 0; i < 3; ++i) {
    const Result<hal::FrameView> frame = sut.next_frame(wanted.frame_within);
    CHECK(frame.has_value());
    sut.release(*frame);
  }
  CHECK(sut.health().underruns + sut.health().frames_lost > 0);
  CHECK(sut.stop().has_value());
}

}  // namespace biteline::conformance
