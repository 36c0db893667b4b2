// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/bite_line/place/placement.hpp"
#include "host/bite_line/place/point_spread.hpp"
#include "host/bite_line/place/ridge.hpp"
#include "host/bite_line/place/sections.hpp"
#include "tests/unit/host/bite_line/drum.hpp"

namespace biteline::bite_line {
namespace {

constexpr double k_z_mm = 25;

/// Sections of a wall along a level path at k_z_mm.
template <class O>
Sections sections_of(O&& o_mm) {
  const Outline outline = test::egg_outline();
  const auto points =
      test::drum_points(outline, o_mm, {.s_mm = 0.5, .z_mm = 0.05, .z_begin_mm = 18, .z_end_mm = 34});
  const std::vector<double> path_z(static_cast<std::size_t>(outline.length_mm() / 0.5), k_z_mm);
  return SectionPoints{{.points = points, .outline = outline, .path_z_mm = path_z}, {}}.cut(1.0);
}

int row_at(const Sections& sections, double above_path_mm) {
  return sections.zero_row + static_cast<int>(std::lround(above_path_mm / sections.row_mm));
}

template <class O>
PlacedLine placed(O&& o_mm, double profiles_mm = 0.7, double path_z_mm = k_z_mm) {
  const Side side =
      test::drum_side(o_mm, {.s_mm = profiles_mm, .z_mm = 0.1, .z_begin_mm = 10, .z_end_mm = 40});
  const SideGrid& grid = side.field.grid;
  // As a crease's path would be: on the grid's row, up to half of one off.
  const std::vector<double> path_row(static_cast<std::size_t>(grid.cols),
                                     std::floor((path_z_mm - grid.z_low_mm) / grid.row_mm));
  PooledVector<Eigen::Vector3f> near;
  for (const std::uint32_t i : near_path(side.field, path_row)) near.push_back(side.shoe.points[i]);
  return place_line({.near = near,
                     .points_per_mm2 = side.field.points_per_mm2,
                     .field = side.field,
                     .outline = side.outline,
                     .path = curve_of(side.field, side.outline, path_row, 0.5)},
                    {});
}

}  // namespace

TEST_GROUP(Sections){void teardown() override{test::forgive_underflow();
}  // namespace biteline::bite_line
}
;

TEST(Sections, TheyAreTheSurfaceWhereItWasSeen) {
  const auto o_of = [](double, double z) { return 0.2 * (z - k_z_mm) + test::groove_mm(z, k_z_mm); };
  const Sections sut = sections_of(o_of);
  for (int station = 0; station < sut.stations; station += 11) {
    for (double above = -3; above <= 5; above += 0.5) {
      const std::size_t cell = sut.at(station, row_at(sut, above));
      CHECK(sut.known[cell] == Sections::k_seen);
      DOUBLES_EQUAL(o_of(0, k_z_mm + above), sut.o_mm[cell], 0.03);
    }
  }
}

TEST(Sections, AShortShadowIsFilledAndALongOneIsNot) {
  const auto shadow = [](double z, double above, double length) {
    return z > k_z_mm + above && z < k_z_mm + above + length;
  };
  const Sections sut = sections_of(
      [&](double, double z) { return shadow(z, -2.5, 1.0) || shadow(z, 1.5, 2.5) ? test::k_no_point : 0.0; });
  CHECK(sut.known[sut.at(100, row_at(sut, -2.0))] == Sections::k_filled);
  CHECK(sut.known[sut.at(100, row_at(sut, 2.7))] == Sections::k_nothing);
  CHECK(sut.known[sut.at(100, row_at(sut, 0.0))] == Sections::k_seen);
}

TEST(Sections, AShadowAcrossAFlatSlopeIsAsLongAsItIsLevel) {
  // The surface goes in by 6 mm over one of height, and that was not seen.
  const Sections sut = sections_of([](double, double z) {
    const double above = z - k_z_mm;
    if (above > 0 && above < 1) return test::k_no_point;
    return above <= 0 ? 3.0 : -3.0;
  });
  CHECK(sut.known[sut.at(100, row_at(sut, 0.5))] == Sections::k_nothing);
}

TEST(Sections, WhatStandsInFrontOfTheWallEndsThem) {
  // A pin 6 mm off the wall hides what lies lower than a millimetre above the path.
  const auto pin = [](double s) { return s > 100 && s < 106; };
  const Sections sut = sections_of([&](double s, double z) { return pin(s) && z < k_z_mm + 1 ? 6.0 : 0.0; });
  const int behind = static_cast<int>(103 / sut.station_mm);
  CHECK(sut.known[sut.at(behind, row_at(sut, 0.5))] == Sections::k_nothing);
  CHECK(sut.known[sut.at(behind, row_at(sut, -3))] == Sections::k_nothing);
  CHECK(sut.known[sut.at(behind, row_at(sut, 2))] == Sections::k_seen);
  CHECK(sut.known[sut.at(static_cast<int>(120 / sut.station_mm), row_at(sut, -3))] == Sections::k_seen);
}

TEST(Sections, ALedgeThatWasSeenEndsNone) {
  const Sections sut =
      sections_of([](double, double z) { return 6.0 * std::clamp((k_z_mm - z) / 0.3, 0.0, 1.0); });
  CHECK(sut.known[sut.at(100, row_at(sut, -3))] == Sections::k_seen);
}

TEST(Sections, CurvatureOfAParabolaIsItsOwn) {
  constexpr double k_per_mm = 0.2;
  const Sections sections =
      sections_of([](double, double z) { return 0.5 * k_per_mm * std::pow(z - k_z_mm, 2); });
  const PooledVector<float> sut = section_curvature(sections, 0.4);
  for (int station = 0; station < sections.stations; station += 11) {
    for (const double above : {-1.0, 0.0, 1.0}) {
      const double slope = k_per_mm * above;
      DOUBLES_EQUAL(k_per_mm / std::pow(1 + slope * slope, 1.5),
                    sut[sections.at(station, row_at(sections, above))], 0.1 * k_per_mm);
    }
  }
}

TEST_GROUP(Ridge){void teardown() override{test::forgive_underflow();
}
}
;

TEST(Ridge, AWavyGrooveIsFollowedToATenthOfARow) {
  const double length_mm = test::egg_outline().length_mm();
  const auto z_of = [&](double s) { return k_z_mm + 0.8 * std::sin(4 * std::numbers::pi * s / length_mm); };
  const Sections sections = sections_of([&](double s, double z) { return test::groove_mm(z, z_of(s)); });
  const Ridge sut = follow_ridge(sections, section_curvature(sections, 0.4), 2.5);
  for (int station = 0; station < sections.stations; ++station) {
    const auto i = static_cast<std::size_t>(station);
    CHECK(sut.visible[i] != 0);
    DOUBLES_EQUAL(z_of(station * sections.station_mm), k_z_mm + sections.z_mm(sut.row[i]), 0.03);
  }
}

TEST(Ridge, ASpeckBesideTheGrooveDoesNotDrawItAway) {
  // 2 mm above the groove, over 2 mm of its length, as sharp a dent as the groove itself.
  const Sections sections = sections_of([](double s, double z) {
    const double speck = s > 200 && s < 202 ? test::groove_mm(z, k_z_mm + 2) : 0.0;
    return 0.6 * test::groove_mm(z, k_z_mm) + speck;
  });
  const Ridge sut = follow_ridge(sections, section_curvature(sections, 0.4), 2.5);
  for (const double row : sut.row) DOUBLES_EQUAL(0, sections.z_mm(row), 0.1);
}

TEST(Ridge, AnotherHollowBesideTheGrooveIsTold) {
  const Sections sections = sections_of([](double, double z) {
    return test::groove_mm(z, k_z_mm - 0.8) + 0.5 * test::groove_mm(z, k_z_mm + 1.4);
  });
  const Ridge sut = follow_ridge(sections, section_curvature(sections, 0.4), 2.5);
  for (std::size_t i = 0; i < sut.row.size(); ++i) {
    DOUBLES_EQUAL(-0.8, sections.z_mm(sut.row[i]), 0.1);
    DOUBLES_EQUAL(0.5, sut.other_k_per_mm[i] / sut.k_per_mm[i], 0.1);
    DOUBLES_EQUAL(std::hypot(2.2, 0.5), sut.other_mm[i], 0.15);
  }
}

TEST(Ridge, AHollowThatTheWallAboveHidesIsNone) {
  // Strays 3 mm behind the wall, as of a lining: no camera looks into a slit that is so much deeper than
  // high.
  const auto slit = [](double deep_mm) {
    return sections_of([=](double s, double z) {
      const bool behind = s > 200 && s < 204 && std::abs(z - k_z_mm - 1.4) < 0.3;
      return test::groove_mm(z, k_z_mm - 0.8) - (behind ? deep_mm : 0);
    });
  };
  const auto told = [](const Sections& sections) {
    const Ridge sut = follow_ridge(sections, section_curvature(sections, 0.4), 2.5);
    return sut.other_k_per_mm[static_cast<std::size_t>(202 / sections.station_mm)];
  };
  CHECK_COMPARE(told(slit(0.6)), >, 0.5);
  CHECK_COMPARE(told(slit(3)), <, 0.3);
}

TEST(Ridge, ACreaseInTheShorterPartOfASectionIsSeen) {
  // As on a glossy shoe: neither the groove's upper flank nor the top of its sole was seen.
  Sections sections = sections_of([](double, double z) { return test::groove_mm(z, k_z_mm); });
  for (int station = 0; station < sections.stations; ++station) {
    for (int row = 0; row < sections.rows; ++row) {
      const double above_mm = sections.z_mm(row);
      if (above_mm < -1.4 || (above_mm > 1.4 && above_mm < 3)) sections.known[sections.at(station, row)] = 0;
    }
  }
  const Ridge sut = follow_ridge(sections, section_curvature(sections, 0.4), 2.5);
  for (std::size_t i = 0; i < sut.row.size(); ++i) {
    CHECK(sut.visible[i] != 0);
    DOUBLES_EQUAL(0, sections.z_mm(sut.row[i]), 0.1);
  }
}

TEST(Ridge, NothingIsVisibleOnAPlainWall) {
  const Sections sections = sections_of([](double, double z) { return 0.2 * (z - k_z_mm); });
  const Ridge sut = follow_ridge(sections, section_curvature(sections, 0.4), 2.5);
  LONGS_EQUAL(0, std::count(sut.visible.begin(), sut.visible.end(), 1));
}

TEST_GROUP(Placement){void teardown() override{test::forgive_underflow();
}
}
;

TEST(Placement, OfTwoHollowsThatAreAsSharpNeitherIsSure) {
  const auto beside = [](double depth) {
    return placed([=](double, double z) {
      return test::groove_mm(z, k_z_mm - 0.8) + depth * test::groove_mm(z, k_z_mm + 1.2);
    });
  };
  for (const PlacedStation& station : beside(0.5).points) CHECK_COMPARE(station.hold, >, 0.99);
  for (const PlacedStation& station : beside(0.99).points) {
    CHECK_COMPARE(station.hold, <, 0.7);
    DOUBLES_EQUAL(2.0, station.other_mm, 0.2);
  }
}

TEST(Placement, TheLineLiesWhereTheSectionTurnsMost) {
  const PlacedLine sut = placed([](double, double z) { return test::groove_mm(z, k_z_mm + 0.4); });
  const Outline outline = test::egg_outline();
  DOUBLES_EQUAL(0, sut.bridged_mm, 1e-9);
  for (const PlacedStation& station : sut.points) {
    DOUBLES_EQUAL(k_z_mm + 0.4, station.position.z(), 0.02);
    // 0.06 mm of height are merged into one row: the bottom of a groove of 0.6 mm is that much less deep.
    const OutlinePlace place = outline.locate(station.position.cast<float>());
    DOUBLES_EQUAL(-1.0, place.o_mm, 0.03);
    DOUBLES_EQUAL(0, station.doubt, 1e-9);
  }
}

TEST(Placement, FewPointsTellHowFarTheLineMayBeOff) {
  // A groove 2.5 mm deep of which one place in ten was seen, here and there: one point per square millimetre.
  const auto groove = [](double z) { return 2.5 * test::groove_mm(z, k_z_mm); };
  std::uint32_t drawn = 1;
  const auto few = [&](double, double z) {
    drawn = drawn * 1664525U + 1013904223U;
    return drawn >> 16U < 6554U ? groove(z) : test::k_no_point;
  };
  const Outline outline = test::egg_outline();
  const auto off_of = [&](const PlacedStation& station) {
    return static_cast<double>(outline.locate(station.position.cast<float>()).o_mm) - groove(k_z_mm);
  };
  const PlacedLine sut = placed(few, 1.0);
  double off_mm2 = 0, told_mm2 = 0;
  std::size_t held = 0;
  for (const PlacedStation& station : sut.points) {
    const double off_mm = off_of(station);
    off_mm2 += off_mm * off_mm;
    told_mm2 += station.few_out_mm * station.few_out_mm;
    held += std::abs(off_mm) <= 1.96 * station.few_out_mm ? 1U : 0U;
  }
  const auto count = static_cast<double>(sut.points.size());
  // There is something to tell, and the groove's bottom is not taken for what lies behind its flanks.
  CHECK_COMPARE(std::sqrt(off_mm2 / count), >, 0.05);
  CHECK_COMPARE(std::sqrt(off_mm2 / count), <, 0.2);
  CHECK_COMPARE(told_mm2, >, 0.7 * off_mm2);
  CHECK_COMPARE(static_cast<double>(held), >, 0.85 * count);
  for (const PlacedStation& station : placed([&](double, double z) { return groove(z); }).points) {
    DOUBLES_EQUAL(0, station.few_out_mm, 1e-12);
  }
}

TEST(Placement, NormalsAreThoseOfTheWallAboveTheLine) {
  // The wall leans by a fifth from 1 mm above the line on; 2 to 6 mm above are what counts.
  const PlacedLine sut = placed(
      [](double, double z) { return test::groove_mm(z, k_z_mm) - 0.2 * std::max(0.0, z - k_z_mm - 1); });
  const Outline outline = test::egg_outline();
  for (const PlacedStation& station : sut.points) {
    const Vec2 out = outline.normal(static_cast<double>(outline.locate(station.position.cast<float>()).s_mm));
    const Vec3 truth = Vec3{out.x(), out.y(), 0.2}.normalized();
    CHECK_COMPARE(truth.dot(station.normal), >, std::cos(1.0 * std::numbers::pi / 180));
  }
}

TEST(Placement, AMissingSectorIsBridgedAndDoubted) {
  constexpr double k_from_mm = 180, k_to_mm = 210;
  const PlacedLine sut = placed([](double s, double z) {
    return s > k_from_mm && s < k_to_mm ? test::k_no_point : test::groove_mm(z, k_z_mm);
  });
  DOUBLES_EQUAL(k_to_mm - k_from_mm, sut.bridged_mm, 4);
  const Outline outline = test::egg_outline();
  const Vec2 middle = outline.point(0.5 * (k_from_mm + k_to_mm));
  double most_doubt = 0, most_corner_mm = 0;
  for (const PlacedStation& station : sut.points) {
    const double away = (station.position.head<2>() - middle).norm();
    if (away < 8) most_doubt = std::max(most_doubt, station.doubt);
    if (away < 8) most_corner_mm = std::max(most_corner_mm, station.corner_mm);
    if (away > 30) DOUBLES_EQUAL(0, station.doubt, 1e-9);
    if (away > 30) DOUBLES_EQUAL(0, station.corner_mm, 1e-9);
    DOUBLES_EQUAL(k_z_mm, station.position.z(), 0.1);
  }
  CHECK_COMPARE(most_doubt, >, 0.05);
  CHECK_COMPARE(most_corner_mm, >, 0.1);
}

TEST(Placement, WhereNoCreaseWasSeenAtAllNoPointIsSure) {
  const PlacedLine sut = placed([](double, double z) { return 0.2 * (z - k_z_mm); });
  for (const PlacedStation& station : sut.points) DOUBLES_EQUAL(0, within_of(station), 1e-6);
}

TEST(Placement, WhereEndsAreNotFirmABridgeIsUnsureFromItsFirstMillimetresOn) {
  // The toe is gone, and 5 mm before it another 10 mm: no end of the gap has the length that tells a
  // direction.
  const Outline outline = test::egg_outline();
  const double toe_mm = outline.locate({280.0F, 0.0F, 20.0F}).s_mm;
  const auto of_toe = [&](double s) {
    const double away = std::abs(s - toe_mm);
    return std::min(away, outline.length_mm() - away);
  };
  const PlacedLine sut = placed([&](double s, double z) {
    const double away = of_toe(s);
    return away < 15 || (away > 20 && away < 30) ? test::k_no_point : test::groove_mm(z, k_z_mm);
  });
  double least_mm = 1e9;
  for (const PlacedStation& station : sut.points) {
    const double away = of_toe(outline.locate(station.position.cast<float>()).s_mm);
    if (away > 8 && away < 11) least_mm = std::min(least_mm, station.corner_mm);
  }
  // The ends' directions meet at some 100 degrees: 5 mm from an end the line may be as far off its chord.
  CHECK_COMPARE(least_mm, >, 3.0);
  CHECK_COMPARE(least_mm, <, 10.0);
}

TEST(Placement, WhereASurfaceWasSeenAndHasNoCreaseALongBridgeIsUnsure) {
  // Such bridges do well elsewhere on this line, but there it has a crease: by that alone 0.999.
  constexpr double k_middle_mm = 195;
  const auto within_middle = [&](double length_mm) {
    const PlacedLine sut = placed([&](double s, double z) {
      return std::abs(s - k_middle_mm) < length_mm / 2 ? 0.0 : test::groove_mm(z, k_z_mm);
    });
    const Vec2 middle = test::egg_outline().point(k_middle_mm);
    const auto away = [&](const PlacedStation& a) { return (a.position.head<2>() - middle).norm(); };
    return within_of(*std::min_element(sut.points.begin(), sut.points.end(),
                                       [&](const auto& a, const auto& b) { return away(a) < away(b); }));
  };
  CHECK_COMPARE(within_middle(12), >, 0.9);
  CHECK_COMPARE(within_middle(50), <, 0.6);
}

TEST(Placement, AShortGapBesideALongOneTakesNoDirectionFromItsEnd) {
  // As above, but 3 mm are gone before the toe: straight across the toe the line would be 5 mm off.
  const Outline outline = test::egg_outline();
  const double toe_mm = outline.locate({280.0F, 0.0F, 20.0F}).s_mm;
  const PlacedLine sut = placed([&](double s, double z) {
    const double about = std::abs(s - toe_mm);
    const double away = std::min(about, outline.length_mm() - about);
    return away < 15 || (away > 20 && away < 23) ? test::k_no_point : test::groove_mm(z, k_z_mm);
  });
  for (const PlacedStation& station : sut.points)
    DOUBLES_EQUAL(-1.0, outline.locate(station.position.cast<float>()).o_mm, 1.0);
}

TEST(Placement, ABridgeDoesNotLeanOnTheLastProfileBesideIt) {
  constexpr double k_from_mm = 180, k_to_mm = 210, k_skewed_mm = 0.7;
  const PlacedLine sut = placed(
      [](double s, double z) {
        if (s > k_from_mm && s < k_to_mm) return test::k_no_point;
        const bool skewed = s > k_from_mm - 0.6 && s <= k_from_mm;
        return test::groove_mm(z, k_z_mm - (skewed ? k_skewed_mm : 0.0));
      },
      0.5);
  const Vec2 middle = test::egg_outline().point(0.5 * (k_from_mm + k_to_mm));
  for (const PlacedStation& station : sut.points)
    if ((station.position.head<2>() - middle).norm() < 10)
      DOUBLES_EQUAL(k_z_mm, station.position.z(), 0.95);  // 1.11 where it leans on the last one
}

TEST(Placement, ACreaseBehindAPinIsBridgedAndNotTheWallAboveThePin) {
  constexpr double k_path_above_mm = 1.5;
  const auto pin = [](double s) { return s > 190 && s < 198; };
  const PlacedLine sut = placed(
      [&](double s, double z) { return pin(s) && z < k_z_mm + 1.2 ? 6.0 : test::groove_mm(z, k_z_mm); }, 0.7,
      k_z_mm + k_path_above_mm);
  CHECK_COMPARE(sut.bridged_mm, >, 8);
  CHECK_COMPARE(sut.bridged_mm, <, 16);
  CHECK_COMPARE(sut.thing_beside_mm, >, 8);
  CHECK_COMPARE(sut.thing_beside_mm, <, 16);
  const Outline outline = test::egg_outline();
  for (const PlacedStation& station : sut.points) {
    DOUBLES_EQUAL(k_z_mm, station.position.z(), 0.1);
    DOUBLES_EQUAL(-1.0, outline.locate(station.position.cast<float>()).o_mm, 0.1);
  }
}

TEST(Placement, WhereNoCreaseWasSeenTheLineKeepsToTheHoleInTheSections) {
  // The crease sinks by 1.5 mm within a shadow that is 2 mm high; a smooth bridge would run above it.
  constexpr double k_from_mm = 180, k_to_mm = 210, k_sunk_mm = 1.5, k_hole_mm = 2.0;
  const auto crease = [](double s) {
    const double share = std::clamp((s - k_from_mm) / (k_to_mm - k_from_mm), 0.0, 1.0);
    return k_z_mm - k_sunk_mm * std::pow(std::sin(std::numbers::pi * share), 2);
  };
  const auto hidden = [&](double s, double z) {
    return s > k_from_mm && s < k_to_mm && std::abs(z - crease(s)) < 0.5 * k_hole_mm;
  };
  const PlacedLine sut = placed([&](double s, double z) {
    return hidden(s, z) ? test::k_no_point : test::groove_mm(z, crease(s)) + (z < crease(s) ? 1.5 : 0.0);
  });
  const Vec2 middle = test::egg_outline().point(0.5 * (k_from_mm + k_to_mm));
  for (const PlacedStation& station : sut.points) {
    if ((station.position.head<2>() - middle).norm() < 2)
      // The running mean lifts the bottom of the arch by an eighth of a millimetre.
      CHECK_COMPARE(station.position.z(), <, k_z_mm - k_sunk_mm + 0.5 * k_hole_mm + 0.15);
  }
}

}  // namespace biteline::bite_line
