// SPDX-License-Identifier: MIT
// Accuracy of the peaks on made stripes with known rows: against the Cramer-Rao bound of the same noise
// model, against Steger's detector under speckle, and whether the reported standard deviations are honest.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "common/stripe/line_average.hpp"
#include "common/stripe/peak_extractor.hpp"
#include "tests/bench/stripe/peers.hpp"
#include "tests/support/made_stripe.hpp"

namespace biteline::bench {
namespace {

using stripe::test::MadeStripe;

constexpr int k_pictures = 60;
constexpr int k_width_px = 512, k_height_px = 96;

struct Score {
  double sum_squared{0}, sum_normalised{0};
  long count{0}, missed{0};

  void add(double error_px, double sigma_px) {
    sum_squared += error_px * error_px;
    sum_normalised += error_px * error_px / (sigma_px * sigma_px);
    ++count;
  }
  [[nodiscard]] double rms_px() const { return std::sqrt(sum_squared / static_cast<double>(count)); }
  [[nodiscard]] double normalised() const { return sum_normalised / static_cast<double>(count); }
};

struct Scores {
  Score single, averaged, steger;
};

double row_of(int picture, int u) {
  return 35.0 + 0.37 * picture + 0.0371 * u;
}

Scores measure(MadeStripe made) {
  std::mt19937_64 random{17};
  made.width_px = k_width_px;
  made.height_px = k_height_px;
  auto extractor =
      stripe::PeakExtractor::create({.threshold_grey = 8, .noise = made.noise}, k_width_px, k_height_px);
  const stripe::LineAverage average{{}};
  const auto peaks = std::make_unique<stripe::Peaks>();
  std::vector<stripe::LinePoint> line(k_width_px), work(k_width_px);
  std::vector<float> steger(k_width_px);
  Scores scores;
  for (int picture = 0; picture < k_pictures; ++picture) {
    made.row_px = [&](int u) { return row_of(picture, u); };
    const std::vector<std::uint8_t> pixels = stripe::test::picture(made, random);
    extractor->rt_extract({.pixels = pixels.data(), .stride_bytes = k_width_px}, *peaks);
    for (std::size_t u = 0; u < k_width_px; ++u) {
      const stripe::ColumnPeaks& column = peaks->columns[u];
      line[u] = {};
      if (column.kept_count == 0) {
        ++scores.single.missed;
        continue;
      }
      const stripe::Peak& peak = column.kept[0];
      line[u] = {.row_px = peak.row_px,
                 .sigma_row_px = peak.sigma_row_px,
                 .present = true,
                 .joined = u > 0 && line[u - 1].present};
      scores.single.add(static_cast<double>(peak.row_px) - row_of(picture, static_cast<int>(u)),
                        static_cast<double>(peak.sigma_row_px));
    }
    average.rt_average(line, work, peaks->speckle.neighbour_correlation);
    opencv_steger({.pixels = pixels.data(), .width_px = k_width_px, .height_px = k_height_px}, made.sigma_px,
                  steger);
    for (std::size_t u = 16; u < k_width_px - 16; ++u) {
      if (line[u].present) {
        scores.averaged.add(static_cast<double>(line[u].row_px) - row_of(picture, static_cast<int>(u)),
                            static_cast<double>(line[u].sigma_row_px));
      }
      if (steger[u] >= 0)
        scores.steger.add(static_cast<double>(steger[u]) - row_of(picture, static_cast<int>(u)), 1);
    }
  }
  return scores;
}

/// Mean of the bound over sub-pixel phases, as a variance.
double bound_px(const MadeStripe& made) {
  MadeStripe tall = made;
  tall.height_px = k_height_px;
  double sum = 0;
  constexpr int k_phases = 32;
  for (int i = 0; i < k_phases; ++i)
    sum += std::pow(stripe::test::cramer_rao_px(tall, 45 + static_cast<double>(i) / k_phases), 2) / k_phases;
  return std::sqrt(sum);
}

void row(const char* what, double ours, const char* peer, double peer_value, double target) {
  std::printf(
      "{\"bench\":\"stripe.accuracy\",\"what\":\"%s\",\"ours\":%.4g,\"peer\":\"%s\",\"peer_value\":%.4g,"
      "\"unit\":\"px\","
      "\"ratio\":%.4g,\"target\":%g}\n",
      what, ours, peer, peer_value, ours / peer_value, target);
}

void honesty(const char* what, double normalised) {
  std::printf(
      "{\"bench\":\"stripe.honesty\",\"what\":\"variance of error over sigma, "
      "%s\",\"ours\":%.4g,\"unit\":\"1\",\"target\":\"0.8 to 1.25\"}\n",
      what, normalised);
}

}  // namespace
}  // namespace biteline::bench

int main() {
  using namespace biteline::bench;
  char what[64];
  for (const double amplitude : {20.0, 40.0, 80.0, 150.0, 250.0}) {
    MadeStripe made;
    made.amplitude = amplitude;
    const Scores scores = measure(made);
    std::snprintf(what, sizeof what, "amplitude %g", amplitude);
    row(what, scores.single.rms_px(), "Cramer-Rao bound", bound_px(made), 1.15);
    honesty(what, scores.single.normalised());
  }
  for (const double share : {0.1, 0.2, 0.3}) {
    // Full scale over this share of the full width at half maximum (2.3548 sigma).
    MadeStripe made;
    made.sigma_px = 3;
    const double half = 0.5 * share * 2.3548;
    made.amplitude = 255 * std::exp(0.5 * half * half);
    const Scores scores = measure(made);
    std::snprintf(what, sizeof what, "saturated over %g of the width", share);
    row(what, scores.single.rms_px(), "Cramer-Rao bound", bound_px(made), 1.3);
    honesty(what, scores.single.normalised());
  }
  MadeStripe speckled;
  speckled.noise.speckle_contrast = 0.25F;
  const Scores scores = measure(speckled);
  row("speckle 0.25, single column", scores.single.rms_px(), "Cramer-Rao bound", bound_px(speckled), 0);
  row("speckle 0.25, averaged along the line", scores.averaged.rms_px(), "OpenCV Steger",
      scores.steger.rms_px(), 1);
  honesty("speckle 0.25, single column", scores.single.normalised());
  honesty("speckle 0.25, averaged", scores.averaged.normalised());
}
