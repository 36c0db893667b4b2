// SPDX-License-Identifier: MIT
#include "hal/linux/socketcan/can_encoder.hpp"

#include <array>

namespace biteline::hal {

Result<std::unique_ptr<CanEncoder>> CanEncoder::open(std::unique_ptr<CanBus> bus, const Config& config) {
  if (config.node < 1 || config.node > 127) return fail(Errc::BadValue, "CANopen node %d", int{config.node});
  const std::array filters{CanFilter{.id = canpose::tpdo1_id(config.node), .mask = 0x7FF, .extended = false}};
  BITELINE_TRY(bus->set_filters(filters));
  return std::unique_ptr<CanEncoder>{new CanEncoder{std::move(bus), config}};
}

Result<EncoderReading> CanEncoder::read() noexcept {
  // Bounded: an encoder sends at most once a millisecond, so more than this is a bus gone wild and waits for
  // the next call.
  constexpr int k_frames_max = 256;
  for (int i = 0; i < k_frames_max; ++i) {
    const Result<CanFrame> frame = bus_->receive(Nanoseconds{0});
    if (!frame) {
      if (frame.error().code != Errc::Timeout) return tl::unexpected<Error>{frame.error()};
      break;
    }
    if (frame->id != id_) continue;
    const Result<std::uint32_t> position =
        canpose::decode_position(std::span{frame->data}.first(frame->size_bytes));
    if (!position) {
      ++malformed_;
      continue;
    }
    if (position_.feed(*position)) {
      has_reading_ = true;
      last_stamp_ = frame->received;
    }
  }
  if (!has_reading_) return fail(Errc::Timeout, "CAN encoder 0x%x: no position yet", id_);
  return EncoderReading{.position_ticks = position_.position_ticks(),
                        .stamp = last_stamp_,
                        .errors = malformed_ + position_.refused()};
}

}  // namespace biteline::hal
