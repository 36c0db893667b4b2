// SPDX-License-Identifier: MIT
#include "common/core/error.hpp"

#include <CppUTest/TestHarness.h>

#include <set>

#include "common/core/result.hpp"

namespace biteline {

TEST_GROUP(Error){};

TEST(Error, EveryCodeHasOneRowWithWordsAndAnAction) {
  std::set<Errc> seen;
  for (const ErrorRow& row : error_table()) {
    CHECK(seen.insert(row.code).second);
    CHECK(std::string_view{row.message}.size() > 3);
    CHECK(std::string_view{row.action}.size() > 3);
  }
  // The ranges of error.hpp decide what a program exits with.
  for (const ErrorRow& row : error_table()) {
    const int hundreds = static_cast<int>(row.code) / 100;
    const ExitStatus expected = hundreds <= 2   ? ExitStatus::BadInput
                                : hundreds == 3 ? ExitStatus::Refused
                                                : ExitStatus::Connection;
    CHECK(expected == row.exit_status);
  }
}

TEST(Error, LineNamesPlaceAndFurtherFaults) {
  Error error{.code = Errc::BadFormat, .sys_errno = 0, .more_faults = 2, .where = {}};
  error.where = FixedText<256>::format("data.csv row %d", 7);
  STRCMP_EQUAL("data.csv row 7: is not of the expected form (and 2 more faults)", to_line(error).c_str());
}

Result<int> half(int number) {
  if (number % 2 != 0) return fail(Errc::BadValue, "%d is odd", number);
  return number / 2;
}

Result<int> quarter(int number) {
  BITELINE_ASSIGN(const int halved, half(number));
  return half(halved);
}

TEST(Error, FailureTravelsThroughAssign) {
  LONGS_EQUAL(2, *quarter(8));
  const Result<int> sut = quarter(6);
  CHECK(!sut);
  STRCMP_EQUAL("3 is odd", sut.error().where.c_str());
}

TEST(Error, TooLongTextIsCutNotOverrun) {
  const auto sut = FixedText<8>::format("%s", "0123456789");
  STRCMP_EQUAL("0123456", sut.c_str());
}

}  // namespace biteline
