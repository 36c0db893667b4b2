// SPDX-License-Identifier: MIT
#pragma once
/// \file Rows of a session's tables as JSON messages, and back, with every digit.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "common/core/result.hpp"

namespace biteline::recording {

/// One row of pose0/data.csv, and of pose0/encoder.csv where there is one.
struct PoseRow {
  std::int64_t stamp_ns{0};        ///< robot clock
  std::array<double, 7> values{};  ///< p_x p_y p_z [mm], q_w q_x q_y q_z
  std::optional<std::int64_t> encoder_ticks{};
};
[[nodiscard]] std::string message_of(const PoseRow& row);
[[nodiscard]] Result<PoseRow> pose_row_of(std::span<const std::uint8_t> message);
/// Of pose0/data.csv, with its line's end.
[[nodiscard]] std::string table_row(const PoseRow& row);

/// One row of cam0/data.csv, and of cam0/frames.csv where there is one.
struct FrameRow {
  struct Facts {
    std::uint64_t sequence{0};
    std::uint32_t flags{0};
    int first_row_px{0};
    int rows_px{0};
  };
  std::int64_t stamp_ns{0};  ///< camera's clock, middle of the exposure
  std::string file;          ///< a plain name
  std::optional<Facts> facts;
};
[[nodiscard]] std::string message_of(const FrameRow& row);
/// Refuses a name that could lead out of the session.
[[nodiscard]] Result<FrameRow> frame_row_of(std::span<const std::uint8_t> message);

inline constexpr const char* k_pose_schema = R"({
  "title": "biteline.Pose", "type": "object", "description": "T_base_flange",
  "properties": {
    "stamp_ns": {"type": "integer", "description": "the robot's clock"},
    "p_mm": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
    "q_wxyz": {"type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4},
    "encoder_ticks": {"type": "integer", "description": "where an encoder is the pose"}
  },
  "required": ["stamp_ns", "p_mm", "q_wxyz"]
})";
inline constexpr const char* k_frame_schema = R"({
  "title": "biteline.Frame", "type": "object", "description": "belongs to the picture that follows",
  "properties": {
    "stamp_ns": {"type": "integer", "description": "middle of the exposure, the camera's clock"},
    "file": {"type": "string"},
    "sequence": {"type": "integer", "description": "the camera's own count"},
    "flags": {"type": "integer"},
    "first_row_px": {"type": "integer", "description": "of the head's region"},
    "rows_px": {"type": "integer"}
  },
  "required": ["stamp_ns", "file"]
})";
inline constexpr const char* k_event_schema = R"({
  "title": "biteline.Event", "type": "object",
  "properties": {"event": {"enum": ["begin", "end"]}},
  "required": ["event"]
})";

}  // namespace biteline::recording
