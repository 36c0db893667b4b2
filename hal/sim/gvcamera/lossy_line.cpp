// SPDX-License-Identifier: MIT
#include "hal/sim/gvcamera/lossy_line.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/gige/bootstrap.hpp"
#include "common/gige/packets.hpp"

namespace biteline::sim {
namespace {

constexpr int k_stream_buffer_bytes = 8 << 20;

sockaddr_in address_of(const std::string& address, std::uint16_t port) {
  sockaddr_in found{};
  found.sin_family = AF_INET;
  found.sin_port = htons(port);
  inet_pton(AF_INET, address.c_str(), &found.sin_addr);
  return found;
}

Result<hal::Descriptor> bound_socket(const std::string& address, std::uint16_t port) {
  hal::Descriptor socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  const sockaddr_in local = address_of(address, port);
  if (!socket.is_open() ||
      bind(socket.number(), reinterpret_cast<const sockaddr*>(&local), sizeof local) != 0) {
    return fail_errno(Errc::ConnectFailed, errno, "lossy line: %s port %d", address.c_str(), int{port});
  }
  return socket;
}

void send_to(const hal::Descriptor& socket, std::span<const std::uint8_t> bytes, const sockaddr_in& to) {
  // A datagram that does not get through is lost: nobody here promised more.
  (void)sendto(socket.number(), bytes.data(), bytes.size(), MSG_DONTWAIT,
               reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

}  // namespace

LossyLine::LossyLine(const Config& config, hal::Descriptor client_side, hal::Descriptor camera_side,
                     hal::Descriptor stream)
    : config_{config},
      client_side_{std::move(client_side)},
      camera_side_{std::move(camera_side)},
      stream_{std::move(stream)},
      random_{config.seed} {
  sockaddr_in local{};
  socklen_t size = sizeof local;
  getsockname(stream_.number(), reinterpret_cast<sockaddr*>(&local), &size);
  stream_port_ = ntohs(local.sin_port);
  thread_ = std::thread{[this] { run(); }};
}

LossyLine::~LossyLine() {
  stopping_ = true;
  thread_.join();
}

Result<std::unique_ptr<LossyLine>> LossyLine::open(const Config& config) {
  BITELINE_ASSIGN(hal::Descriptor client_side, bound_socket(config.address, gige::k_port));
  BITELINE_ASSIGN(hal::Descriptor camera_side, bound_socket(config.camera, 0));
  BITELINE_ASSIGN(hal::Descriptor stream, bound_socket(config.camera, 0));
  // As far as the kernel lets it: what overflows here is lost like the rest.
  setsockopt(stream.number(), SOL_SOCKET, SO_RCVBUF, &k_stream_buffer_bytes, sizeof k_stream_buffer_bytes);
  setsockopt(stream.number(), SOL_SOCKET, SO_RCVBUFFORCE, &k_stream_buffer_bytes,
             sizeof k_stream_buffer_bytes);
  return std::unique_ptr<LossyLine>{
      new LossyLine{config, std::move(client_side), std::move(camera_side), std::move(stream)}};
}

void LossyLine::run() {
  constexpr int k_look_ms = 20;
  std::array<pollfd, 3> waits{{{client_side_.number(), POLLIN, 0},
                               {camera_side_.number(), POLLIN, 0},
                               {stream_.number(), POLLIN, 0}}};
  while (!stopping_) {
    if (poll(waits.data(), waits.size(), k_look_ms) <= 0) continue;
    if ((waits[0].revents & POLLIN) != 0) from_client();
    if ((waits[1].revents & POLLIN) != 0) from_camera();
    if ((waits[2].revents & POLLIN) != 0) from_stream();
  }
}

void LossyLine::from_client() {
  sockaddr_in from{};
  socklen_t from_size = sizeof from;
  const ssize_t size = recvfrom(client_side_.number(), buffer_.data(), buffer_.size(), MSG_DONTWAIT,
                                reinterpret_cast<sockaddr*>(&from), &from_size);
  if (size < static_cast<ssize_t>(gige::k_command_header_bytes)) return;
  const std::span<std::uint8_t> command{buffer_.data(), static_cast<std::size_t>(size)};
  const auto code = gige::half_at(command, 2);
  if (code == gige::command::k_packet_resend) return send_again(command);
  client_ = from;
  // The stream is to come here first.
  constexpr std::size_t k_pair_bytes = 8;
  for (std::size_t at = gige::k_command_header_bytes;
       code == gige::command::k_write_register && at + k_pair_bytes <= command.size(); at += k_pair_bytes) {
    const auto value = gige::word_at(command, at + 4);
    if (gige::word_at(command, at) != gige::bootstrap::k_stream_port || value == 0) continue;
    stream_client_ = from;
    stream_client_.sin_port = htons(static_cast<std::uint16_t>(value));
    command[at + 6] = static_cast<std::uint8_t>(stream_port_ >> 8U);
    command[at + 7] = static_cast<std::uint8_t>(stream_port_ & 0xFFU);
  }
  send_to(camera_side_, command, address_of(config_.camera, gige::k_port));
}

void LossyLine::from_camera() {
  const ssize_t size = recv(camera_side_.number(), buffer_.data(), buffer_.size(), MSG_DONTWAIT);
  if (size > 0) send_to(client_side_, std::span{buffer_}.first(static_cast<std::size_t>(size)), client_);
}

void LossyLine::from_stream() {
  while (true) {
    const ssize_t size = recv(stream_.number(), buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (size < static_cast<ssize_t>(gige::k_stream_header_bytes)) return;
    const std::span<std::uint8_t> packet = std::span{buffer_}.first(static_cast<std::size_t>(size));
    // GVSP header: status, block, format and 24 bits of packet number.
    Kept& kept = kept_[next_kept_++ % k_kept];
    kept.block = gige::half_at(packet, 2);
    kept.packet = gige::word_at(packet, 4) & 0xFFFFFFU;
    kept.bytes.assign(packet.begin(), packet.end());
    const bool leader_to_lose = kept.packet == 0 && leaders_lost_ < config_.leaders_to_lose;
    if (leader_to_lose) ++leaders_lost_;
    if (leader_to_lose || std::uniform_real_distribution<double>{0, 1}(random_) < config_.lost_ratio) {
      ++lost_;
      continue;
    }
    if (std::uniform_real_distribution<double>{0, 1}(random_) < config_.garbled_ratio) garble(packet);
    send_to(stream_, packet, stream_client_);
  }
}

void LossyLine::garble(std::span<std::uint8_t> packet) {
  constexpr std::size_t k_leader_bytes = 44;  // GVSP header and the longest leader (image)
  // Aravis 0.8.26 takes a packet of another format for the first of a stream of extended numbers, and ends
  // the process over the room that it asks for.
  constexpr std::size_t k_format_byte = 4;
  const std::size_t reach = random_() % 4 == 0 ? packet.size() : std::min(packet.size(), k_leader_bytes);
  for (std::uint32_t changes = 1 + random_() % 3; changes > 0; --changes) {
    const std::size_t at = random_() % reach;
    const auto value = static_cast<std::uint8_t>(random_() % 3 == 0 ? 0xFF : random_());
    if (at != k_format_byte) packet[at] = value;
  }
}

void LossyLine::send_again(std::span<const std::uint8_t> command) {
  const std::optional<gige::Command> read = gige::read_command(command);
  const std::optional<gige::ResendWish> wish = read ? gige::read_resend(*read) : std::nullopt;
  if (!wish) return;
  for (const Kept& kept : kept_) {
    const bool wanted = kept.block == wish->block && kept.packet >= wish->first && kept.packet <= wish->last;
    if (!wanted || kept.bytes.empty()) continue;
    send_to(stream_, kept.bytes, stream_client_);
    ++sent_again_;
  }
}

}  // namespace biteline::sim
