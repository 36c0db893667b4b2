// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/designed_shoe.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/true_line.hpp"

namespace biteline::sim {

namespace {

ShoeClass designed_class(std::size_t i) {
  return static_cast<ShoeClass>(k_first_designed + i % (k_first_thing - k_first_designed));
}

/// Every class with every decoy, two seeds.
template <class Check>
void for_each_designed(Check&& check) {
  for (std::size_t i = 0; i < k_first_thing - k_first_designed; ++i) {
    for (std::size_t d = 0; d < k_decoy_names.size(); ++d) {
      for (const std::uint64_t seed : {1U, 2U}) {
        check(draw_designed_shoe({.shoe_class = designed_class(i), .decoy = static_cast<Decoy>(d)}, seed));
      }
    }
  }
}

}  // namespace

TEST_GROUP(DesignedShoe){};

TEST(DesignedShoe, IsASurfaceThatNeverCrossesItselfWithALineBetweenBottomAndTop) {
  for_each_designed([](const ShoeParameters& parameters) {
    const MadeShoe sut(parameters);
    for (double s_mm = 0; s_mm < sut.perimeter_mm(); s_mm += 5) {
      const Section section = sut.section(s_mm);
      CHECK(section.line_height_mm() > section.bottom_z_mm() + 3);
      CHECK(section.line_height_mm() < section.top_z_mm() - 8);
      for (double z_mm = section.bottom_z_mm(); z_mm <= section.line_height_mm() + 6; z_mm += 1) {
        // Neighbouring sections meet where the offset reaches the outline's centre of curvature.
        CHECK(1 + section.place().curvature_per_mm * section.offset_mm(z_mm) > 0.05);
      }
    }
  });
}

TEST(DesignedShoe, ADecoyLeavesTheLineWhereItIs) {
  // The same shoe without it: a decoy 4 mm away changes the curvature at the line by its soft edge's tail
  // only. An overlay of the upper that reaches under the sole's edge lies below both and shifts neither.
  constexpr double k_tail_mm = 0.25;
  for (std::size_t i = 0; i < k_first_thing - k_first_designed; ++i) {
    for (const Decoy decoy : {Decoy::Ledge, Decoy::StitchGroove, Decoy::Welt, Decoy::MultiPart}) {
      const ShoeParameters with = draw_designed_shoe({.shoe_class = designed_class(i), .decoy = decoy}, 3);
      ShoeParameters without = with;
      without.sole.reliefs.clear();
      const auto a = true_line(MadeShoe(with), 10), b = true_line(MadeShoe(without), 10);
      for (std::size_t k = 0; k < a.size(); ++k)
        DOUBLES_EQUAL(b[k].point_shoe.z(), a[k].point_shoe.z(), k_tail_mm);
    }
  }
}

TEST(DesignedShoe, CarriesItsDecoyBelowOrAboveTheLine) {
  // A cupsole is high enough for every one.
  for (std::size_t d = 1; d < k_decoy_names.size(); ++d) {
    const auto decoy = static_cast<Decoy>(d);
    const ShoeParameters plain = draw_designed_shoe({.decoy = Decoy::None}, 5);
    const MadeShoe with(draw_designed_shoe({.decoy = decoy}, 5)), without(plain);
    double most_mm = 0;
    for (double s_mm = 0; s_mm < with.perimeter_mm(); s_mm += 1) {
      const Section a = with.section(s_mm), b = without.section(s_mm);
      for (double z_mm = 1; z_mm < a.top_z_mm(); z_mm += 0.5)
        most_mm = std::max(most_mm, std::abs(a.offset_mm(z_mm) - b.offset_mm(z_mm)));
    }
    CHECK_TEXT(most_mm > 0.2, k_decoy_names[d].data());
  }
}

TEST(DesignedShoe, ComesInBothFeetAndAllSizes) {
  std::set<bool> feet;
  double shortest_mm = 1e9, longest_mm = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const ShoeParameters shoe = draw_designed_shoe({.shoe_class = ShoeClass::Midsole}, seed);
    feet.insert(shoe.outline.left_foot);
    shortest_mm = std::min(shortest_mm, shoe.outline.length_mm);
    longest_mm = std::max(longest_mm, shoe.outline.length_mm);
  }
  LONGS_EQUAL(2, feet.size());
  CHECK(shortest_mm >= 90 && shortest_mm < 100);
  CHECK(longest_mm <= 350 && longest_mm > 340);
}

TEST(DesignedShoe, OfOneColourGivesTheStripeNothingToTellSoleAndUpperBy) {
  const MadeShoe one(
      draw_designed_shoe({.shoe_class = ShoeClass::Midsole, .materials = Materials::OneColour}, 4));
  const MadeShoe two(
      draw_designed_shoe({.shoe_class = ShoeClass::Midsole, .materials = Materials::Contrast}, 4));
  const auto difference = [](const MadeShoe& shoe) {
    const Material& upper = shoe.parameters().reflectance.upper;
    const Material& sole = shoe.parameters().reflectance.sole;
    return std::abs(upper.diffuse_ratio - sole.diffuse_ratio) +
           std::abs(upper.grain_ratio - sole.grain_ratio);
  };
  DOUBLES_EQUAL(0, difference(one), 0);
  CHECK(difference(two) > 0);
}

TEST(DesignedShoe, PaintColoursALedgeAndLeavesTheShapeAlone) {
  const DesignedShoe ledge{
      .shoe_class = ShoeClass::Cupsole, .decoy = Decoy::Ledge, .materials = Materials::OneColour};
  DesignedShoe painted = ledge;
  painted.painted = true;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const MadeShoe plain(draw_designed_shoe(ledge, seed)), sut(draw_designed_shoe(painted, seed));
    std::set<double> plain_looks, looks;
    for (double s_mm = 0; s_mm < sut.perimeter_mm(); s_mm += 20) {
      const Section section = sut.section(s_mm), plain_section = plain.section(s_mm);
      for (double z_mm = section.bottom_z_mm(); z_mm < section.line_height_mm(); z_mm += 0.5) {
        DOUBLES_EQUAL(plain_section.offset_mm(z_mm), section.offset_mm(z_mm), 0);
        plain_looks.insert(plain_section.look(z_mm).scattering_mm + plain_section.look(z_mm).diffuse_ratio);
        looks.insert(section.look(z_mm).scattering_mm + section.look(z_mm).diffuse_ratio);
      }
    }
    const bool has_ledge = std::ranges::any_of(sut.parameters().sole.reliefs, [](const Relief& relief) {
      return relief.kind == Relief::Kind::Ledge || relief.kind == Relief::Kind::Band;
    });
    CHECK_EQUAL(has_ledge, plain_looks != looks);
  }
}

TEST(DesignedShoe, AThingHasAWallAllRoundAndNoLine) {
  for (std::size_t c = k_first_thing; c < k_shoe_class_names.size(); ++c) {
    const MadeShoe sut(draw_thing(static_cast<ShoeClass>(c), 7));
    CHECK(true_line(sut, 5).empty());
    for (double s_mm = 0; s_mm < sut.perimeter_mm(); s_mm += 3) {
      const Section section = sut.section(s_mm);
      CHECK(section.top_z_mm() > section.bottom_z_mm() + 5);
      CHECK(std::isfinite(section.offset_mm(0.5 * section.top_z_mm())));
    }
  }
}

}  // namespace biteline::sim
