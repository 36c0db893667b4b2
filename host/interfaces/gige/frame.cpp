// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/frame.hpp"

#include <bit>
#include <cmath>
#include <limits>

#include "common/gige/packets.hpp"

namespace biteline::gige {
namespace {

void put_little(std::vector<std::uint8_t>& line, std::size_t at, std::uint32_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) line[at + i] = static_cast<std::uint8_t>(value >> (8 * i) & 0xffU);
}

void put_long(std::vector<std::uint8_t>& record, std::size_t at, std::uint64_t value) {
  put_word(record, at, static_cast<std::uint32_t>(value >> 32U));
  put_word(record, at + 4, static_cast<std::uint32_t>(value & 0xffff'ffffU));
}

std::uint16_t value_of(const Scale& scale, float mm) {
  const double value = std::round((static_cast<double>(mm) - scale.offset_mm) / scale.scale_mm);
  return value >= 0 && value < k_no_depth ? static_cast<std::uint16_t>(value) : k_no_depth;
}

void put_point(Format format, const Depth& depth, const Eigen::Vector3f& point,
               std::vector<std::uint8_t>& line, std::size_t column) {
  if (format == Format::C16) return put_little(line, 2 * column, value_of(depth.away(), point.z()), 2);
  if (format == Format::Ac16) {
    const std::uint16_t x = value_of(depth.across, point.x()), z = value_of(depth.away(), point.z());
    // Half a point is none.
    const bool there = x != k_no_depth && z != k_no_depth;
    put_little(line, 4 * column, there ? x : k_no_depth, 2);
    return put_little(line, 4 * column + 2, there ? z : k_no_depth, 2);
  }
  for (int axis = 0; axis < 3; ++axis)
    put_little(line, 12 * column + 4 * static_cast<std::size_t>(axis),
               std::bit_cast<std::uint32_t>(point[axis]), 4);
}

}  // namespace

std::size_t line_bytes(Format format, std::size_t columns) {
  switch (format) {
    case Format::Mono8:
      return columns;
    case Format::C16:
      return 2 * columns;
    case Format::Ac16:
      return 4 * columns;
    case Format::Abc32f:
      break;
  }
  return 12 * columns;
}

std::vector<std::uint8_t> empty_line(Format format, std::size_t columns) {
  std::vector<std::uint8_t> line(line_bytes(format, columns), 0xff);
  if (format != Format::Abc32f) return line;
  const auto nothing = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::quiet_NaN());
  for (std::size_t at = 0; at < line.size(); at += 4) put_little(line, at, nothing, 4);
  return line;
}

std::vector<std::uint8_t> line_of(Format format, std::size_t columns, const Depth& depth,
                                  const profile::Profile& profile) {
  std::vector<std::uint8_t> line = empty_line(format, columns);
  const profile::ProfilePoint* best = nullptr;
  for (const profile::ProfilePoint& point : profile.points) {
    if ((point.flags & profile::k_point_not_surface) != 0 || point.column >= columns) continue;
    // Points come by column.
    if (best != nullptr && best->column == point.column && best->amplitude >= point.amplitude) continue;
    best = &point;
    put_point(format, depth, point.point_cam, line, point.column);
  }
  return line;
}

std::vector<std::uint8_t> line_record(std::uint64_t scan, const profile::ProfileHeader& header,
                                      Nanoseconds exposure) {
  std::vector<std::uint8_t> record(k_line_record_bytes);
  put_long(record, 0, static_cast<std::uint64_t>(header.exposure_mid.time_since_epoch().count()));
  put_long(record, 8, scan);
  put_long(record, 16, header.sequence);
  put_word(record, 24, header.flags);
  put_word(record, 28, 1);
  const auto& flange = header.T_base_flange;
  for (int i = 0; i < 12; ++i) {
    const double number = i < 9 ? flange.linear()(i / 3, i % 3) : flange.translation()[i - 9];
    put_long(record, 32 + 8 * static_cast<std::size_t>(i), std::bit_cast<std::uint64_t>(number));
  }
  const double exposure_us = 1e-3 * static_cast<double>(exposure.count());
  put_long(record, 128, std::bit_cast<std::uint64_t>(exposure_us));
  put_long(record, 136, header.frame_sequence);
  put_long(record, 144, static_cast<std::uint64_t>(header.encoder_ticks.value_or(0)));
  put_word(record, 152, header.encoder_ticks ? 1 : 0);
  return record;
}

}  // namespace biteline::gige
