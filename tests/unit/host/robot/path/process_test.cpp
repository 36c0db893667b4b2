// SPDX-License-Identifier: MIT
#include "host/robot/path/process.hpp"

#include <CppUTest/TestHarness.h>

#include <cmath>
#include <fstream>
#include <numbers>

namespace biteline::path {
namespace {

std::filesystem::path shipped(const char* name) {
  return std::filesystem::path{BITELINE_PROCESSES} / name;
}

/// The shipped file with one text replaced, in a temporary place.
Result<Process> read_changed(const std::string& from, const std::string& to) {
  std::ifstream in{shipped("grind.yaml")};
  std::string text{std::istreambuf_iterator<char>{in}, {}};
  const std::size_t at = text.find(from);
  CHECK(at != std::string::npos);
  text.replace(at, from.size(), to);
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "biteline_process_test.yaml";
  std::ofstream{file} << text;
  Result<Process> process = read_process(file);
  std::filesystem::remove(file);
  return process;
}

}  // namespace

TEST_GROUP(ProcessFile){};

TEST(ProcessFile, ShippedProcessesAreValid) {
  for (const char* name :
       {"grind.yaml", "grind_force.yaml", "rough.yaml", "rough_force.yaml", "cement.yaml", "spray.yaml"}) {
    const auto process = read_process(shipped(name));
    CHECK_TEXT(process.has_value(), name);
    CHECK(covered_width_mm(*process) > 5);
  }
  const Process spray = *read_process(shipped("spray.yaml"));
  DOUBLES_EQUAL(2 * spray.placement.standoff_mm * std::tan(spray.coverage.cone_rad / 2),
                covered_width_mm(spray), 1e-9);
  DOUBLES_EQUAL(60 * std::numbers::pi / 180, spray.placement.tilt_rad, 1e-12);
}

TEST(ProcessFile, ToolAndWhatFollowsHaveNames) {
  const auto plain = read_process(shipped("grind.yaml"));
  CHECK(plain->tool.name.empty() && plain->next_process.empty());
  DOUBLES_EQUAL(0.5, plain->look_tolerance_mm, 1e-12);
  const auto named =
      read_changed("tool:", "next_process: cement\nlook_tolerance_mm: 0.8\ntool:\n  name: disc_40.2");
  CHECK(named.has_value());
  STRCMP_EQUAL("disc_40.2", named->tool.name.c_str());
  STRCMP_EQUAL("cement", named->next_process.c_str());
  DOUBLES_EQUAL(0.8, named->look_tolerance_mm, 1e-12);
  // A name is a file's or a tool's, and no way to a folder.
  for (const char* bad :
       {"next_process: ../cement\ntool:", "next_process: 'a b'\ntool:", "tool:\n  name: .hidden"}) {
    const auto refused = read_changed("tool:", bad);
    CHECK_TEXT(!refused.has_value(), bad);
    STRCMP_CONTAINS("letters, digits", to_line(refused.error()).c_str());
  }
}

TEST(ProcessFile, FlowIsReadInItsUnits) {
  const auto process =
      read_changed("gate:",
                   "flow: {gun_on_ms: 40, gun_off_ms: 25, dwell_ms: 100, film_overlap_mm: 2,\n"
                   "       analog_output: 1, lag_ms: 30}\ngate:");
  CHECK(process.has_value());
  CHECK(process->flow.has_value());
  DOUBLES_EQUAL(0.040, process->flow->gun_on_s, 1e-12);
  DOUBLES_EQUAL(0.025, process->flow->gun_off_s, 1e-12);
  DOUBLES_EQUAL(0.1, process->flow->dwell_s, 1e-12);
  DOUBLES_EQUAL(2, process->flow->film_overlap_mm, 1e-12);
  LONGS_EQUAL(1, process->flow->analog_output);
  DOUBLES_EQUAL(process->motion.speed_mm_s, process->flow->full_mm_s, 1e-12);
  DOUBLES_EQUAL(0.030, process->flow->lag_s, 1e-12);
  DOUBLES_EQUAL(0, process->flow->purge_s, 0);
  CHECK_FALSE(read_process(shipped("grind.yaml"))->flow.has_value());
  CHECK_FALSE(read_changed("digital_output: 0", "flow: {full_mm_s: 90}")->flow.has_value());
}

/// An output that is full below the line's fastest speed, a film longer than the way that is gone twice, a
/// flow without a gun, and a wait that the watch over the arm takes for a tip that stands.
TEST(ProcessFile, AFlowThatCannotBeIsRefused) {
  for (const char* flow : {"flow: {full_mm_s: 1}", "flow: {film_overlap_mm: 90}", "flow: {analog_output: 2}",
                           "flow: {dwell_ms: 1900}",
                           "zones: [{name: a, to_percent: 9, speed_ratio: 2}]\nflow: {full_mm_s: 41}"}) {
    CHECK_TEXT(!read_changed("gate:", std::string{flow} + "\ngate:"), flow);
  }
  CHECK(!read_changed("digital_output: 0", "flow: {gun_on_ms: 5}"));
}

TEST(ProcessFile, AFlangeIsReadInItsUnits) {
  const auto process = read_changed(
      "gate:",
      "force: {set_n: 20, by: flange, flange_full_n: 80, flange_stroke_mm: 24, flange_tilt_deg: 30,\n"
      "        flange_analog_output: 1, flange_analog_input: 1, flange_on_output: 5, flange_ready_input: 6}\n"
      "gate:");
  CHECK(process.has_value());
  CHECK(process->force->flange.has_value());
  const Flange& flange = *process->force->flange;
  DOUBLES_EQUAL(80, flange.full_newton, 1e-12);
  DOUBLES_EQUAL(24, flange.stroke_mm, 1e-12);
  LONGS_EQUAL(1, flange.analog_output);
  LONGS_EQUAL(1, flange.analog_input);
  LONGS_EQUAL(5, flange.on_output);
  LONGS_EQUAL(6, flange.ready_input);
  // Tilted by 30 degrees about the line, as a tool of that tilt leans from it.
  DOUBLES_EQUAL(std::cos(std::numbers::pi / 6), axis_tcp(flange).z(), 1e-12);
  DOUBLES_EQUAL(-0.5, axis_tcp(flange).y(), 1e-12);
  const auto plain = read_changed("gate:", "force: {set_n: 20, by: flange}\ngate:");
  DOUBLES_EQUAL(plain->placement.tilt_rad, plain->force->flange->tilt_rad, 1e-12);
  CHECK(!read_changed("gate:", "force: {set_n: 20}\ngate:")->force->flange);
}

/// Its lines are its own, and its stroke is longer than what shoes and lines differ by.
TEST(ProcessFile, AFlangeThatCannotBeIsRefused) {
  for (const char* keys :
       {"force: {set_n: 20, by: flange, flange_on_output: 0}",
        "force: {set_n: 20, by: flange, flange_stroke_mm: 5}",
        "force: {set_n: 20, by: flange, flange_ready_input: 8}", "force: {set_n: 20, by: spring}",
        "flow: {analog_output: 0}\nforce: {set_n: 20, by: flange}"})
    CHECK_TEXT(!read_changed("gate:", std::string{keys} + "\ngate:"), keys);
}

TEST(ProcessFile, ZonesAreReadInTheirUnits) {
  const auto process = read_changed(
      "gate:",
      "zones:\n"
      "  - {name: heel, where: heel, reach_percent: 20, work: left_out}\n"
      "  - {name: inner side, from_percent: 85, to_percent: 15, outward_by_mm: -1, up_by_mm: 2,\n"
      "     tilt_by_deg: -10, lead_by_deg: 5, speed_ratio: 0.5, passes: 3, ramp_mm: 8}\ngate:");
  CHECK(process.has_value());
  LONGS_EQUAL(2, process->zones.size());
  const Zone &heel = process->zones[0], &side = process->zones[1];
  CHECK(heel.where == Zone::Where::Heel);
  CHECK(heel.left_out);
  DOUBLES_EQUAL(0.2, heel.reach_ratio, 1e-12);
  STRCMP_EQUAL("inner side", side.name.c_str());
  CHECK(side.where == Zone::Where::Stretch);
  CHECK_FALSE(side.left_out);
  DOUBLES_EQUAL(0.85, side.from_ratio, 1e-12);
  DOUBLES_EQUAL(0.15, side.to_ratio, 1e-12);
  DOUBLES_EQUAL(-1, side.outward_by_mm, 0);
  DOUBLES_EQUAL(2, side.up_by_mm, 0);
  DOUBLES_EQUAL(-10 * std::numbers::pi / 180, side.tilt_by_rad, 1e-12);
  DOUBLES_EQUAL(5 * std::numbers::pi / 180, side.lead_by_rad, 1e-12);
  DOUBLES_EQUAL(0.5, side.speed_ratio, 0);
  LONGS_EQUAL(3, side.passes);
  DOUBLES_EQUAL(8, side.ramp_mm, 0);
}

TEST(ProcessFile, UnknownKeysAndImpossibleValuesAreNamed) {
  struct Row {
    const char* from;
    const char* to;
    const char* named;
  };
  for (const Row& row :
       {Row{"up_mm", "upp_mm", "up_mm"},
        Row{"blend_mm: 1", "blend_mm: 0.8", "blend_mm"},
        Row{"payload_kg", "weight_kg", "payload_kg"},
        Row{"payload_kg: 1.8", "payload_kg: .nan", "payload_kg"},
        Row{"[0, 0, 70]", "[0, 0, 7000]", "payload_centre_mm"},
        Row{"tilt_deg: 60", "tilt_deg: 600", "tilt_deg"},
        Row{"start: auto", "start: heel", "start"},
        Row{"start: auto", "after_work: redo", "after_work"},
        Row{"coverage:\n  contact_width_mm: 8", "after_work: look\ncoverage:\n  contact_width_mm: 0",
            "after_work"},
        Row{"[0, 0, 180]", "[0, 180]", "tcp_position_mm"},
        Row{"gate:", "zones:\n  - {name: a, where: toe, sped_ratio: 2}\ngate:", "zones[0].sped_ratio"},
        Row{"gate:", "zones:\n  - {name: a, where: toe}\n  - {name: b, passes: 2}\ngate:",
            "zones[1].to_percent"},
        Row{"gate:", "zones:\n  - {name: a, where: toe, tilt_by_deg: 40}\ngate:", "zones[0].tilt_by_deg"},
        Row{"gate:", "zones:\n  - {name: a, where: toe, up_by_mm: -51}\ngate:", "zones[0].up_by_mm"},
        Row{"gate:", "zones:\n  - {name: a, where: toe, speed_ratio: 0.1}\ngate:", "zones[0].speed_ratio"},
        Row{"motion:\n  speed_mm_s: 60",
            "zones:\n  - {name: a, where: toe, speed_ratio: 5}\nmotion:\n  speed_mm_s: 300",
            "zones[0].speed_ratio"},
        Row{"gate:", "zones:\n  - {name: a, where: toe, passes: 1.5}\ngate:", "zones[0].passes"},
        Row{"gate:", "zones:\n  - {name: a, where: toe, work: skip}\ngate:", "zones[0].work"},
        Row{"gate:", "zones:\n  - {where: toe}\ngate:", "zones[0].name"},
        Row{"speed_mm_s: 60\n  minimum_speed_mm_s: 8", "speed_mm_s: 0.15\n  minimum_speed_mm_s: 0.1",
            "follow.stall_s"},
        Row{"gate:", "zones: [toe]\ngate:", "zones[0]"},
        Row{"gate:", "zones: toe\ngate:", "zones"}}) {
    const auto process = read_changed(row.from, row.to);
    CHECK_FALSE_TEXT(process.has_value(), row.to);
    CHECK_TEXT(process.error().where.view().find(row.named) != std::string_view::npos,
               process.error().where.c_str());
  }
}

TEST(ProcessFile, NameIsOnePrintableLineOfAFewWords) {
  const auto named = [](const std::string& name) { return read_changed("name: grind", "name: " + name); };
  CHECK(named("Schleifen \xC3\xBC").has_value());
  CHECK(named(std::string(200, 'p')).has_value());
  for (const std::string& name :
       {std::string(201, 'p'), std::string(200'000, 'p'), std::string{R"("two\nlines")"},
        std::string{R"("\e[31mred")"}, std::string{R"("turned \u202e")"}}) {
    const auto process = named(name);
    CHECK_FALSE(process.has_value());
    CHECK(process.error().where.view().find("name") != std::string_view::npos);
    CHECK(process.error().where.view().find("printable") != std::string_view::npos);
  }
}

}  // namespace biteline::path
