// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/device.hpp"

#include <arpa/inet.h>

#include "common/gige/bootstrap.hpp"
#include "host/interfaces/gige/device_description.hpp"

namespace biteline::gige {
namespace {

constexpr std::uint32_t k_fire_test_packet = 0x8000'0000;
/// Registers and values of one command; the whole fits a packet of 576 bytes.
constexpr std::size_t k_most_command_bytes = 540;

/// What a chunk's end says: its kind, and how long it is.
std::array<std::uint8_t, k_chunk_tag_bytes> tag(std::uint32_t kind, std::size_t bytes) {
  std::array<std::uint8_t, k_chunk_tag_bytes> words{};
  put_word(words, 0, kind);
  put_word(words, 4, static_cast<std::uint32_t>(bytes));
  return words;
}

}  // namespace

Device::Device(const Identity& identity, std::uint16_t stream_source_port, SendStream send)
    : registers_{identity}, send_{std::move(send)}, stream_{[this](std::span<const std::uint8_t> packet) {
        send_(destination(), packet);
      }} {
  registers_.set(bootstrap::k_stream_source_port, stream_source_port);
}

std::optional<std::vector<std::uint8_t>> Device::on_packet(const Peer& from,
                                                           std::span<const std::uint8_t> packet,
                                                           Clock::time_point now) {
  tick(now);
  const std::optional<Command> command = read_command(packet);
  if (!command) return std::nullopt;
  if (command->code == command::k_packet_resend) {
    const std::optional<ResendWish> wish = read_resend(*command);
    if (acquiring_ && wish && wish->channel == 0 && destination().address == from.address)
      stream_.send_again(*wish);
    return std::nullopt;
  }
  std::optional<std::vector<std::uint8_t>> denied = control_.answer_for(from, packet, now);
  std::vector<std::uint8_t> reply = denied ? std::move(*denied) : answer_to(from, *command);
  if (!command->answer_wanted) return std::nullopt;
  return reply;
}

std::vector<std::uint8_t> Device::answer_to(const Peer& from, const Command& command) {
  if (command.body.size() > k_most_command_bytes) return answer(Status::InvalidParameter, command, {});
  switch (command.code) {
    case command::k_discovery: {
      std::array<std::uint8_t, bootstrap::k_discovery_bytes> all{};
      const Status status = registers_.read(0, all);
      return answer(status, command, all);
    }
    case command::k_read_register:
      return read_registers(command);
    case command::k_write_register:
      return write_registers(from, command);
    case command::k_read_memory:
      return read_memory(command);
    case command::k_write_memory:
      return write_memory(from, command);
    default:
      return answer(Status::NotImplemented, command, {});
  }
}

std::vector<std::uint8_t> Device::read_registers(const Command& command) const {
  if (command.body.empty() || command.body.size() % 4 != 0)
    return answer(Status::InvalidParameter, command, {});
  std::vector<std::uint8_t> values(command.body.size());
  for (std::size_t at = 0; at < values.size(); at += 4) {
    const Status status = registers_.read(word_at(command.body, at), std::span{values}.subspan(at, 4));
    if (status != Status::Success) return answer(status, command, {});
  }
  return answer(Status::Success, command, values);
}

std::vector<std::uint8_t> Device::read_memory(const Command& command) const {
  if (command.body.size() != 8) return answer(Status::InvalidParameter, command, {});
  const std::size_t bytes = half_at(command.body, 6);
  if (bytes == 0 || bytes > k_most_memory_bytes) return answer(Status::InvalidParameter, command, {});
  std::vector<std::uint8_t> body(4 + bytes);
  put_word(body, 0, word_at(command.body, 0));
  const Status status = registers_.read(word_at(command.body, 0), std::span{body}.subspan(4));
  return status == Status::Success ? answer(status, command, body) : answer(status, command, {});
}

std::vector<std::uint8_t> Device::write_registers(const Peer& from, const Command& command) {
  constexpr std::size_t k_pair_bytes = 8;
  std::array<std::uint8_t, 4> written{};
  if (command.body.empty() || command.body.size() % k_pair_bytes != 0)
    return answer(Status::InvalidParameter, command, written);
  Status status = Status::Success;
  std::uint16_t count = 0;
  for (std::size_t at = 0; at < command.body.size() && status == Status::Success; at += k_pair_bytes) {
    status = write(from, word_at(command.body, at), word_at(command.body, at + 4));
    if (status == Status::Success) ++count;
  }
  put_half(written, 2, count);
  return answer(status, command, written);
}

std::vector<std::uint8_t> Device::write_memory(const Peer& from, const Command& command) {
  std::array<std::uint8_t, 4> written{};
  if (command.body.size() < 8 || command.body.size() % 4 != 0)
    return answer(Status::InvalidParameter, command, written);
  Status status = Status::Success;
  std::uint16_t bytes = 0;
  for (std::size_t at = 4; at < command.body.size() && status == Status::Success; at += 4) {
    status =
        write(from, word_at(command.body, 0) + static_cast<std::uint32_t>(at - 4), word_at(command.body, at));
    if (status == Status::Success) bytes = static_cast<std::uint16_t>(bytes + 4);
  }
  put_half(written, 2, bytes);
  return answer(status, command, written);
}

Status Device::write(const Peer& from, std::uint32_t address, std::uint32_t value) {
  // Several in one command: after the word that gives control back nobody has it.
  if (address != bootstrap::k_privilege && registers_.word(bootstrap::k_privilege) == 0)
    return Status::AccessDenied;
  // Nobody is sent what he did not ask for himself.
  if (address == bootstrap::k_stream_address && value != 0 && value != ntohl(from.address))
    return Status::AccessDenied;
  if (address == own::k_acquisition && value == 1 && !acquiring_ &&
      (destination().address == 0 || destination().port == 0 || registers_.columns() == 0))
    return Status::InvalidParameter;
  const Status status = registers_.write(address, value, acquiring_);
  if (status != Status::Success) return status;
  switch (address) {
    case bootstrap::k_privilege:
      control_.set_privilege(value);
      if (value == 0) forget_client();
      break;
    case bootstrap::k_heartbeat_timeout:
      control_.set_heartbeat_timeout(std::chrono::milliseconds{value});
      break;
    case bootstrap::k_stream_port:
      if (value == 0) stop();
      break;
    case bootstrap::k_stream_packet_size:
      if ((value & k_fire_test_packet) != 0 && destination().address != 0 && destination().port != 0)
        send_(destination(), std::vector<std::uint8_t>(registers_.word(address) - k_ip_udp_bytes));
      break;
    case own::k_acquisition:
      value == 1 ? start() : stop();
      break;
    default:
      break;
  }
  return Status::Success;
}

void Device::tick(Clock::time_point now) {
  if (registers_.word(bootstrap::k_privilege) == 0 || control_.controller(now)) return;
  control_.set_privilege(0);
  forget_client();
}

void Device::forget_client() {
  stop();
  registers_.set(bootstrap::k_privilege, 0);
  registers_.set(bootstrap::k_stream_port, 0);
  registers_.set(bootstrap::k_stream_address, 0);
  registers_.set(own::k_locked, 0);
}

void Device::start() {
  if (acquiring_) return;
  acquiring_ = true;
  ++starts_;
  choices_ = registers_.choices();
  frame_columns_ = registers_.columns();
  lines_ = 0;
  records_.clear();
  stream_.restart(registers_.word(bootstrap::k_stream_packet_size));
}

void Device::stop() {
  acquiring_ = false;
  registers_.set(own::k_acquisition, 0);
}

void Device::set_head(std::size_t columns, const Depth& depth, const PictureShape& pictures) {
  const bool same = columns == columns_ && depth.scale_mm == depth_.scale_mm &&
                    depth.offset_mm == depth_.offset_mm && depth.across.scale_mm == depth_.across.scale_mm &&
                    depth.across.offset_mm == depth_.across.offset_mm && pictures.same_as(pictures_);
  if (same) return;
  stop();
  columns_ = columns;
  depth_ = depth;
  pictures_ = pictures;
  registers_.set_head(columns, depth, pictures);
}

void Device::offer(std::uint64_t scan, const profile::Profile& profile) {
  if (!acquiring_ || choices_.picture()) return;
  if (lines_ == 0) begin_frame(profile.header.exposure_mid);
  add_line(line_of(choices_.format, columns_, depth_, profile), line_record(scan, profile.header, exposure_));
}

void Device::begin_frame(SensorClock::time_point exposure_mid) {
  stream_.begin({.chunks = choices_.chunks,
                 .stamp = static_cast<std::uint64_t>(exposure_mid.time_since_epoch().count()),
                 .pixel_format = static_cast<std::uint32_t>(choices_.format),
                 .width = static_cast<std::uint32_t>(frame_columns_),
                 .height = choices_.lines});
}

void Device::offer(std::uint64_t scan, const wire::Picture& picture) {
  if (!wants_pictures()) return;
  const std::optional<std::vector<std::uint8_t>> pixels = whole_picture(pictures_, picture);
  if (!pixels) {
    ++pictures_left_out_;
    return;
  }
  begin_frame(picture.exposure_mid);
  stream_.append(*pixels);
  if (choices_.chunks) records_ = picture_record(scan, picture, exposure_);
  end_frame();
}

void Device::end_scan() {
  if (!acquiring_) return;
  const std::vector<std::uint8_t> nothing = empty_line(choices_.format, columns_);
  while (lines_ > 0) add_line(nothing, std::array<std::uint8_t, k_line_record_bytes>{});
}

void Device::add_line(std::span<const std::uint8_t> line, std::span<const std::uint8_t> record) {
  stream_.append(line);
  if (choices_.chunks) records_.insert(records_.end(), record.begin(), record.end());
  if (++lines_ == choices_.lines) end_frame();
}

void Device::end_frame() {
  const PayloadSize size = payload_size(choices_, frame_columns_);
  if (choices_.chunks) {
    const std::size_t filled = size.picture - choices_.lines * line_bytes(choices_.format, frame_columns_);
    stream_.append(std::vector<std::uint8_t>(filled));
    stream_.append(tag(k_picture_chunk, size.picture));
    stream_.append(records_);
    stream_.append(tag(k_lines_chunk, records_.size()));
    records_.clear();
  }
  stream_.finish(static_cast<std::uint32_t>(choices_.chunks ? size.whole : 0));
  lines_ = 0;
}

Peer Device::destination() const {
  return {.address = htonl(registers_.word(bootstrap::k_stream_address)),
          .port = htons(static_cast<std::uint16_t>(registers_.word(bootstrap::k_stream_port)))};
}

}  // namespace biteline::gige
