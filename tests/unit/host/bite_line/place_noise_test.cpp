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

TEST(PlaceNoise, ABottomThatWasNotSeenMayLieDeeperThanTheLineThatFillsIt) {
  Sections sections = hollow(3);
  const Sections whole = sections;
  // At one station 0.4 mm to both sides of the crease: a chord lies 0.24 mm outside of its bottom.
  constexpr int k_station = 20, k_reach = 8;
  for (int row = k_crease - k_reach + 1; row < k_crease + k_reach; ++row) {
    sections.o_mm[sections.at(k_station, row)] = whole.o_mm[whole.at(k_station, k_crease + k_reach)];
    sections.known[sections.at(k_station, row)] = Sections::k_filled;
  }
  const std::vector<double> row(static_cast<std::size_t>(sections.stations), k_crease);
  const std::vector<std::uint8_t> visible(row.size(), 1);
  const std::vector<PlaceNoise> sut = place_noise(sections, row, visible, 8.5);
  const double off_mm = 0.5 * 3 * 0.4 * 0.4;
  CHECK_COMPARE(1.96 * sut[k_station].filled_mm, >, off_mm);
  CHECK_COMPARE(sut[k_station].filled_mm, <, off_mm);
  // Sections take in what lies beside them.
  DOUBLES_EQUAL(sut[k_station].filled_mm, sut[k_station + 4].filled_mm, 1e-12);
  DOUBLES_EQUAL(0, sut[k_station + 5].filled_mm, 1e-12);
  DOUBLES_EQUAL(0, place_noise(whole, row, visible, 8.5)[k_station].filled_mm, 1e-12);
  // Where a flank was not seen nobody knows how deep it goes; a slope has no bottom.
  sections.known[sections.at(k_station, k_crease + k_reach + 3)] = Sections::k_nothing;
  DOUBLES_EQUAL(0, place_noise(sections, row, visible, 8.5)[k_station].filled_mm, 1e-12);
}

}  // namespace biteline::bite_line
