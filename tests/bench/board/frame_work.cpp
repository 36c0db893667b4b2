// SPDX-License-Identifier: MIT
// frame_work COLUMNS ROWS FRAMES: what the sensor's threads do with a picture, as often as asked, without any
// device.  Picture to profile, pose, message.  Run under frame_counts.py: two runs that differ in FRAMES
// alone tell what one picture costs.
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>

#include "common/wire/messages.hpp"
#include "firmware/pipeline/profile_pipeline.hpp"
#include "tests/support/made_head.hpp"
#include "tests/support/made_stripe.hpp"

namespace biteline::bench {
namespace {

constexpr std::size_t k_pictures = 2;

/// A shoe's section: a shallow arc with a groove, in the middle of the rows.
std::vector<std::uint8_t> draw(int width_px, int height_px, std::size_t index) {
  std::mt19937_64 random{100 + index};
  stripe::test::MadeStripe made;
  made.width_px = width_px;
  made.height_px = height_px;
  made.noise.speckle_contrast = 0.1F;
  const double phase = 0.7 * static_cast<double>(index);
  made.row_px = [=](int u) {
    const double x = static_cast<double>(u) / width_px;
    const double groove = (x - 0.4 - 0.02 * std::sin(phase)) / 0.012;
    return height_px * (0.45 + 0.1 * std::sin(3 * x + phase)) + 0.15 * height_px * std::exp(-groove * groove);
  };
  return stripe::test::picture(made, random);
}

/// Points of all profiles; nothing when the pipeline cannot be made.
std::size_t work(int width_px, int height_px, int frames) {
  const std::array<std::vector<std::uint8_t>, k_pictures> pictures{draw(width_px, height_px, 0),
                                                                   draw(width_px, height_px, 1)};
  auto pipeline = pipeline::ProfilePipeline::create({}, test::made_head(width_px, height_px));
  if (!pipeline) return 0;
  const auto poses = std::make_unique<pipeline::PoseHistory>();
  const auto profile = std::make_unique<profile::ProfileBuffer>();
  SensorClock::time_point now{};
  for (int i = 0; i < 1000; ++i) {
    now += std::chrono::milliseconds{2};
    poses->rt_push({.stamp = now});
  }
  wire::Bytes message;
  std::size_t points = 0;
  for (int i = 0; i < frames; ++i) {
    const std::vector<std::uint8_t>& picture = pictures[static_cast<std::size_t>(i) % k_pictures];
    const bool made = pipeline->rt_process({.pixels = {picture.data(), picture.size()},
                                            .width_px = width_px,
                                            .height_px = height_px,
                                            .stride_bytes = static_cast<std::size_t>(width_px),
                                            .sequence = static_cast<std::uint64_t>(i),
                                            .exposure_mid = now - std::chrono::milliseconds{100},
                                            .flags = 0},
                                           *profile);
    if (!made) return 0;
    pipeline->rt_stamp(*profile, *poses);
    wire::encode_profile({.scan_id = 1, .sequence = static_cast<std::uint64_t>(i)}, profile->header,
                         profile->view(), message);
    points += profile->view().size();
  }
  std::printf("{\"frames\":%d,\"points\":%zu,\"message_bytes\":%zu}\n", frames, points, message.size());
  return points;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  std::array<int, 3> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto number = argc == 4 ? std::atoi(argv[i + 1]) : 0;
    if (number < 1 || number > 10000) {
      std::fprintf(stderr, "usage: frame_work COLUMNS ROWS FRAMES, each of 1 to 10000\n");
      return 2;
    }
    numbers[i] = number;
  }
  return biteline::bench::work(numbers[0], numbers[1], numbers[2]) > 0 ? 0 : 1;
}
