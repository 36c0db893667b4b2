// SPDX-License-Identifier: MIT
#pragma once
/// \file A network between a client and the simulated camera that loses or garbles packets of the stream and
/// sends them again when asked.

#include <netinet/in.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "common/core/result.hpp"
#include "hal/linux/posix/descriptor.hpp"

namespace biteline::sim {

/// Aravis' fake camera cannot resend.  This stands before it at an address of its own (any of 127.0.0.0/8):
/// commands go through to the camera but PACKETRESEND, which is answered from the packets kept here (GigE
/// Vision 1.x, 16.6); the stream comes through with losses.  Only the first sending is lost, as on a cable
/// with bursts of noise. Thread: one of its own; the counts from any.
class LossyLine {
 public:
  struct Config {
    std::string address{"127.0.0.2"};  ///< where the client finds the camera
    std::string camera{"127.0.0.1"};
    double lost_ratio{0.01};
    std::uint64_t leaders_to_lose{0};  ///< of the frames that come first, beside that ratio
    double garbled_ratio{
        0};  ///< of the packets that come through: some bytes changed, mostly of their headers
    std::uint32_t seed{1};
  };
  [[nodiscard]] static Result<std::unique_ptr<LossyLine>> open(const Config& config);
  ~LossyLine();
  LossyLine(const LossyLine&) = delete;
  LossyLine& operator=(const LossyLine&) = delete;

  [[nodiscard]] std::uint64_t packets_lost() const { return lost_; }
  [[nodiscard]] std::uint64_t packets_sent_again() const { return sent_again_; }

 private:
  struct Kept {
    std::uint16_t block{0};
    std::uint32_t packet{0};
    std::vector<std::uint8_t> bytes;
  };
  /// Some frames' worth; a packet asked for later is gone, as in a camera's own memory.
  static constexpr std::size_t k_kept = 1024;

  LossyLine(const Config& config, hal::Descriptor client_side, hal::Descriptor camera_side,
            hal::Descriptor stream);
  void run();
  void from_client();
  void from_camera();
  void from_stream();
  void garble(std::span<std::uint8_t> packet);
  void send_again(std::span<const std::uint8_t> command);

  Config config_;
  hal::Descriptor client_side_, camera_side_, stream_;
  sockaddr_in client_{};         ///< who asked last
  sockaddr_in stream_client_{};  ///< where it wants the stream
  std::uint16_t stream_port_{0};
  std::vector<Kept> kept_{k_kept};
  std::size_t next_kept_{0};
  std::array<std::uint8_t, 65536> buffer_{};
  std::mt19937 random_;
  std::uint64_t leaders_lost_{0};  ///< of leaders_to_lose
  std::atomic<std::uint64_t> lost_{0}, sent_again_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace biteline::sim
