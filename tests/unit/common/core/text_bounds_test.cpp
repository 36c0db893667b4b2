// SPDX-License-Identifier: MIT
#include "common/core/text_bounds.hpp"

#include <CppUTest/TestHarness.h>

#include "common/core/text.hpp"

namespace biteline::bounds {

TEST_GROUP(TextBounds){};

TEST(TextBounds, WhatFitsIsPrintableInOneLineAndShort) {
  CHECK(fits("", k_name));
  CHECK(fits(std::string(k_name, 'x'), k_name));
  CHECK(fits("Schuh gr\xC3\xBC\xC3\x9F \xE9\x9E\x8B", k_name));
  CHECK(!fits(std::string(k_name + 1, 'x'), k_name));
  const std::string zero{"a\0b", 3};
  for (const std::string& text :
       {zero, std::string{"two\nlines"}, std::string{"\x1b[31mred"}, std::string{"bad \xff byte"},
        std::string{"cut \xC3"}, std::string{"turned \xE2\x80\xAE"}, std::string{"tab\t"}})
    CHECK_TEXT(!fits(text, k_title), text.c_str());
}

TEST(TextBounds, FittedAlwaysFitsAndSaysThatItWasCut) {
  for (const std::size_t most : {k_choice, k_name, k_title, k_reason}) {
    for (const std::size_t size :
         {std::size_t{0}, most - 1, most, most + 1, 3 * most, std::size_t{100'000}}) {
      for (const char* letter : {"x", "\xC3\xBC", "\xE9\x9E\x8B", "\xF0\x9F\x91\x9E", "\xff", "\n", "\x1b"}) {
        std::string text;
        while (text.size() < size) text += letter;
        const std::string out = fitted(text, most);
        CHECK(fits(out, most));
        CHECK(text.size() <= most || out.ends_with("..."));
        CHECK(!fits(text, most) || out == text);
      }
    }
  }
}

}  // namespace biteline::bounds
