// SPDX-License-Identifier: MIT
#include "firmware/app/backends/backend.hpp"
#include "hal/linux/socketcan/can_encoder.hpp"
#include "hal/linux/socketcan/can_pose_source.hpp"
#include "hal/linux/socketcan/encoder_pose_source.hpp"
#include "hal/linux/socketcan/socketcan_bus.hpp"

namespace biteline::sensor {
namespace {

Result<std::unique_ptr<hal::CanBus>> can_bus(const std::string& interface) {
  return hal::SocketcanBus::open({.interface = interface});
}

Result<std::unique_ptr<hal::EncoderIn>> encoder(const hal::BoardEncoder& board) {
  BITELINE_ASSIGN(std::unique_ptr<hal::CanBus> bus, open_can_bus(board.interface));
  return hal::CanEncoder::open(std::move(bus), {.node = board.node, .range_ticks = board.range_ticks});
}

Result<std::unique_ptr<hal::PoseSource>> poses(const hal::BoardPoses& board, const hal::Clock& clock) {
  if (board.kind == hal::BoardPoses::Kind::Encoder) {
    BITELINE_ASSIGN(std::unique_ptr<hal::EncoderIn> turned, encoder(board.encoder));
    return std::make_unique<hal::EncoderPoseSource>(
        std::move(turned), clock, hal::EncoderPoseSource::Config{.per_tick = board.per_tick});
  }
  BITELINE_ASSIGN(std::unique_ptr<hal::CanBus> bus, open_can_bus(board.interface));
  return std::make_unique<hal::CanPoseSource>(std::move(bus), clock,
                                              hal::CanPoseSource::Config{.base_id = board.base_id});
}

}  // namespace

extern const Backend k_socketcan_backend;
const Backend k_socketcan_backend{
    .name = "socketcan", .can_bus = can_bus, .poses = poses, .encoder = encoder};

}  // namespace biteline::sensor
