// SPDX-License-Identifier: MIT
#include "host/transfer/sizes.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::transfer {

TEST_GROUP(Sizes){};

TEST(Sizes, ALabelIsASystemAndANumber) {
  struct Case {
    const char *text, *system;
    double number;
  };
  for (const auto& [text, system, number] :
       {Case{"EU 42", "EU", 42}, Case{"eu42.5", "EU", 42.5}, Case{"UK 8,5", "UK", 8.5}, Case{"41", "", 41}}) {
    const std::optional<SizeLabel> sut = size_label(text);
    CHECK_TEXT(sut.has_value(), text);
    STRCMP_EQUAL(system, sut->system.c_str());
    DOUBLES_EQUAL(number, sut->number, 1e-12);
  }
}

TEST(Sizes, AnythingElseIsNone) {
  for (const char* text :
       {"", "EU", "42 EU", "EU 42 1/2", "EU 4.2.1", "EU -4", "EU 0", "EU 1e9", "EU 999", "?"})
    CHECK_TEXT(!size_label(text).has_value(), text);
}

TEST(Sizes, ALabelReadsAsItWasWritten) {
  for (const char* text : {"EU 42", "EU 42.5", "UK 8.5", "41"})
    STRCMP_EQUAL(text, text_of(*size_label(text)).c_str());
}

TEST(Sizes, OneSizeTakesTwoThirdsOfACentimetreInEurope) {
  DOUBLES_EQUAL(20.0 / 3, *mm_per_size({.system = "EU", .number = 42}), 1e-12);
  CHECK_FALSE(mm_per_size({.system = "", .number = 42}).has_value());
}

TEST(Sizes, AShoeBetweenTwoHalfSizesHasNone) {
  // Four sizes take a tenth.
  const SizeScale sut{.of_sample = {.system = "EU", .number = 40}, .share_per_size = 0.025};
  STRCMP_EQUAL("EU 44", text_of(*sut.at(0.1)).c_str());
  STRCMP_EQUAL("EU 38.5", text_of(*sut.at(-0.0375)).c_str());
  STRCMP_EQUAL("EU 42", text_of(*sut.at(0.05 + 0.19 * 0.025)).c_str());
  CHECK_FALSE(sut.at(0.05 + 0.25 * 0.025).has_value());
}

}  // namespace biteline::transfer
