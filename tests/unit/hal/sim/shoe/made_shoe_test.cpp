// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/made_shoe.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "hal/sim/shoe/surface_mesh.hpp"

namespace biteline::sim {

namespace {

constexpr std::array k_all_classes{
    ShoeClass::Deep,      ShoeClass::Shallow,  ShoeClass::Step,   ShoeClass::Filled, ShoeClass::Faded,
    ShoeClass::Decorated, ShoeClass::Stitched, ShoeClass::Glossy, ShoeClass::Mixed,  ShoeClass::Bare};

Vec3 facet_normal(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const auto corner = [&](std::size_t k) {
    const auto& v = mesh.vertices[triangle[k]];
    return Vec3(v[0], v[1], v[2]);
  };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

}  // namespace

TEST_GROUP(MadeShoe){};

TEST(MadeShoe, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const MadeShoe a(draw_shoe(ShoeClass::Mixed, 7)), b(draw_shoe(ShoeClass::Mixed, 7)),
      c(draw_shoe(ShoeClass::Mixed, 8));
  for (double s_mm = 0; s_mm < 300; s_mm += 31) {
    const Vec3 point = a.section(s_mm).point(25);
    DOUBLES_EQUAL(0, (point - b.section(s_mm).point(25)).norm(), 0);
    CHECK((point - c.section(s_mm).point(25)).norm() > 0.01);
  }
}

TEST(MadeShoe, IsAsLongAsItsSizeSaysAndOtherwiseTheSame) {
  for (const ShoeClass shoe_class : {ShoeClass::Deep, ShoeClass::Midsole}) {
    const ShoeParameters drawn = draw_shoe(shoe_class, 5),
                         sized = draw_shoe(shoe_class, 5, length_of_size_mm(42));
    DOUBLES_EQUAL(280, sized.outline.length_mm, 1e-9);
    DOUBLES_EQUAL(280, MadeShoe(sized).outline().length_mm(), 1e-9);
    CHECK(drawn.outline.jitter == sized.outline.jitter);
    CHECK(drawn.outline.left_foot == sized.outline.left_foot);
    // The length drawn, told as a size, gives the same shoe.
    const ShoeParameters told = draw_shoe(shoe_class, 5, drawn.outline.length_mm);
    DOUBLES_EQUAL(drawn.upper.top_z_mm, told.upper.top_z_mm, 0);
    DOUBLES_EQUAL(drawn.groove.line_height_mm, told.groove.line_height_mm, 0);
  }
}

TEST(MadeShoe, ClosesOnItself) {
  for (const ShoeClass shoe_class : k_all_classes) {
    const MadeShoe sut(draw_shoe(shoe_class, 3));
    const double line_mm = sut.section(0).line_height_mm();
    for (double z_mm = 1; z_mm < sut.section(0).top_z_mm(); z_mm += 0.7) {
      const Vec3 begin = sut.section(0).point(z_mm), end = sut.section(sut.perimeter_mm()).point(z_mm);
      DOUBLES_EQUAL(0, (begin - end).norm(), 1e-6);
    }
    DOUBLES_EQUAL(line_mm, sut.section(sut.perimeter_mm()).line_height_mm(), 1e-9);
  }
}

TEST(MadeShoe, EveryClassIsAShoeOfASizeThatOccursWithAWallThatNeverCrossesItself) {
  for (const ShoeClass shoe_class : k_all_classes) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const MadeShoe sut(draw_shoe(shoe_class, seed));
      CHECK(sut.outline().length_mm() >= 150 && sut.outline().length_mm() <= 330);
      for (double s_mm = 0; s_mm < sut.perimeter_mm(); s_mm += 5) {
        const Section section = sut.section(s_mm);
        CHECK(section.line_height_mm() > 12 && section.line_height_mm() < section.top_z_mm() - 15);
        for (double z_mm = 0; z_mm <= section.top_z_mm(); z_mm += 1.5) {
          // Neighbouring sections meet where the offset reaches the outline's centre of curvature.
          CHECK(1 + section.place().curvature_per_mm * section.offset_mm(z_mm) > 0.05);
        }
      }
    }
  }
}

TEST(MadeShoe, NormalAgreesWithAFineMesh) {
  const MadeShoe sut(draw_shoe(ShoeClass::Stitched, 5));
  constexpr double k_step_mm = 0.004;
  for (double s_mm = 3; s_mm < sut.perimeter_mm(); s_mm += 23.7) {
    const double line_z_mm = sut.section(s_mm).line_height_mm();
    for (double z_mm = line_z_mm - 6; z_mm < line_z_mm + 20; z_mm += 1.9) {
      const Vec3 along =
          sut.section(s_mm + k_step_mm).point(z_mm) - sut.section(s_mm - k_step_mm).point(z_mm);
      const Vec3 up = sut.section(s_mm).point(z_mm + k_step_mm) - sut.section(s_mm).point(z_mm - k_step_mm);
      const Vec3 expected = along.cross(up).normalized();
      DOUBLES_EQUAL(0, expected.cross(sut.normal(s_mm, z_mm)).norm(), 2e-3);
      CHECK(expected.dot(sut.normal(s_mm, z_mm)) > 0);
    }
  }
}

TEST(MadeShoe, BareUpperFollowsItsSampleAboveTheLineWithinTheLastsDifference) {
  const ShoeParameters sample = draw_shoe(ShoeClass::Deep, 11);
  constexpr double k_difference_mm = 0.15;
  const MadeShoe with_sole(sample), bare(bare_upper_of(sample, k_difference_mm, 4));
  double square_sum = 0;
  int count = 0;
  for (double s_mm = 0; s_mm < bare.perimeter_mm(); s_mm += 2) {
    const double z_mm = with_sole.section(s_mm).line_height_mm() + 15;
    const double difference_mm = bare.section(s_mm).offset_mm(z_mm) - with_sole.section(s_mm).offset_mm(z_mm);
    square_sum += difference_mm * difference_mm;
    ++count;
  }
  DOUBLES_EQUAL(k_difference_mm, std::sqrt(square_sum / count), 0.01);
}

TEST(MadeShoe, MeshIsWatertightAroundAndLooksOutwards) {
  const MadeShoe shoe(draw_shoe(ShoeClass::Decorated, 2));
  const SurfaceMesh sut =
      mesh_of(shoe, {.column_mm = 3, .fine_row_mm = 0.5, .fine_band_mm = 4, .coarse_row_mm = 3});
  LONGS_EQUAL(sut.vertices.size(), sut.looks.size());
  // Divergence theorem: the flux of (x, y, 0) / 2 through the wall is the enclosed volume, about area times
  // height.
  double volume_mm3 = 0;
  for (const auto& triangle : sut.triangles) {
    const auto& v = sut.vertices[triangle[0]];
    volume_mm3 += 0.25 * Vec3(v[0], v[1], 0).dot(facet_normal(sut, triangle));
  }
  const double box_mm3 =
      shoe.outline().length_mm() * 0.35 * shoe.outline().length_mm() * shoe.section(0).top_z_mm();
  CHECK(volume_mm3 > 0.5 * box_mm3 && volume_mm3 < 1.1 * box_mm3);
}

TEST(MadeShoe, MeshStaysOnTheExactSurfaceNearTheLine) {
  const MadeShoe shoe(draw_shoe(ShoeClass::Deep, 2));
  const MeshFineness fineness{.column_mm = 20, .fine_row_mm = 0.06, .fine_band_mm = 4.5, .coarse_row_mm = 5};
  const SurfaceMesh sut = mesh_of(shoe, fineness);
  // Middle of each upright edge in the first column against the section there.
  const Section section = shoe.section(0);
  for (std::size_t row = 0; row < 150; ++row) {
    const Vec3 a(sut.vertices[row][0], sut.vertices[row][1], sut.vertices[row][2]);
    const Vec3 b(sut.vertices[row + 1][0], sut.vertices[row + 1][1], sut.vertices[row + 1][2]);
    if (std::abs(a.z() - section.line_height_mm()) > 4) continue;
    constexpr double k_largest_bend_per_mm = 12;  // o'' at the lip: step / (10 lip_width^2) and the valley's
    DOUBLES_EQUAL(0, ((a + b) / 2 - section.point((a.z() + b.z()) / 2)).norm(),
                  0.06 * 0.06 * k_largest_bend_per_mm / 8 + 1e-4);
  }
}

}  // namespace biteline::sim
