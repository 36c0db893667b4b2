// SPDX-License-Identifier: MIT
#pragma once
/// \file Profiles as the lines of a GigE Vision frame.

#include <cstdint>
#include <vector>

#include "common/profile/profile.hpp"

namespace biteline::gige {

/// Numbers of the standard's pixel formats (PFNC).
enum class Format : std::uint32_t {
  Mono8 = 0x0108'0001,   ///< the camera's picture, as raw as one message holds it
  C16 = 0x0110'00b8,     ///< Coord3D_C16: z of each column, scaled, 16 bits
  Ac16 = 0x0220'00bb,    ///< Coord3D_AC16: x and z of each column, scaled, 16 bits each
  Abc32f = 0x0260'00c0,  ///< Coord3D_ABC32f: x, y, z of each column, mm, floats
};

/// How a number of 16 bits is told: mm = offset + scale * value.
struct Scale {
  float scale_mm{0.01F};
  float offset_mm{0};
};
/// How z of C16 and AC16 is told, and x of AC16.
struct Depth {
  float scale_mm{0.01F};
  float offset_mm{0};
  Scale across{};

  [[nodiscard]] Scale away() const { return {.scale_mm = scale_mm, .offset_mm = offset_mm}; }
};

/// What C16 and AC16 have where there is no surface, or one beyond what it can tell.
inline constexpr std::uint16_t k_no_depth = 65535;

/// Chunk with one record for each line of a frame; and the tag of the picture before it.
inline constexpr std::uint32_t k_lines_chunk = 0x4c4e'0001, k_picture_chunk = 0x4c4e'0000;
/// A record, big-endian: stamp in ns, scan, sequence (64 bits each), flags and validity (32 bits each), then
/// T_base_flange as twelve 64-bit floats: rotation row by row, translation in mm.  Then the exposure in us as
/// a 64-bit float, and the camera's own count (64 bits).  Then the encoder's count (64 bits, signed), whether
/// there is one, and a zero (32 bits each).
inline constexpr std::size_t k_line_record_bytes = 160;
inline constexpr std::size_t k_chunk_tag_bytes = 8;

[[nodiscard]] std::size_t line_bytes(Format format, std::size_t columns);

/// A profile in the camera's frame as one line, little-endian.  Of several points of a column the brightest
/// that is surface stands; points flagged as no surface are left out.
[[nodiscard]] std::vector<std::uint8_t> line_of(Format format, std::size_t columns, const Depth& depth,
                                                const profile::Profile& profile);
/// A line without any surface.
[[nodiscard]] std::vector<std::uint8_t> empty_line(Format format, std::size_t columns);

/// Of one line; all zeros, invalid, where a frame was filled up.  `exposure`: 0: not known.
[[nodiscard]] std::vector<std::uint8_t> line_record(std::uint64_t scan, const profile::ProfileHeader& header,
                                                    Nanoseconds exposure);

}  // namespace biteline::gige
