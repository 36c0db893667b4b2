// SPDX-License-Identifier: MIT
#include "hal/sim/shoe/worked_band.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/true_line.hpp"

namespace biteline::sim {

TEST_GROUP(WorkedBand) {
  ShoeParameters parameters = bare_upper_of(draw_shoe(ShoeClass::Deep, 4101), 0, 0);
  MadeShoe unworked{parameters};
  std::vector<TrueLinePoint> line =
      carried_line(true_line(MadeShoe{draw_shoe(ShoeClass::Deep, 4101)}, 0.5), unworked);

  MadeShoe worked(const BandPlan& plan, const Film& film) {
    ShoeParameters changed = parameters;
    changed.worked = lay_band(unworked, line, plan, film);
    return MadeShoe{changed};
  }
  const TrueLinePoint& at(double s_mm) const {
    return line[static_cast<std::size_t>(s_mm / unworked.perimeter_mm() * static_cast<double>(line.size()))];
  }
  /// How much the film raises the wall at a place, mm.
  double raised_mm(const MadeShoe& shoe, double s_mm, double above_line_mm) const {
    const double z_mm = at(s_mm).point_shoe.z() + above_line_mm;
    return shoe.section(s_mm).offset_mm(z_mm) - unworked.section(s_mm).offset_mm(z_mm);
  }
};

TEST(WorkedBand, RaisesTheWallInsideTheBandAlone) {
  const MadeShoe sut = worked({.offset_mm = 4, .width_mm = 6}, {.height_mm = 0.2});
  DOUBLES_EQUAL(0.2, raised_mm(sut, 100, 4), 1e-9);
  DOUBLES_EQUAL(0, raised_mm(sut, 100, 0.5), 1e-12);
  DOUBLES_EQUAL(0, raised_mm(sut, 100, 9), 1e-12);
}

TEST(WorkedBand, IsAsWideOnTheSurfaceAsPlanned) {
  const MadeShoe sut = worked({.offset_mm = 4, .width_mm = 6}, {.height_mm = 0.2});
  const BandHere here = band_at(*sut.parameters().worked, line[200].s_mm);
  const Section section = unworked.section(line[200].s_mm);
  const double width_mm = (section.point(here.edges.high_z_mm) - section.point(here.edges.low_z_mm)).norm();
  DOUBLES_EQUAL(6, width_mm, 0.05);  // the wall bends by a twentieth of a radian over it
}

TEST(WorkedBand, GapHasNoFilmAndDoubleHasTwo) {
  const MadeShoe sut = worked({.offset_mm = 4,
                               .width_mm = 6,
                               .faults = {{.kind = WorkFault::Kind::Gap, .s_mm = 100, .length_mm = 4},
                                          {.kind = WorkFault::Kind::Double, .s_mm = 200, .length_mm = 4}}},
                              {.height_mm = 0.2});
  DOUBLES_EQUAL(0, raised_mm(sut, 100, 4), 1e-12);
  DOUBLES_EQUAL(0.2, raised_mm(sut, 103, 4), 1e-9);
  DOUBLES_EQUAL(0.4, raised_mm(sut, 200, 4), 1e-9);
}

TEST(WorkedBand, NarrowEdgeAndDropLieWhereTheyAreMade) {
  const MadeShoe sut = worked(
      {.offset_mm = 4,
       .width_mm = 6,
       .faults = {{.kind = WorkFault::Kind::Narrow, .s_mm = 100, .length_mm = 10, .by_mm = 2, .low = false},
                  {.kind = WorkFault::Kind::Drop, .s_mm = 200, .length_mm = 3, .by_mm = 12}}},
      {.height_mm = 0.2});
  DOUBLES_EQUAL(0, raised_mm(sut, 100, 6), 1e-12);
  DOUBLES_EQUAL(0.2, raised_mm(sut, 100, 2), 1e-9);
  DOUBLES_EQUAL(0.2, raised_mm(sut, 200, 11.8), 1e-9);
  DOUBLES_EQUAL(0, raised_mm(sut, 203, 11.8), 1e-12);
}

TEST(WorkedBand, ColouredFilmHidesWhatIsBelow) {
  const MadeShoe sut = worked({.offset_mm = 4, .width_mm = 6}, {.cover_ratio = 1, .own_diffuse_ratio = 0.11});
  DOUBLES_EQUAL(0.11, sut.section(100).look(at(100).point_shoe.z() + 4).diffuse_ratio, 1e-9);
}

}  // namespace biteline::sim
