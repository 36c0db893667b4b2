// SPDX-License-Identifier: MIT
// Any picture: peaks lie in it, their numbers are numbers, and a saturated one that stands off its plateau
// says so.
#include <cmath>
#include <memory>

#include "common/stripe/peak_extractor.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case bytes{data, size};
  const int width_px = 16 + bytes.take<std::uint8_t>() % 64;
  const int height_px = 16 + bytes.take<std::uint8_t>() % 128;
  stripe::PeakConfig config;
  config.mode = static_cast<stripe::PeakMode>(bytes.take<std::uint8_t>() % 5);
  config.threshold_grey = 1 + bytes.take<std::uint8_t>() % 250;
  auto sut = stripe::PeakExtractor::create(config, width_px, height_px);
  fuzz::demand(sut.has_value(), "the settings are in their ranges");
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width_px * height_px));
  // Runs of one grey level: noise in every pixel is soon seen through.
  for (std::size_t at = 0; at < pixels.size() && !bytes.empty();) {
    const auto grey = bytes.take<std::uint8_t>();
    const std::size_t run = 1 + bytes.take<std::uint8_t>() % 32U;
    for (std::size_t i = 0; i < run && at < pixels.size(); ++i, ++at)
      pixels[at % static_cast<std::size_t>(height_px) * static_cast<std::size_t>(width_px) +
             at / static_cast<std::size_t>(height_px)] = grey;
  }
  const auto peaks = std::make_unique<stripe::Peaks>();
  sut->rt_extract({.pixels = pixels.data(), .stride_bytes = static_cast<std::size_t>(width_px)}, *peaks);
  for (int column = 0; column < peaks->column_count; ++column) {
    const stripe::ColumnPeaks& found = peaks->columns[static_cast<std::size_t>(column)];
    fuzz::demand(found.kept_count <= stripe::k_kept_peaks, "two peaks are kept at most");
    for (std::size_t i = 0; i < found.kept_count; ++i) {
      const stripe::Peak& peak = found.kept[i];
      fuzz::demand(std::isfinite(peak.row_px) && std::isfinite(peak.sigma_row_px) &&
                       std::isfinite(peak.amplitude) && std::isfinite(peak.width_px) &&
                       peak.sigma_row_px >= 0,
                   "a peak's numbers are numbers");
      const bool seen = peak.row_px >= 0 && peak.row_px <= static_cast<float>(height_px - 1);
      fuzz::demand(seen || (peak.flags & stripe::k_peak_clipped) != 0,
                   "a peak is in the picture, or says that it was cut off");
    }
  }
  return 0;
}
