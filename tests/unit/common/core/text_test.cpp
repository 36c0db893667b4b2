// SPDX-License-Identifier: MIT
#include "common/core/text.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

#include "common/core/plain_number.hpp"
#include "common/core/result.hpp"

namespace biteline {

TEST_GROUP(Text){};

TEST(Text, LettersOfEveryLengthStay) {
  const std::string sole = "sole \xC3\xBC \xE9\x9E\x8B \xF0\x9F\x91\x9E";
  STRCMP_EQUAL(sole.c_str(), clean_text(sole).c_str());
}

TEST(Text, WhatATerminalOrAPageWouldObeyIsReplaced) {
  struct Row {
    const char* from;
    const char* expected;
  };
  constexpr Row k_rows[] = {{"a\x1b[31mred\x07", "a?[31mred?"},
                            {"two\nlines\r", "two?lines?"},
                            {"del\x7F", "del?"},
                            {"\xC2\x9B"
                             "31m",
                             "?31m"},
                            {"\xE2\x80\xAE"
                             "kcab",
                             "?kcab"},
                            {"\xE2\x80\xA8", "?"},
                            {"\xE2\x81\xA6x", "?x"},
                            {"\xEF\xBB\xBFx", "?x"}};
  for (const Row& row : k_rows) STRCMP_EQUAL(row.expected, clean_text(row.from).c_str());
}

TEST(Text, BytesThatAreNoUtf8AreReplacedOneByOne) {
  struct Row {
    const char* from;
    const char* expected;
  };
  // A lone byte of Latin-1, a torn letter, an overlong slash, a surrogate, beyond the last letter, a lone
  // continuation.
  constexpr Row k_rows[] = {{"M\xFCller", "M?ller"}, {"\xE9\x9E", "??"},           {"\xC0\xAF", "??"},
                            {"\xED\xA0\x80", "???"}, {"\xF4\x90\x80\x80", "????"}, {"\x80x", "?x"},
                            {"\xE0\x80\xAF", "???"}};
  for (const Row& row : k_rows) STRCMP_EQUAL(row.expected, clean_text(row.from).c_str());
}

TEST(Text, AnyBytesBecomeTextThatStaysAsItIs) {
  std::mt19937 random{11};
  for (int round = 0; round < 2000; ++round) {
    std::string bytes(random() % 40, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    const std::string once = clean_text(bytes, 30);
    CHECK(once.size() <= 30);
    STRCMP_EQUAL(once.c_str(), clean_text(once).c_str());
    for (const char byte : once) CHECK(static_cast<unsigned char>(byte) >= 0x20);
  }
}

TEST(Text, CutsBetweenLetters) {
  std::string umlauts;
  for (int i = 0; i < 200; ++i) umlauts += "\xC3\xBC";
  LONGS_EQUAL(254, clean_text(umlauts, 255).size());
  LONGS_EQUAL(4, clean_text("\xF0\x9F\x91\x9E\xF0\x9F\x91\x9E", 7).size());
}

TEST(Text, LineOfAnErrorHoldsNothingThatATerminalObeys) {
  STRCMP_EQUAL("found '?[31mred?\?': is not of the expected form",
               to_line(fail(Errc::BadFormat, "found '%s'", "\x1b[31mred\n\xFF").value()).c_str());
  STRCMP_EQUAL("?\?\?: is not of the expected form",
               to_line(fail(Errc::BadFormat, "\x01\x02\x03").value()).c_str());
}

TEST(Text, LineOfAnErrorIsCutBetweenLettersWhereverItsTextWasTooLong) {
  for (const char* letter : {"\xC3\xBC", "\xE9\x9E\x8B", "\xF0\x9F\x91\x9E"}) {
    for (std::size_t before = 0; before < 4; ++before) {
      std::string text(before, 'x');
      while (text.size() < 400) text += letter;
      const std::string line = to_line(fail(Errc::BadValue, "%s", text.c_str()).value());
      const std::string cut = line.substr(0, line.find(": has an impossible"));
      CHECK(cut.size() > 246 && cut.size() < 256);
      const std::size_t left_out = cut.find("...");
      CHECK(left_out != std::string::npos);
      const std::string head = cut.substr(0, left_out), tail = cut.substr(left_out + 3);
      CHECK(text.starts_with(head) && text.ends_with(tail));
      LONGS_EQUAL(0, (head.size() - before) % std::string_view{letter}.size());
      LONGS_EQUAL(0, tail.size() % std::string_view{letter}.size());
    }
  }
}

TEST(Text, NumbersInSentencesHaveNoPowersOfTen) {
  const struct {
    double value;
    const char* text;
  } k_cases[]{{0, "0"},           {280, "280"},           {0.28, "0.28"},       {11.64, "11.6"},
              {1234.6, "1235"},   {9999, "9999"},         {300'000, "300 000"}, {-280'000, "-280 000"},
              {12'345, "12 345"}, {1e9, "1 000 000 000"}, {0.001, "0.001"},     {0.0000123, "0.0000123"},
              {99.96, "100"},     {-0.5, "-0.5"},         {1e20, "1e+20"},      {100, "100"}};
  for (const auto& one : k_cases) STRCMP_EQUAL(one.text, plain_number(one.value).c_str());
}

}  // namespace biteline
