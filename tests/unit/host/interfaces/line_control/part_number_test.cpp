// SPDX-License-Identifier: MIT
#include "host/interfaces/line_control/part_number.hpp"

#include <CppUTest/TestHarness.h>

#include <vector>

namespace biteline::line_control {

TEST_GROUP(PartNumber){};

TEST(PartNumber, BlanksOfAScannerAreNoneOfIt) {
  STRCMP_EQUAL("A-17 /4", part_number("  A-17 /4   ")->c_str());
  STRCMP_EQUAL("\xC3\xBC", part_number("\xC3\xBC")->c_str());
  for (const char* none : {"", "   "}) STRCMP_EQUAL("", part_number(none)->c_str());
}

TEST(PartNumber, WhatIsNoPrintableTextIsNone) {
  const std::string most(k_most_part_bytes, 'x');
  CHECK(part_number(most) == most);
  for (const std::string& text :
       {most + "x", std::string{"a\tb"}, std::string{"a\nb"}, std::string{"a\0b", 3}, std::string{"\xFF"}})
    CHECK_TEXT(!part_number(text), text.c_str());
}

TEST(PartNumber, TwoLettersStandInARegisterTheFirstInItsHighByte) {
  const auto registers = registers_of("A-1");
  LONGS_EQUAL(0x412D, registers[0]);
  LONGS_EQUAL(0x3100, registers[1]);
  for (std::size_t i = 2; i < k_part_registers; ++i) LONGS_EQUAL(0, registers.at(i));
}

TEST(PartNumber, EachTextComesBackOutOfRegistersAsItWentIn) {
  std::string text;
  for (std::size_t length = 0; length <= k_most_part_bytes; ++length) {
    CHECK_TEXT(part_of(registers_of(text)) == text, text.c_str());
    text += static_cast<char>('!' + length);
  }
  // What goes in too long is cut.
  CHECK(part_of(registers_of(text)) == text.substr(0, k_most_part_bytes));
}

TEST(PartNumber, RegistersThatHoldNoTextAreNone) {
  STRCMP_EQUAL("", part_of(std::vector<std::uint16_t>{0, 0})->c_str());
  for (const std::vector<std::uint16_t>& registers :
       {std::vector<std::uint16_t>{1}, std::vector<std::uint16_t>{0x0041},
        std::vector<std::uint16_t>{0x4100, 0x4100}, std::vector<std::uint16_t>{0x41FF},
        std::vector<std::uint16_t>{0x4109}})
    CHECK(!part_of(registers));
}

}  // namespace biteline::line_control
