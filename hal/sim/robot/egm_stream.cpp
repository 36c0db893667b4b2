// SPDX-License-Identifier: MIT
#include "hal/sim/robot/egm_stream.hpp"

#include <bit>
#include <initializer_list>

namespace biteline::sim {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put_varint(Bytes& out, std::uint64_t value) {
  for (; value >= 0x80U; value >>= 7U) out.push_back(static_cast<std::uint8_t>(value | 0x80U));
  out.push_back(static_cast<std::uint8_t>(value));
}

void put_count(Bytes& out, unsigned field, std::uint64_t value) {
  put_varint(out, field << 3U);
  put_varint(out, value);
}

void put_message(Bytes& out, unsigned field, const Bytes& message) {
  put_varint(out, field << 3U | 2U);
  put_varint(out, message.size());
  out.insert(out.end(), message.begin(), message.end());
}

/// Doubles in fields 1, 2 and so on.
Bytes doubles(std::initializer_list<double> values) {
  Bytes out;
  unsigned field = 0;
  for (const double value : values) {
    put_varint(out, ++field << 3U | 1U);
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (unsigned shift = 0; shift < 64; shift += 8) out.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
  return out;
}

Bytes pose_bytes(const SE3& T_base_flange) {
  const Vec3 place_mm = T_base_flange.translation();
  const Eigen::Quaterniond turn{T_base_flange.linear()};
  Bytes out;
  put_message(out, 1, doubles({place_mm.x(), place_mm.y(), place_mm.z()}));
  put_message(out, 2, doubles({turn.w(), turn.x(), turn.y(), turn.z()}));
  return out;
}

Bytes clock_bytes(Nanoseconds stamp) {
  const auto us = static_cast<std::uint64_t>(stamp.count() / 1000);
  Bytes out;
  put_count(out, 1, us / 1'000'000);
  put_count(out, 2, us % 1'000'000);
  return out;
}

}  // namespace

Result<EgmStream> EgmStream::open(const Config& config) {
  BITELINE_ASSIGN(UdpSender sender, UdpSender::open(config.port));
  return EgmStream{config, std::move(sender)};
}

std::vector<std::uint8_t> EgmStream::message(Nanoseconds stamp, const SE3& T_base_flange,
                                             bool program_running) const {
  constexpr std::uint64_t k_data = 2, k_motors_on = 1, k_mci_running = 3, k_rapid_stopped = 1,
                          k_rapid_running = 2;
  Bytes header, motors, mci, rapid, feedback, planned;
  put_count(header, 1, number_);
  put_count(header, 2, static_cast<std::uint32_t>(stamp.count() / 1'000'000));
  put_count(header, 3, k_data);
  const Bytes pose = pose_bytes(T_base_flange);
  for (Bytes* told : {&feedback, &planned}) {
    put_message(*told, 2, pose);
    if (config_.tells_measured_time) put_message(*told, 4, clock_bytes(stamp));
  }
  put_count(motors, 1, k_motors_on);
  put_count(mci, 1, k_mci_running);
  put_count(rapid, 1, program_running ? k_rapid_running : k_rapid_stopped);
  Bytes out;
  put_message(out, 1, header);
  put_message(out, 2, feedback);
  put_message(out, 3, planned);
  put_message(out, 4, motors);
  put_message(out, 5, mci);
  put_count(out, 6, 0);
  put_message(out, 8, rapid);
  return out;
}

void EgmStream::send(SensorClock::time_point instant, const SE3& T_base_flange, bool program_running) {
  sender_.send(message(instant.time_since_epoch() + config_.clock_offset, T_base_flange, program_running));
  ++number_;
}

}  // namespace biteline::sim
