// SPDX-License-Identifier: MIT
#include "host/records/centre_word/centre_word.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::centre_word {
namespace {

DeadLetter letter(std::int64_t seq, const char* book = "b") {
  return {.book = book, .seq = seq, .scan = "scan-0007", .why = "process is out of bounds", .time = "now"};
}

}  // namespace

TEST_GROUP(CentreWord) {
  test::TemporaryFolder folder;
};

TEST(CentreWord, NothingWasSaidWhereThereIsNoFile) {
  const auto word = read(folder.path());
  SUCCEEDS(word);
  CHECK(*word == CentreWord{});
}

TEST(CentreWord, WhatIsWrittenIsRead) {
  CentreWord word;
  CHECK(word.add(letter(3)));
  CHECK(word.add(letter(4)));
  CHECK(!word.add(letter(3)));
  CHECK(word.add(letter(3, "another book")));
  word.held = "later";
  SUCCEEDS(write(folder.path(), word));
  const auto back = read(folder.path());
  SUCCEEDS(back);
  CHECK(*back == word);
  LONGS_EQUAL(3, back->count);
}

TEST(CentreWord, TheOldestGoesAndIsStillCounted) {
  CentreWord word;
  for (std::int64_t seq = 1; seq <= 1010; ++seq) CHECK(word.add(letter(seq)));
  LONGS_EQUAL(k_most_letters, word.letters.size());
  LONGS_EQUAL(1010, word.count);
  LONGS_EQUAL(11, word.letters.front().seq);
}

TEST(CentreWord, ADamagedFileIsToldAndOddTextsAreMadeFit) {
  for (const char* text : {"", "{", "[]", "{}", R"({"letters":{}})"}) {
    std::ofstream{folder.path() / k_file} << text;
    CHECK_TEXT(!read(folder.path()), text);
  }
  std::ofstream{folder.path() / k_file}
      << R"({"count":-4,"letters":[1,null,{"scan":7,"why":"a\u001b[31m\nb"},{"why":")"
      << std::string(100'000, 'x') << R"("}]})";
  const auto word = read(folder.path());
  SUCCEEDS(word);
  LONGS_EQUAL(2, word->letters.size());
  LONGS_EQUAL(2, word->count);
  STRCMP_EQUAL("a?[31m?b", word->letters[0].why.c_str());
  CHECK(word->letters[1].why.size() < 1000);
}

}  // namespace biteline::centre_word
