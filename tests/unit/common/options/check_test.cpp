// SPDX-License-Identifier: MIT
#include "common/options/check.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>

#include "common/options/command.hpp"

namespace biteline::options {
namespace {

/// The whole way through the command line; empty: taken.
std::string length_fault(const std::string& text) {
  double table_z_mm = 0;
  Command app{"", "test"};
  app.add_option("--table-z", table_z_mm)->check(number(k_plausible_mm, "mm"));
  if (const std::optional<Leave> leave = app.parse({"--table-z", text})) return leave->fault;
  CHECK(k_plausible_mm.holds(table_z_mm));
  return {};
}

}  // namespace

TEST_GROUP(Check){};

TEST(Check, WhatIsNoLengthIsRefusedWithRangeAndUnit) {
  for (const char* bad :
       {"nan", "NaN", "-nan", "inf", "-inf", "1e308", "-1e308", "100000.5", "1e400", "nan(7)"})
    STRCMP_CONTAINS("a finite number from -100000 to 100000 mm expected, found", length_fault(bad).c_str());
  std::feclearexcept(FE_ALL_EXCEPT);  // what is too large for a double raises it
  CHECK(!length_fault("twelve").empty() && !length_fault("").empty() && !length_fault("1mm").empty());
}

TEST(Check, LengthsPass) {
  for (const char* good : {"0", "-0", "24.5", "1e5", "-100000", "1e-300"})
    STRCMP_EQUAL("", length_fault(good).c_str());
}

TEST(Check, EachOfSeveralNumbersIsLookedAt) {
  std::vector<double> from_deg;
  Command app{"", "test"};
  app.add_option("--from", from_deg)->check(number({.minimum = -720, .maximum = 720}, "deg"))->expected(3);
  CHECK(app.parse({"--from", "0", "nan", "0"}).has_value());
  CHECK(!app.parse({"--from", "10", "20", "30"}).has_value());
  DOUBLES_EQUAL(20, from_deg[1], 0);
}

TEST(Check, OneOfTwoRulesIsEnough) {
  double size = 0;
  Command app{"", "test"};
  app.add_option("--size", size)->check(one_of_numbers({0}) | number({.minimum = 14, .maximum = 52}, ""));
  CHECK(!app.parse({"--size", "0"}) && !app.parse({"--size", "42"}));
  CHECK(app.parse({"--size", "7"}).has_value());
}

}  // namespace biteline::options
