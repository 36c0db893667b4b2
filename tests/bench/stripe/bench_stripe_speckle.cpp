// SPDX-License-Identifier: MIT
// Peaks in a laser's light by wave optics (SpeckleField), stripes with known rows: is the contrast told, are
// the stated standard deviations true, which columns are kept, and how far one column's noise is above
// Dorsch's limit.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "common/optics/stripe_noise.hpp"
#include "common/stripe/line_average.hpp"
#include "common/stripe/peak_extractor.hpp"
#include "common/stripe/peak_selector.hpp"
#include "hal/sim/render/speckle_field.hpp"
#include "tests/support/made_stripe.hpp"

namespace biteline::bench {
namespace {

using sim::SpeckleField;

constexpr int k_pictures = 24, k_height_px = 64;
constexpr int k_width_px = SpeckleField::k_columns;
/// Sheets whose stripe is as wide as the head's (0.45 mm), and one that lens and pixels widen more than the
/// sheet does (0.2 mm).
constexpr double k_head_sheet_mm = 0.45, k_thin_sheet_mm = 0.2;

/// A lens, and so many unrelated patterns as motion averages.
struct Light {
  double f_number;
  int looks;
};
constexpr std::array k_lights{Light{5.6, 88}, Light{5.6, 10}, Light{5.6, 3}, Light{5.6, 1}, Light{9.5, 1}};

/// A stripe on a surface that keeps none of the laser's polarisation, in one piece of the field.
class Pictures {
 public:
  Pictures(const Light& light, double sheet_mm)
      : light_{light}, field_{SpeckleField::of({.f_number = light.f_number})} {
    made.width_px = k_width_px;
    made.height_px = k_height_px;
    made.amplitude = 120;
    made.sigma_px = optics::stripe_noise({.f_number = light.f_number, .stripe_mm = sheet_mm}).stripe_px;
  }

  /// Of the light, by pixel: mean 1.
  [[nodiscard]] std::vector<double> grains(int picture) const {
    std::vector<double> ratio(static_cast<std::size_t>(k_width_px * k_height_px), 0.0);
    std::vector<SpeckleField::Grain> column(k_height_px);
    for (int u = 0; u < k_width_px; ++u) {
      column.assign(column.size(), {});
      for (int look = 0; look < light_.looks; ++look)
        field_->add({.column_half_px = 38 * look + 11 * picture, .row_half_px = 74 * look + 31 * picture},
                    {.column = u, .first_row = 0}, column);
      for (int v = 0; v < k_height_px; ++v) {
        const SpeckleField::Grain& grain = column[static_cast<std::size_t>(v)];
        ratio[static_cast<std::size_t>(v * k_width_px + u)] =
            static_cast<double>(grain.along + grain.across) / (2 * light_.looks);
      }
    }
    return ratio;
  }

  stripe::test::MadeStripe made;

 private:
  Light light_;
  std::shared_ptr<const SpeckleField> field_;
};

/// What was found in all pictures.  Errors over their standard deviations, without sign.
struct Found {
  std::vector<double> single, averaged;
  double error_squares_px2{0};  ///< of one column
  double told_contrast{0};      ///< sum over the pictures
};

/// The sensor's own search, choice and average along the line.
class Eye {
 public:
  /// Adds what one picture shows; `row_of` is the stripe's row in a column.
  void look(const std::vector<std::uint8_t>& pixels, const std::function<double(int)>& row_of, Found& found) {
    extractor_.rt_extract({.pixels = pixels.data(), .stride_bytes = k_width_px}, *peaks_);
    selector_->rt_select(*peaks_, *selection_);
    found.told_contrast += static_cast<double>(peaks_->speckle.contrast);
    for (std::size_t u = 0; u < k_width_px; ++u) {
      const stripe::Selected& selected = selection_->columns[u];
      line_[u] = {};
      if (selected.kept_index < 0 || selected.flags != 0) continue;
      const stripe::Peak& peak = peaks_->columns[u].kept[static_cast<std::size_t>(selected.kept_index)];
      line_[u] = {.row_px = peak.row_px,
                  .sigma_row_px = peak.sigma_row_px,
                  .present = true,
                  .joined = u > 0 && line_[u - 1].present};
      const double error_px = error_of(u, row_of);
      found.error_squares_px2 += error_px * error_px;
      found.single.push_back(std::fabs(error_px) / static_cast<double>(peak.sigma_row_px));
    }
    average_.rt_average(line_, work_, peaks_->speckle.neighbour_correlation);
    for (std::size_t u = 0; u < k_width_px; ++u) {
      if (line_[u].present)
        found.averaged.push_back(std::fabs(error_of(u, row_of)) / static_cast<double>(line_[u].sigma_row_px));
    }
  }

 private:
  [[nodiscard]] double error_of(std::size_t u, const std::function<double(int)>& row_of) const {
    return static_cast<double>(line_[u].row_px) - row_of(static_cast<int>(u));
  }

  stripe::PeakExtractor extractor_{*stripe::PeakExtractor::create({}, k_width_px, k_height_px)};
  std::unique_ptr<stripe::PeakSelector> selector_{
      std::make_unique<stripe::PeakSelector>(stripe::SelectorConfig{})};
  std::unique_ptr<stripe::Peaks> peaks_{std::make_unique<stripe::Peaks>()};
  std::unique_ptr<stripe::Selection> selection_{std::make_unique<stripe::Selection>()};
  stripe::LineAverage average_{{}};
  std::vector<stripe::LinePoint> line_{k_width_px}, work_{k_width_px};
};

struct Seen {
  double contrast{0}, told_contrast{0};
  double single_rms_px{0};  ///< of one column
  double single_68{0}, averaged_68{0};
  double kept_ratio{0};
};

double ratio_68(std::vector<double>& ratios) {
  std::sort(ratios.begin(), ratios.end());
  return ratios[ratios.size() * 683 / 1000];
}

Seen see(const Light& light, double sheet_mm) {
  Pictures pictures{light, sheet_mm};
  std::mt19937_64 random{29};
  Eye eye;
  Found found;
  double light_squares = 0;
  for (int picture = 0; picture < k_pictures; ++picture) {
    pictures.made.row_px = [picture](int u) { return 26 + 0.37 * picture + 0.0071 * u; };
    const std::vector<double> grains = pictures.grains(picture);
    std::vector<double> mean(grains.size(), 0.0);
    stripe::test::add_stripe(pictures.made, mean);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] *= grains[i];
      light_squares += (grains[i] - 1) * (grains[i] - 1) / static_cast<double>(grains.size());
    }
    eye.look(stripe::test::expose(pictures.made, mean, random), pictures.made.row_px, found);
  }
  const auto kept = static_cast<double>(found.single.size());
  return {.contrast = std::sqrt(light_squares / k_pictures),
          .told_contrast = found.told_contrast / k_pictures,
          .single_rms_px = std::sqrt(found.error_squares_px2 / kept),
          .single_68 = ratio_68(found.single),
          .averaged_68 = ratio_68(found.averaged),
          .kept_ratio = kept / (k_pictures * k_width_px)};
}

/// Of the height, as the head sees it, for so many unrelated patterns of two polarisations.
double dorsch_mm(const Light& light) {
  const optics::ScanLight head{.f_number = light.f_number};
  return optics::dorsch_limit_um(optics::speckle_optics(head),
                                 optics::polarised_contrast(0) / std::sqrt(light.looks)) /
         1000 / std::sin(head.angle_rad);
}

void row(double contrast, const char* what, double value, const char* unit, const char* target) {
  std::printf(
      "{\"bench\":\"stripe.speckle\",\"what\":\"contrast %.2f: %s\",\"ours\":%.4g,\"unit\":\"%s\","
      "\"target\":\"%s\"}\n",
      contrast, what, value, unit, target);
}

void limit_row(double contrast, const char* what, double noise_mm, double limit_mm) {
  std::printf(
      "{\"bench\":\"stripe.speckle\",\"what\":\"contrast %.2f: one column, %s\",\"ours\":%.4g,"
      "\"peer\":\"Dorsch's limit\",\"peer_value\":%.4g,\"unit\":\"mm\",\"ratio\":%.3g,\"target\":1.2}\n",
      contrast, what, noise_mm, limit_mm, noise_mm / limit_mm);
}

}  // namespace
}  // namespace biteline::bench

int main() {
  using namespace biteline::bench;
  const double row_mm = biteline::optics::row_mm({});
  for (const Light& light : k_lights) {
    const Seen seen = see(light, k_head_sheet_mm);
    row(seen.contrast, "as told, over the true one", seen.told_contrast / seen.contrast, "1", "0.85 to 1.15");
    row(seen.contrast, "columns kept", 100 * seen.kept_ratio, "%", "95");
    row(seen.contrast, "error over sigma at 68 %, one column", seen.single_68, "1", "0.8 to 1.2");
    row(seen.contrast, "error over sigma at 68 %, averaged", seen.averaged_68, "1", "0.8 to 1.2");
    limit_row(seen.contrast, "a sheet of 0.45 mm", row_mm * seen.single_rms_px, dorsch_mm(light));
    const Seen thin = see(light, k_thin_sheet_mm);
    limit_row(thin.contrast, "a sheet of 0.2 mm", row_mm * thin.single_rms_px, dorsch_mm(light));
  }
}
