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
  for (const char* name : {"grind.yaml", "rough.yaml", "cement.yaml", "spray.yaml"}) {
    const auto process = read_process(shipped(name));
    CHECK_TEXT(process.has_value(), name);
    CHECK(covered_width_mm(*process) > 5);
  }
  const Process spray = *read_process(shipped("spray.yaml"));
  DOUBLES_EQUAL(2 * spray.placement.standoff_mm * std::tan(spray.coverage.cone_rad / 2),
                covered_width_mm(spray), 1e-9);
  DOUBLES_EQUAL(60 * std::numbers::pi / 180, spray.placement.tilt_rad, 1e-12);
}

TEST(ProcessFile, UnknownKeysAndImpossibleValuesAreNamed) {
  struct Row {
    const char* from;
    const char* to;
    const char* named;
  };
  for (const Row& row :
       {Row{"up_mm", "upp_mm", "up_mm"}, Row{"blend_mm: 1", "blend_mm: 0.8", "blend_mm"},
        Row{"payload_kg", "weight_kg", "payload_kg"},
        Row{"payload_kg: 1.8", "payload_kg: .nan", "payload_kg"},
        Row{"[0, 0, 70]", "[0, 0, 7000]", "payload_centre_mm"},
        Row{"tilt_deg: 60", "tilt_deg: 600", "tilt_deg"}, Row{"start: auto", "start: heel", "start"},
        Row{"[0, 0, 180]", "[0, 180]", "tcp_position_mm"}}) {
    const auto process = read_changed(row.from, row.to);
    CHECK_FALSE_TEXT(process.has_value(), row.to);
    CHECK_TEXT(process.error().where.view().find(row.named) != std::string_view::npos,
               process.error().where.c_str());
  }
}

}  // namespace biteline::path
