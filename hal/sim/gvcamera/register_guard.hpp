// SPDX-License-Identifier: MIT
#pragma once
/// \file What the simulated camera lets a client read and write; all else is refused in the standard's words.
///
/// Aravis 0.8.26's fake camera takes every address and every value: one register read beyond its description
/// ends the process.  One application's stream goes on when its heartbeat is missed, and to its address even
/// when another one has taken control.  Its server calls its registers through the dynamic linker, so that
/// the functions of the same names in register_guard.cpp come first, look, and pass on what is good.

#include <cstdint>

#include "common/gige/control_channel.hpp"

namespace biteline::sim {

struct GvRange {
  std::uint32_t address{0};
  std::uint32_t bytes{0};
};

/// `description_bytes`: of the GenICam description, which stands behind the registers.
[[nodiscard]] gige::Status may_read(const GvRange& range, std::uint32_t description_bytes);

/// What bounds a write besides the table of registers.
struct GvGeometry {
  std::uint32_t sensor_width{0}, sensor_height{0};  ///< binned
  std::uint32_t width{0}, height{0}, offset_x{0}, offset_y{0};
  bool state_locked{false};
};
/// A client's write of one register.
[[nodiscard]] gige::Status may_write(std::uint32_t address, std::uint32_t value, const GvGeometry& now);

/// While one lives, this thread is the camera itself: it writes what no client may.  Thread: of its own.
class OwnAccess {
 public:
  OwnAccess();
  ~OwnAccess();
  OwnAccess(const OwnAccess&) = delete;
  OwnAccess& operator=(const OwnAccess&) = delete;
};

}  // namespace biteline::sim
