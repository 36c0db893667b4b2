// SPDX-License-Identifier: MIT
#include "tests/bench/web/watchers.hpp"

#include <cstring>
#include <ctime>
#include <span>

#include "common/image/jpeg.hpp"
#include "tests/support/web_client.hpp"

namespace biteline::bench {
namespace {

constexpr char k_picture = 1, k_profile = 2;
constexpr std::size_t k_time_at = 5, k_jpeg_at = 13;
/// Masked, as a client's are (RFC 6455, 5.3); who answers no ping is thrown out after half a minute.
const std::string k_pong{'\x8A', '\x80', 0, 0, 0, 0};

/// The sensor's clock on one machine (ARCHITECTURE.md, Clocks).
std::uint64_t monotonic_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000U + static_cast<std::uint64_t>(now.tv_nsec);
}

}  // namespace

void Watcher::watch(std::uint16_t port, const std::string& token, Reading reading) {
  test::WebClient client{port};
  connected = client.upgrade("/api/v1/live", "Authorization: Bearer " + token + "\r\n").status == 101;
  while (connected && !stopping_) {
    if (!client.readable(50)) continue;
    const auto frame = client.frame();
    if (!frame || frame->opcode == 8) connected = false;  // thrown out
    if (!connected) break;
    if (frame->opcode == 9) client.send(k_pong);
    if (frame->opcode == 2) take(frame->content, reading);
    if (reading != Reading::Slow) continue;
    for (int i = 0; i < 10 && !stopping_; ++i) std::this_thread::sleep_for(std::chrono::milliseconds{50});
  }
}

void Watcher::take(const std::string& message, Reading reading) {
  if (message.size() < k_jpeg_at) return;
  const char kind = message.front();
  if (kind != k_picture && kind != k_profile) return;
  std::uint64_t time_ns = 0;
  std::memcpy(&time_ns, message.data() + k_time_at, sizeof time_ns);
  std::uint64_t& newest_ns = kind == k_picture ? picture_ns_ : profile_ns_;
  if (time_ns < newest_ns) ++older;
  newest_ns = time_ns;
  if (kind == k_profile) {
    ++profiles;
    late_ms.push_back(1e-6 * (static_cast<double>(monotonic_ns()) - static_cast<double>(time_ns)));
    return;
  }
  ++pictures;
  if (reading != Reading::Page) return;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(message.data()) + k_jpeg_at;
  if (!image::decode_jpeg(std::span{bytes, message.size() - k_jpeg_at})) ++broken;
}

}  // namespace biteline::bench
