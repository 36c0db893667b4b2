// SPDX-License-Identifier: MIT
#include "tests/bench/stripe/streamed_frames.hpp"

#include <cmath>
#include <random>

#include "tests/support/made_stripe.hpp"

namespace biteline::bench {
namespace {

constexpr std::size_t k_set_bytes = std::size_t{256} << 20U;
/// Frames with noise of their own; the rest of the set shows them again, rolled by some columns.
constexpr std::size_t k_drawn_frames = 6;

std::vector<std::uint8_t> draw(StreamedFrames::Size size, std::size_t index) {
  std::mt19937_64 random{100 + index};
  stripe::test::MadeStripe made;
  made.width_px = size.width_px;
  made.height_px = size.height_px;
  made.noise.speckle_contrast = 0.1F;
  const double phase = 0.7 * static_cast<double>(index);
  // A shoe's section: a shallow arc with a groove whose walls rise three rows per column.
  made.row_px = [=](int u) {
    const double x = static_cast<double>(u) / size.width_px;
    const double groove = (x - 0.4 - 0.02 * std::sin(phase)) / 0.012;
    return size.height_px * (0.45 + 0.1 * std::sin(3 * x + phase)) + 60 * std::exp(-groove * groove);
  };
  return stripe::test::picture(made, random);
}

}  // namespace

StreamedFrames::StreamedFrames(Size size)
    : size_{size},
      count_{k_set_bytes /
             (static_cast<std::size_t>(size.width_px) * static_cast<std::size_t>(size.height_px))} {
  pixels_.resize(count_ * frame_bytes());
  const auto width = static_cast<std::ptrdiff_t>(size.width_px);
  for (std::size_t i = 0; i < k_drawn_frames; ++i) {
    const std::vector<std::uint8_t> drawn = draw(size, i);
    for (std::size_t k = i; k < count_; k += k_drawn_frames) {
      const auto roll = static_cast<std::ptrdiff_t>(k) % 40;
      for (std::ptrdiff_t row = 0; row < size.height_px; ++row) {
        const auto from = drawn.begin() + row * width;
        const auto to = pixels_.begin() + static_cast<std::ptrdiff_t>(k * frame_bytes()) + row * width;
        std::copy(from + roll, from + width, to);
        std::copy(from, from + roll, to + (width - roll));
      }
    }
  }
}

}  // namespace biteline::bench
