// SPDX-License-Identifier: MIT
#include "hal/sim/render/speckle_field.hpp"

#include <cmath>
#include <complex>
#include <mutex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "common/core/contracts.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {
namespace {

constexpr int k_samples = 4;  // of a pixel's side
constexpr int k_wide = k_samples * SpeckleField::k_columns, k_high = k_samples * SpeckleField::k_rows;

/// Cycles over the whole side, with sign.
int cycles(int index, int side) {
  return index < side / 2 ? index : index - side;
}

/// Brightness of light of one polarisation, by sample, column after column.
std::vector<float> brightness(const optics::SpeckleOptics& optics, Random random) {
  using Complex = std::complex<float>;
  // The pupil passes these cycles in a sample's side.
  const double most = optics.pixel_um / k_samples /
                      (2e-3 * optics.wavelength_nm * optics.f_number * (1 + optics.magnification));
  BITELINE_EXPECTS(most < 0.5);
  std::vector<Complex> field(static_cast<std::size_t>(k_wide) * k_high);
  Eigen::FFT<float> fft;
  std::vector<Complex> line(k_high), transformed;
  for (int i = 0; i < k_wide; ++i) {
    const double x = static_cast<double>(cycles(i, k_wide)) / k_wide;
    if (std::fabs(x) >= most) continue;
    for (int j = 0; j < k_high; ++j) {
      const bool passes = std::hypot(x, static_cast<double>(cycles(j, k_high)) / k_high) < most;
      line[static_cast<std::size_t>(j)] =
          passes ? Complex{static_cast<float>(random.gaussian()), static_cast<float>(random.gaussian())}
                 : Complex{};
    }
    fft.inv(transformed, line);
    std::copy(transformed.begin(), transformed.end(),
              field.begin() + static_cast<std::ptrdiff_t>(i) * k_high);
  }
  std::vector<float> light(field.size());
  double sum = 0;
  line.resize(k_wide);
  for (int j = 0; j < k_high; ++j) {
    for (int i = 0; i < k_wide; ++i)
      line[static_cast<std::size_t>(i)] =
          field[static_cast<std::size_t>(i) * k_high + static_cast<std::size_t>(j)];
    fft.inv(transformed, line);
    for (int i = 0; i < k_wide; ++i) {
      const float grain = std::norm(transformed[static_cast<std::size_t>(i)]);
      light[static_cast<std::size_t>(i) * k_high + static_cast<std::size_t>(j)] = grain;
      sum += static_cast<double>(grain);
    }
  }
  const auto mean = static_cast<float>(sum / static_cast<double>(light.size()));
  for (float& grain : light) grain /= mean;
  return light;
}

/// Mean over the pixel that begins at that sample.
float pixel_mean(const std::vector<float>& light, int column, int row) {
  float sum = 0;
  for (int i = column; i < column + k_samples; ++i) {
    const std::size_t begin = static_cast<std::size_t>(i % k_wide) * k_high;
    for (int j = row; j < row + k_samples; ++j) sum += light[begin + static_cast<std::size_t>(j % k_high)];
  }
  return sum / (k_samples * k_samples);
}

}  // namespace

SpeckleField::SpeckleField(const optics::SpeckleOptics& optics) {
  const Random source(0x535045434BULL);  // one field for all heads: they differ by where they begin in it
  const std::vector<float> along = brightness(optics, source.fork(1)),
                           across = brightness(optics, source.fork(2));
  for (int half = 0; half < 4; ++half) {
    auto& grains = grains_[static_cast<std::size_t>(half)];
    grains.reserve(static_cast<std::size_t>(k_columns) * k_rows);
    for (int column = 0; column < k_columns; ++column) {
      for (int row = 0; row < k_rows; ++row) {
        const int i = k_samples * column + k_samples / 2 * (half / 2);
        const int j = k_samples * row + k_samples / 2 * (half % 2);
        grains.push_back({.along = pixel_mean(along, i, j), .across = pixel_mean(across, i, j)});
      }
    }
  }
}

std::shared_ptr<const SpeckleField> SpeckleField::of(const optics::SpeckleOptics& optics) {
  static std::mutex mutex;
  static std::vector<std::pair<optics::SpeckleOptics, std::shared_ptr<const SpeckleField>>> made;
  const std::lock_guard lock(mutex);
  for (const auto& [known, field] : made)
    if (known == optics) return field;
  made.emplace_back(optics, std::make_shared<const SpeckleField>(optics));
  return made.back().second;
}

void SpeckleField::add(const Place& place, const Pixel& pixel, std::span<Grain> rows) const {
  const int column_half_px = place.column_half_px + 2 * pixel.column;
  const int row_half_px = place.row_half_px + 2 * pixel.first_row;
  const auto& grains = grains_[static_cast<std::size_t>(2 * (column_half_px & 1) + (row_half_px & 1))];
  // Powers of two: the field goes on behind its end, and before its begin.
  const auto column = static_cast<std::size_t>((column_half_px >> 1) & (k_columns - 1));
  const auto first = static_cast<std::size_t>((row_half_px >> 1) & (k_rows - 1));
  const Grain* begin = grains.data() + column * k_rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Grain& grain = begin[(first + i) & (k_rows - 1)];
    rows[i].along += grain.along;
    rows[i].across += grain.across;
  }
}

}  // namespace biteline::sim
