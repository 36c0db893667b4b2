// SPDX-License-Identifier: MIT
#include "host/bite_line/place/place_noise.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::bite_line {

TEST_GROUP(PlaceNoise) {
  static constexpr int k_rows = 121;
  static constexpr int k_crease = 60;

  /// Every section is the same hollow.
  static Sections hollow(float bend_per_mm) {
    Sections sections;
    sections.stations = 40;
    sections.rows = k_rows;
    sections.zero_row = k_crease;
    sections.row_mm = 0.05;
    sections.station_mm = 0.5;
    for (int station = 0; station < sections.stations; ++station) {
      for (int row = 0; row < k_rows; ++row) {
        const auto z_mm = static_cast<float>((row - k_crease) * sections.row_mm);
        sections.o_mm.push_back(0.5F * bend_per_mm * z_mm * z_mm);
        sections.known.push_back(Sections::k_seen);
      }
    }
    return sections;
  }
  static PlaceNoise noise_of(const Sections& sections) {
    const std::vector<double> row(static_cast<std::size_t>(sections.stations), k_crease);
    const std::vector<std::uint8_t> visible(row.size(), 1);
    return place_noise(sections, row, visible, 8.5).front();
  }
};

TEST(PlaceNoise, AHollowIsRoundedByHalfItsBendTimesTheSmoothingsVariance) {
  const double sigma_mm = SectionConfig{}.sigma_z_mm, row_mm = SectionConfig{}.row_mm;
  DOUBLES_EQUAL(0.5 * 3 * (sigma_mm * sigma_mm + row_mm * row_mm / 12), noise_of(hollow(3)).round_mm, 1e-5);
  DOUBLES_EQUAL(0, noise_of(hollow(0)).round_mm, 1e-9);
}

TEST(PlaceNoise, WhatWasNotSeenIsNotCalledRound) {
  Sections sections = hollow(3);
  for (int station = 0; station < sections.stations; ++station)
    sections.known[sections.at(station, k_crease)] = Sections::k_filled;
  DOUBLES_EQUAL(0, noise_of(sections).round_mm, 1e-9);
}

}  // namespace biteline::bite_line
