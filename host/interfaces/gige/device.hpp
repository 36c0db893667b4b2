// SPDX-License-Identifier: MIT
#pragma once
/// \file The sensor as a GigE Vision device: answers commands and turns profiles into packets.  Without
/// sockets.

#include <cstdint>
#include <functional>
#include <optional>

#include "common/gige/control_channel.hpp"
#include "host/interfaces/gige/device_registers.hpp"
#include "host/interfaces/gige/stream_channel.hpp"

namespace biteline::gige {

/// GigE Vision 2.0 with frame numbers of 16 bits.  One client controls it at a time, for as long as its
/// heartbeat comes; all others may read.  Frames go to the controlling client's own address and nowhere else.
/// Thread: one owner.
class Device {
 public:
  using Clock = ControlChannel::Clock;
  /// A packet of the stream, to an address and port as on the wire.
  using SendStream = std::function<void(const Peer&, std::span<const std::uint8_t>)>;

  Device(const Identity& identity, std::uint16_t stream_source_port, SendStream send);

  /// The answer, if there is to be one.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> on_packet(const Peer& from,
                                                                   std::span<const std::uint8_t> packet,
                                                                   Clock::time_point now);
  /// Ends the stream of a client whose heartbeat was missed.
  void tick(Clock::time_point now);

  /// A stream of another head's frames ends.
  void set_head(std::size_t columns, const Depth& depth, const PictureShape& pictures = {});
  /// Of the lines and pictures from now on; 0: not known.
  void set_exposure(Nanoseconds exposure) { exposure_ = exposure; }
  /// Goes out as a frame, while a client acquires pictures.
  void offer(std::uint64_t scan, const wire::Picture& picture);
  /// Goes out as a line, while a client acquires profiles.
  void offer(std::uint64_t scan, const profile::Profile& profile);
  /// A frame that is begun is filled up with lines that hold nothing.
  void end_scan();

  [[nodiscard]] bool acquiring() const { return acquiring_; }
  /// Offered while a client acquired pictures, and of another form than the device's.
  [[nodiscard]] std::uint64_t pictures_left_out() const { return pictures_left_out_; }
  /// And what it acquires is pictures.
  [[nodiscard]] bool wants_pictures() const { return acquiring_ && choices_.picture(); }
  /// How often a client has started.
  [[nodiscard]] std::uint64_t starts() const { return starts_; }
  [[nodiscard]] const StreamCounts& counts() const { return stream_.counts(); }

 private:
  [[nodiscard]] std::vector<std::uint8_t> answer_to(const Peer& from, const Command& command);
  [[nodiscard]] std::vector<std::uint8_t> read_registers(const Command& command) const;
  [[nodiscard]] std::vector<std::uint8_t> read_memory(const Command& command) const;
  [[nodiscard]] std::vector<std::uint8_t> write_registers(const Peer& from, const Command& command);
  [[nodiscard]] std::vector<std::uint8_t> write_memory(const Peer& from, const Command& command);
  [[nodiscard]] Status write(const Peer& from, std::uint32_t address, std::uint32_t value);
  void start();
  void stop();
  /// Nobody controls it, and nothing is sent to anybody.
  void forget_client();
  void add_line(std::span<const std::uint8_t> line, std::span<const std::uint8_t> record);
  void end_frame();
  [[nodiscard]] Peer destination() const;
  void begin_frame(SensorClock::time_point exposure_mid);

  DeviceRegisters registers_;
  ControlChannel control_;
  SendStream send_;
  StreamChannel stream_;
  bool acquiring_{false};
  std::uint64_t starts_{0};
  Choices choices_;  ///< of the stream that is on
  std::size_t frame_columns_{0};
  PictureShape pictures_;
  std::size_t columns_{0};
  Depth depth_;
  std::uint64_t pictures_left_out_{0};
  Nanoseconds exposure_{0};
  std::uint32_t lines_{0};             ///< in the frame that is begun
  std::vector<std::uint8_t> records_;  ///< of those lines
};

}  // namespace biteline::gige
