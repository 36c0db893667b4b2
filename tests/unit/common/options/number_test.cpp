// SPDX-License-Identifier: MIT
#include "common/options/number.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>

namespace biteline::options {

TEST_GROUP(Number){/// The whole way through the command line; empty: taken.
                   static std::string parsed(const std::string& text){double table_z_mm = 0;
CLI::App app;
app.add_option("--table-z", table_z_mm)->check(number(k_plausible_mm, "mm"));
try {
  app.parse(std::vector<std::string>{text, "--table-z"});
} catch (const CLI::ParseError& error) {
  return error.what();
}
CHECK(k_plausible_mm.holds(table_z_mm));
return {};
}  // namespace biteline::options
}
;

TEST(Number, WhatIsNoLengthIsRefusedWithRangeAndUnit) {
  for (const char* bad :
       {"nan", "NaN", "-nan", "inf", "-inf", "1e308", "-1e308", "100000.5", "1e400", "nan(7)"})
    STRCMP_CONTAINS("a finite number from -100000 to 100000 mm expected, found", parsed(bad).c_str());
  std::feclearexcept(FE_ALL_EXCEPT);  // what is too large for a double raises it
  CHECK(!parsed("twelve").empty() && !parsed("").empty() && !parsed("1mm").empty());
}

TEST(Number, LengthsPass) {
  for (const char* good : {"0", "-0", "24.5", "1e5", "-100000", "1e-300"})
    STRCMP_EQUAL("", parsed(good).c_str());
}

TEST(Number, EachOfSeveralNumbersIsLookedAt) {
  std::vector<double> from_deg;
  CLI::App app;
  app.add_option("--from", from_deg)->check(number({.minimum = -720, .maximum = 720}, "deg"))->expected(3);
  CHECK_THROWS(CLI::ParseError, app.parse(std::vector<std::string>{"0", "nan", "0", "--from"}));
  app.parse(std::vector<std::string>{"30", "20", "10", "--from"});
  DOUBLES_EQUAL(20, from_deg[1], 0);
}

}  // namespace biteline::options
