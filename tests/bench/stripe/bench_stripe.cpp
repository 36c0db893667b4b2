// SPDX-License-Identifier: MIT
// Speed of the peak extraction against memory and against what a user could put together: one thread, frames
// streamed from a set larger than the caches, ours and the peers in turn on the same frames.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include "firmware/pipeline/profile_pipeline.hpp"
#include "tests/bench/stripe/peers.hpp"
#include "tests/bench/stripe/streamed_frames.hpp"
#include "tests/support/made_head.hpp"

namespace biteline::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Each frame's least time over the turns: other processes only ever slow one down.  Frames take turns, so
/// that none is still in a cache when it comes again.
class FrameTimes {
 public:
  explicit FrameTimes(std::size_t frames) : least_s_(frames, 1e9) {}

  void take_turn(const StreamedFrames& frames, const std::function<void(const std::uint8_t*)>& work) {
    for (std::size_t i = 0; i < least_s_.size(); ++i) {
      const auto start = Clock::now();
      work(frames.frame(i));
      least_s_[i] = std::min(least_s_[i], seconds_since(start));
    }
  }

  [[nodiscard]] double pixels_per_s(const StreamedFrames& frames) const {
    const double sum_s = std::accumulate(least_s_.begin(), least_s_.end(), 0.0);
    return static_cast<double>(least_s_.size() * frames.frame_bytes()) / sum_s;
  }

 private:
  std::vector<double> least_s_;
};

void row(const char* what, const char* size, double ours, const char* peer, double peer_value,
         double target) {
  std::printf(
      "{\"bench\":\"stripe.extract\",\"what\":\"%s, %s\",\"ours\":%.4g,\"peer\":\"%s\",\"peer_value\":%.4g,"
      "\"unit\":\"Gpixel/s\",\"ratio\":%.4g,\"target\":%g}\n",
      what, size, 1e-9 * ours, peer, 1e-9 * peer_value, ours / peer_value, target);
  std::fflush(stdout);
}

int compare_speed(StreamedFrames::Size size) {
  const StreamedFrames frames{size};
  char name[32];
  std::snprintf(name, sizeof name, "%d x %d", size.width_px, size.height_px);
  auto extractor = stripe::PeakExtractor::create({}, size.width_px, size.height_px);
  if (!extractor) return 1;
  const auto peaks = std::make_unique<stripe::Peaks>();
  std::vector<float> rows(static_cast<std::size_t>(size.width_px));
  const auto peer_frame = [&](const std::uint8_t* pixels) {
    return PeerFrame{.pixels = pixels, .width_px = size.width_px, .height_px = size.height_px};
  };

  std::uint64_t sum = 0;
  const auto read = [&](const std::uint8_t* pixels) { sum += sum_of_bytes({pixels, frames.frame_bytes()}); };
  const auto ours = [&](const std::uint8_t* pixels) {
    extractor->rt_extract({.pixels = pixels, .stride_bytes = static_cast<std::size_t>(size.width_px)},
                          *peaks);
  };
  // All of them in turn, so that a slow moment of the machine meets all; the slow ones see fewer frames.
  const auto gravity = [&](const std::uint8_t* p) { argmax_and_gravity(peer_frame(p), rows); };
  const auto opencv = [&](const std::uint8_t* p) { opencv_gravity(peer_frame(p), rows); };
  const auto steger = [&](const std::uint8_t* p) { opencv_steger(peer_frame(p), 2.1, rows); };
  FrameTimes reading{frames.count()}, extracting{frames.count()}, by_hand{frames.count()}, by_opencv{40},
      by_steger{3};
  for (int turn = 0; turn < 5; ++turn) {
    reading.take_turn(frames, read);
    extracting.take_turn(frames, ours);
    by_hand.take_turn(frames, gravity);
    by_opencv.take_turn(frames, opencv);
    by_steger.take_turn(frames, steger);
  }
  const double rate = extracting.pixels_per_s(frames);
  const auto against = [&](const char* peer, const FrameTimes& times, double target) {
    row("full default extraction", name, rate, peer, times.pixels_per_s(frames), target);
  };
  against("reading (sum of bytes)", reading, 0.6);
  against("hand argmax + centre of gravity", by_hand, 0);
  against("OpenCV blur + argmax + centre of gravity", by_opencv, 10);
  against("OpenCV Steger", by_steger, 100);
  return sum == 0 ? 1 : 0;
}

/// From the frame's last byte in memory to the finished profile: peaks, choice, averaging, triangulation,
/// pose.
int latency() {
  const StreamedFrames::Size size{.width_px = 1626, .height_px = 1236};
  const StreamedFrames frames{size};
  const geometry::SensorModel sensor = test::made_head(size.width_px, size.height_px);
  auto pipeline = pipeline::ProfilePipeline::create({}, sensor);
  if (!pipeline) return 1;
  const auto poses = std::make_unique<pipeline::PoseHistory>();
  const auto profile = std::make_unique<profile::ProfileBuffer>();
  constexpr std::size_t k_frames = 100000;
  std::vector<double> latency_us(k_frames);
  SensorClock::time_point now{};
  for (int i = 0; i < 1000; ++i) {
    now += std::chrono::milliseconds{2};
    poses->rt_push({.stamp = now});
  }
  for (std::size_t i = 0; i < k_frames; ++i) {
    const auto start = Clock::now();
    pipeline->rt_process({.pixels = {frames.frame(i), frames.frame_bytes()},
                          .width_px = size.width_px,
                          .height_px = size.height_px,
                          .stride_bytes = static_cast<std::size_t>(size.width_px),
                          .sequence = i,
                          .exposure_mid = now - std::chrono::milliseconds{100},
                          .flags = 0},
                         *profile);
    pipeline->rt_stamp(*profile, *poses);
    latency_us[i] = 1e6 * seconds_since(start);
    // A camera's thread waits for its next frame now and then; one that never does (under chrt -f, as the
    // sensor's) the kernel would hold up for 50 ms in every second.
    if (i % 16 == 0) std::this_thread::sleep_for(std::chrono::microseconds{400});
  }
  std::sort(latency_us.begin(), latency_us.end());
  const auto print = [](const char* what, double value_us) {
    std::printf(
        "{\"bench\":\"stripe.latency\",\"what\":\"frame 1626 x 1236 to profile, %s of "
        "100000\",\"ours\":%.4g,\"unit\":\"us\"}\n",
        what, value_us);
  };
  print("median", latency_us[k_frames / 2]);
  print("99.9th percentile", latency_us[k_frames - k_frames / 1000]);
  print("worst", latency_us.back());
  return 0;
}

}  // namespace
}  // namespace biteline::bench

int main() {
  return biteline::bench::compare_speed({.width_px = 1626, .height_px = 1236}) +
         biteline::bench::compare_speed({.width_px = 2048, .height_px = 1088}) + biteline::bench::latency();
}
