// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/fixture.hpp"

#include <CppUTest/TestHarness.h>

#include <filesystem>

#include "hal/sim/record/surroundings.hpp"
#include "host/robot/path/plan.hpp"
#include "tests/support/made_pair.hpp"
#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {

TEST_GROUP(Fixture) {
  /// A shoe on a post 128 mm above the table that the arm stands on; the line 12 mm above its sole.
  PlanRequest request{
      .line = test::made_line({.half_length_mm = 85, .half_width_mm = 40, .middle = {600, 0, 142}}),
      .process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml"),
      .arm = *kinematics::arm_model("UR10e"),
      .table_z_mm = 0,
      .fixture = Fixture{.top_z_mm = 128, .beyond_mm = 30},
      .shoe = {.height_mm = 40},
      .cloud = {},
      .seek_remedy = false};

  static std::string failed(const PlanOutcome& outcome) {
    std::string names;
    for (const Check& check : outcome.checks) names += check.passed ? "" : check.name + ";";
    return names;
  }
};

TEST(Fixture, IsTheFloorUnderATipWithinItsPlateAndTheTableIsBesideIt) {
  Surroundings sut{.table_z_mm = 0, .shoe_points = {}};
  add_fixture(sut, request.line, {.top_z_mm = 128, .beyond_mm = 30});
  DOUBLES_EQUAL(128, floor_mm(sut, {600, 0, 200}), 1e-9);
  DOUBLES_EQUAL(128, floor_mm(sut, {600, 68, 200}), 1e-9);
  DOUBLES_EQUAL(0, floor_mm(sut, {600, 72, 200}), 1e-9);
  Surroundings lower{.table_z_mm = 140, .shoe_points = {}};
  add_fixture(lower, request.line, {.top_z_mm = 128, .beyond_mm = 30});
  CHECK(!lower.fixture && lower.shoe_points.empty());
}

TEST(Fixture, HoldsTheWholePlateOfTheMadeCellAndLittleMore) {
  for (const std::uint64_t seed : {5U, 6U, 7U}) {
    const sim::MadeShoe shoe{sim::draw_shoe(sim::ShoeClass::Deep, seed, sim::length_of_size_mm(42))};
    const auto truth = sim::true_line(shoe, 0.5);
    CHECK(!truth.empty());
    Surroundings sut{.table_z_mm = -100, .shoe_points = {}};
    add_fixture(sut, biteline::test::as_line(truth, SE3::Identity()),
                {.top_z_mm = 0, .beyond_mm = sim::plate_beyond_line_mm(shoe.outline(), truth)});
    // The drawn plate's edge lies within the planned one, and 4 mm farther out there is nothing any more.
    const std::vector<Vec2> drawn = sim::plate_outline(shoe.outline());
    Vec2 middle = Vec2::Zero();
    for (const Vec2& corner : drawn) middle += corner / static_cast<double>(drawn.size());
    for (const Vec2& corner : drawn) {
      const Vec2 outwards = (corner - middle).normalized(), inner = corner - 0.3 * outwards,
                 outer = corner + 4 * outwards;
      DOUBLES_EQUAL(0, floor_mm(sut, {inner.x(), inner.y(), 50}), 1e-9);
      DOUBLES_EQUAL(-100, floor_mm(sut, {outer.x(), outer.y(), 50}), 1e-9);
    }
  }
}

TEST(Fixture, LetsAShoeOnAPostBeWorkedThatAsHighATableWouldNot) {
  const PlanOutcome on_post = plan(request);
  CHECK_TEXT(on_post.path.has_value(), on_post.reason().c_str());
  CHECK(on_post.surroundings.fixture.has_value());
  // A table as high passes through the arm's own shoulder.
  request.table_z_mm = request.fixture->top_z_mm;
  request.fixture.reset();
  const PlanOutcome on_table = plan(request);
  CHECK_FALSE(on_table.path.has_value());
  STRCMP_CONTAINS("arm and table", on_table.reason().c_str());
}

TEST(Fixture, IsNotTouchedByTheTip) {
  // Lower than the plate's top, and well above the table.
  request.process.placement.up_mm = -18;
  request.process.tool.contact_length_mm = 120;
  const PlanOutcome low = plan(request);
  CHECK_FALSE(low.path.has_value());
  STRCMP_CONTAINS("tip above the table", failed(low).c_str());
  request.fixture.reset();
  STRCMP_EQUAL("", failed(plan(request)).c_str());
}

TEST(Fixture, IsNotTouchedByToolOrArmWhereTheShoesCloudIsKnown) {
  // The cloud takes the guessed shoe's place; what it stands on stays.
  for (const cloud::LinePoint& p : request.line.points) {
    for (int z_mm = 0; z_mm < 40; z_mm += 2)
      request.cloud.push_back((p.position + z_mm * Vec3::UnitZ()).cast<float>());
  }
  request.process = *read_process(std::filesystem::path{BITELINE_PROCESSES} / "spray.yaml");
  request.process.placement.standoff_mm = 30;
  // A nozzle rather level: a plate just below the line is in its body's way, if it is wide enough.
  request.process.placement.tilt_rad = 0.6;
  request.fixture->beyond_mm = 250;
  request.fixture->top_z_mm = 141;
  const PlanOutcome wide = plan(request);
  CHECK_FALSE(wide.path.has_value());
  STRCMP_CONTAINS("collide", wide.reason().c_str());
  request.fixture->beyond_mm = 5;
  const PlanOutcome narrow = plan(request);
  CHECK_TEXT(narrow.path.has_value(), narrow.reason().c_str());
}

}  // namespace biteline::path
