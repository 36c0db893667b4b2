// SPDX-License-Identifier: MIT
#include "common/core/error.hpp"

#include <CppUTest/TestHarness.h>

#include <cstring>
#include <set>
#include <string>

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

TEST(Error, TooLongTextSaysThatItIsCutAndKeepsItsEnd) {
  STRCMP_EQUAL("0...789", FixedText<8>::format("%s", "0123456789").c_str());
  STRCMP_EQUAL("0123456", FixedText<8>::format("%s", "0123456").c_str());
  // A path as long as the system allows, then the reason.
  const std::string folder(3000, 'd');
  const Error sut = fail(Errc::BadValue, "/%s/line.csv row 5: 3 fields expected", folder.c_str()).value();
  LONGS_EQUAL(255, sut.where.view().size());
  CHECK(sut.where.view().starts_with("/dddd"));
  CHECK(sut.where.view().find("d...d") != std::string_view::npos);
  CHECK(sut.where.view().ends_with("/line.csv row 5: 3 fields expected"));
}

// At every capacity the cut falls elsewhere: no letter is ever torn.
TEST(Error, ShortenedTextIsCutBetweenLetters) {
  std::string letters;
  for (int i = 0; i < 60; ++i) letters += "a\u00fc\u20ac\U0001F45F";
  for (std::size_t capacity = 7; capacity < 120; ++capacity) {
    std::string out(capacity, 'x');
    shorten_text(out.data(), capacity, letters);
    out.resize(std::strlen(out.c_str()));
    CHECK(out.size() < capacity);
    CHECK(out.size() + 7 > capacity);
    STRCMP_EQUAL(clean_text(out).c_str(), out.c_str());
    CHECK(out.find('?') == std::string::npos);
  }
}

}  // namespace biteline
