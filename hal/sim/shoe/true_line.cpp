// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/true_line.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace biteline::sim {

namespace {

struct Peak {
  double z_mm;
  double curvature_per_mm;
};

Peak largest(const SmoothedSection& section) {
  const auto& k = section.curvature_per_mm;
  const auto top = std::max_element(k.begin(), k.end());
  const auto i = static_cast<std::size_t>(top - k.begin());
  double part = 0;
  if (i > 0 && i + 1 < k.size()) {
    const double bend = k[i - 1] - 2 * k[i] + k[i + 1];
    if (bend < -1e-12) part = 0.5 * (k[i - 1] - k[i + 1]) / bend;
  }
  return {.z_mm = section.first_z_mm + section.step_mm * (static_cast<double>(i) + part),
          .curvature_per_mm = *top};
}

/// Running mean over a closed sequence; the window's two end samples count by the part of them inside it.
std::vector<double> running_mean(const std::vector<double>& values, double window_samples) {
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(window_samples / 2 - 0.5));
  const double end_weight = std::clamp(window_samples / 2 + 0.5 - static_cast<double>(reach), 0.0, 1.0);
  std::vector<double> means(values.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    double sum = 0, weight_sum = 0;
    for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
      const double weight = std::abs(k) == reach ? end_weight : 1.0;
      sum += weight * values[static_cast<std::size_t>((i + k + count) % count)];
      weight_sum += weight;
    }
    means[static_cast<std::size_t>(i)] = sum / weight_sum;
  }
  return means;
}

Vec3 mean_normal(const MadeShoe& shoe, double s_mm, double line_z_mm, const PlaceDefinition& definition) {
  constexpr double k_step_mm = 0.1;
  Vec3 sum = Vec3::Zero();
  for (double above_mm = definition.normal_low_mm; above_mm <= definition.normal_high_mm + 1e-9;
       above_mm += k_step_mm) {
    sum += shoe.normal(s_mm, line_z_mm + above_mm);
  }
  return sum.normalized();
}

}  // namespace

SmoothedSection smoothed_section(const std::function<double(double)>& offset_mm, double nominal_z_mm,
                                 const PlaceDefinition& definition) {
  const double step = definition.height_step_mm, sigma = definition.smoothing_sigma_mm;
  const int tail = static_cast<int>(std::ceil(5 * sigma / step));
  const int reach = static_cast<int>(std::round(definition.search_mm / step));

  std::vector<double> offset;
  const double lowest_z_mm = nominal_z_mm - (reach + tail) * step;
  for (int i = 0; i <= 2 * (reach + tail); ++i) offset.push_back(offset_mm(lowest_z_mm + i * step));

  // Derivatives of the smoothed section are convolutions with the derivatives of the Gaussian.
  std::vector<double> first, second;
  for (int i = -tail; i <= tail; ++i) {
    const double z = i * step;
    const double bell = std::exp(-0.5 * z * z / (sigma * sigma)) * step / (sigma * std::sqrt(2 * M_PI));
    first.push_back(z / (sigma * sigma) * bell);  // mirrored: the sum below is a correlation
    second.push_back((z * z / (sigma * sigma) - 1) / (sigma * sigma) * bell);
  }

  SmoothedSection smoothed{.first_z_mm = lowest_z_mm + tail * step, .step_mm = step, .curvature_per_mm = {}};
  for (int i = 0; i <= 2 * reach; ++i) {
    double slope = 0, bend = 0;
    for (int k = 0; k <= 2 * tail; ++k) {
      // The middle's offset taken away first: the kernels sum to 0 only up to rounding.
      const double o = offset[static_cast<std::size_t>(i + k)] - offset[static_cast<std::size_t>(i + tail)];
      slope += first[static_cast<std::size_t>(k)] * o;
      bend += second[static_cast<std::size_t>(k)] * o;
    }
    smoothed.curvature_per_mm.push_back(bend / std::pow(1 + slope * slope, 1.5));
  }
  return smoothed;
}

LineHeights line_heights(const std::vector<SmoothedSection>& sections, double spacing_mm,
                         const PlaceDefinition& definition) {
  LineHeights heights;
  for (const auto& section : sections) {
    const Peak peak = largest(section);
    heights.z_mm.push_back(peak.z_mm);
    heights.crease_per_mm.push_back(peak.curvature_per_mm);
  }
  heights.z_mm = running_mean(heights.z_mm, definition.running_mean_mm / spacing_mm);
  return heights;
}

std::vector<TrueLinePoint> true_line(const MadeShoe& shoe, double spacing_mm,
                                     const PlaceDefinition& definition) {
  if (shoe.parameters().bare || shoe.parameters().thing) return {};
  const auto count = static_cast<std::size_t>(std::ceil(shoe.perimeter_mm() / spacing_mm));
  const double step_mm = shoe.perimeter_mm() / static_cast<double>(count);

  std::vector<SmoothedSection> sections;
  for (std::size_t i = 0; i < count; ++i) {
    const Section section = shoe.section(static_cast<double>(i) * step_mm);
    sections.push_back(smoothed_section([&](double z_mm) { return section.offset_mm(z_mm); },
                                        section.line_height_mm(), definition));
  }
  const LineHeights heights = line_heights(sections, step_mm, definition);

  std::vector<TrueLinePoint> line(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double s_mm = static_cast<double>(i) * step_mm;
    line[i] = {.point_shoe = shoe.section(s_mm).point(heights.z_mm[i]),
               .normal_shoe = mean_normal(shoe, s_mm, heights.z_mm[i], definition),
               .s_mm = s_mm,
               .crease_per_mm = heights.crease_per_mm[i]};
  }
  return line;
}

std::vector<TrueLinePoint> carried_line(std::span<const TrueLinePoint> sample_line, const MadeShoe& upper) {
  std::vector<TrueLinePoint> line(sample_line.begin(), sample_line.end());
  for (auto& place : line) {
    const double z_mm = place.point_shoe.z();
    place.point_shoe = upper.section(place.s_mm).point(z_mm);
    place.normal_shoe = mean_normal(upper, place.s_mm, z_mm, {});
    place.crease_per_mm = 0;
  }
  return line;
}

}  // namespace biteline::sim
