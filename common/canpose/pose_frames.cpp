// SPDX-License-Identifier: MIT
#include "common/canpose/pose_frames.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/plain_number.hpp"

namespace biteline::canpose {
namespace {

constexpr double k_position_step_mm = 1e-4;              // 0.1 um; int32 reaches 214 m
constexpr double k_rotation_step_rad = 1.0 / (1 << 21);  // 0.48 urad; int24 reaches +-4 rad, and pi is needed
constexpr double k_quaternion_step = 1.0 / (1 << 30);
// Four components rounded to their step are off the unit length by no more than this; what is further was
// never a rotation.
constexpr double k_unit_length_tolerance = 1e-6;
// 142 years: a sender's clock beyond it does not fit nanoseconds in 63 bits twice over.
constexpr std::uint64_t k_stamp_last_us = std::uint64_t{1} << 52U;

// Little endian, as CANopen has it.
void put(std::span<std::uint8_t> field, std::uint64_t value) {
  for (std::uint8_t& byte : field) {
    byte = static_cast<std::uint8_t>(value);
    value >>= 8U;
  }
}

std::uint64_t get(std::span<const std::uint8_t> field) {
  std::uint64_t value = 0;
  for (std::size_t i = field.size(); i-- > 0;) value = (value << 8U) | field[i];
  return value;
}

std::int32_t get_signed(std::span<const std::uint8_t> field) {
  const unsigned unused_bits = 32U - 8U * static_cast<unsigned>(field.size());
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(get(field)) << unused_bits) >> unused_bits;
}

constexpr std::size_t k_translation_bytes = 12;
constexpr std::size_t k_rotation_vector_bytes = 9;
constexpr std::size_t k_chunk_bytes = 7;  // of the pose in each of the first three frames, behind the counter
using PoseBlock = std::array<std::uint8_t, k_translation_bytes + k_rotation_vector_bytes>;
static_assert(std::tuple_size_v<PoseBlock> == 3 * k_chunk_bytes);

Result<void> put_translation(std::span<std::uint8_t, k_translation_bytes> field, const Vec3& p_base) {
  for (int axis = 0; axis < 3; ++axis) {
    const double steps = p_base[axis] / k_position_step_mm;
    if (!(std::abs(steps) < 2147483647.0)) {
      return fail(Errc::BadValue, "CAN pose: axis %d at %s mm is beyond what the frame holds", axis,
                  plain_number(p_base[axis]).c_str());
    }
    put(field.subspan(4 * static_cast<std::size_t>(axis), 4),
        static_cast<std::uint64_t>(std::llround(steps)));
  }
  return {};
}

Vec3 get_translation(std::span<const std::uint8_t, k_translation_bytes> field) {
  Vec3 p_base;
  for (int axis = 0; axis < 3; ++axis) {
    p_base[axis] = get_signed(field.subspan(4 * static_cast<std::size_t>(axis), 4)) * k_position_step_mm;
  }
  return p_base;
}

/// What the check sum of the classic form covers, in this order.
std::uint16_t classic_crc(const ClassicFrames& frames, const PoseBlock& block) {
  std::array<std::uint8_t, 6 + std::tuple_size_v<PoseBlock>> covered{};
  std::copy_n(frames[3].begin(), 6, covered.begin());
  std::copy(block.begin(), block.end(), covered.begin() + 6);
  return crc16(covered);
}

bool is_counter(std::uint8_t counter) {
  return counter >= 1 && counter <= k_sync_counter_last;
}

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte) << 8U;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000U) != 0 ? (crc << 1U) ^ 0x1021U : crc << 1U;
  }
  return static_cast<std::uint16_t>(crc);
}

Result<ClassicFrames> encode_classic(const PoseMessage& pose) {
  PoseBlock block{};
  BITELINE_TRY(
      put_translation(std::span{block}.first<k_translation_bytes>(), pose.T_base_flange.translation()));
  const Vec3 rotation_rad = geometry::log_so3(pose.T_base_flange.linear());
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t at = k_translation_bytes + 3 * static_cast<std::size_t>(axis);
    put(std::span{block}.subspan(at, 3),
        static_cast<std::uint64_t>(std::llround(rotation_rad[axis] / k_rotation_step_rad)));
  }

  ClassicFrames frames{};
  for (std::size_t i = 0; i < 3; ++i) {
    frames[i][0] = pose.sync_counter;
    std::copy_n(block.begin() + static_cast<std::ptrdiff_t>(i * k_chunk_bytes), k_chunk_bytes,
                frames[i].begin() + 1);
  }
  ClassicData& last = frames[3];
  last[0] = pose.sync_counter;
  last[1] = pose.status;
  put(std::span{last}.subspan(2, 4), pose.stamp_us);
  put(std::span{last}.subspan(6, 2), classic_crc(frames, block));
  return frames;
}

Result<PoseMessage> decode_classic(const ClassicFrames& frames) {
  const std::uint8_t counter = frames[3][0];
  PoseBlock block{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (frames[i][0] != counter) return fail(Errc::ProtocolError, "CAN pose: frames of two poses");
    std::copy_n(frames[i].begin() + 1, k_chunk_bytes,
                block.begin() + static_cast<std::ptrdiff_t>(i * k_chunk_bytes));
  }
  if (get(std::span{frames[3]}.subspan(6, 2)) != classic_crc(frames, block)) {
    return fail(Errc::ProtocolError, "CAN pose %d: wrong check sum", int{counter});
  }
  if (!is_counter(counter)) return fail(Errc::ProtocolError, "CAN pose: SYNC counter %d", int{counter});

  PoseMessage pose{
      .sync_counter = counter, .status = frames[3][1], .stamp_us = get(std::span{frames[3]}.subspan(2, 4))};
  Vec3 rotation_rad;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t at = k_translation_bytes + 3 * static_cast<std::size_t>(axis);
    rotation_rad[axis] =
        get_signed(std::span<const std::uint8_t>{block}.subspan(at, 3)) * k_rotation_step_rad;
  }
  pose.T_base_flange.linear() = geometry::exp_so3(rotation_rad);
  pose.T_base_flange.translation() =
      get_translation(std::span<const std::uint8_t>{block}.first<k_translation_bytes>());
  return pose;
}

// Layout: version 0, counter 1, status 2, zero 3, stamp 4..11, translation 12..23, quaternion w x y z 24..39,
// zeros 40..45, check sum 46..47.
Result<FdFrame> encode_fd(const PoseMessage& pose) {
  FdFrame frame{};
  frame[0] = k_fd_layout_version;
  frame[1] = pose.sync_counter;
  frame[2] = pose.status;
  put(std::span{frame}.subspan(4, 8), pose.stamp_us);
  BITELINE_TRY(
      put_translation(std::span{frame}.subspan<12, k_translation_bytes>(), pose.T_base_flange.translation()));
  const Eigen::Quaterniond rotation{pose.T_base_flange.linear()};
  const std::array parts{rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    put(std::span{frame}.subspan(24 + 4 * i, 4),
        static_cast<std::uint64_t>(std::llround(parts[i] / k_quaternion_step)));
  }
  put(std::span{frame}.subspan(46, 2), crc16(std::span{frame}.first(46)));
  return frame;
}

Result<PoseMessage> decode_fd(std::span<const std::uint8_t> data) {
  if (data.size() != k_fd_size_bytes) {
    return fail(Errc::ProtocolError, "CAN FD pose: %zu bytes, %zu expected", data.size(), k_fd_size_bytes);
  }
  if (get(data.subspan(46, 2)) != crc16(data.first(46)))
    return fail(Errc::ProtocolError, "CAN FD pose: wrong check sum");
  if (data[0] != k_fd_layout_version)
    return fail(Errc::ProtocolError, "CAN FD pose: layout version %d", int{data[0]});
  if (!is_counter(data[1])) return fail(Errc::ProtocolError, "CAN FD pose: SYNC counter %d", int{data[1]});
  const std::uint64_t stamp_us = get(data.subspan(4, 8));
  if (stamp_us > k_stamp_last_us) return fail(Errc::ProtocolError, "CAN FD pose: stamp beyond any clock");

  std::array<double, 4> parts{};
  for (std::size_t i = 0; i < parts.size(); ++i)
    parts[i] = get_signed(data.subspan(24 + 4 * i, 4)) * k_quaternion_step;
  const Eigen::Quaterniond rotation{parts[0], parts[1], parts[2], parts[3]};
  if (std::abs(rotation.squaredNorm() - 1) > 2 * k_unit_length_tolerance) {
    return fail(Errc::ProtocolError, "CAN FD pose: rotation of length %g", std::sqrt(rotation.squaredNorm()));
  }
  return PoseMessage{.sync_counter = data[1],
                     .status = data[2],
                     .stamp_us = stamp_us,
                     .T_base_flange = geometry::make_se3(
                         rotation.normalized(), get_translation(data.subspan<12, k_translation_bytes>()))};
}

}  // namespace biteline::canpose
