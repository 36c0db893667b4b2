// SPDX-License-Identifier: MIT
#include "host/interfaces/api/exchange.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::api {

TEST_GROUP(Exchange) {
  test::TemporaryFolder folder;
  const std::filesystem::path place{folder.path() / "exchange"};

  int files() const {
    int count = 0;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator{place, none})
      count += entry.exists() ? 1 : 0;
    return count;
  }
};

TEST(Exchange, PiecesOfSeveralOwnersBecomeTheirFiles) {
  Exchange sut{place};
  SUCCEEDS(sut.add("a", 0, "one "));
  SUCCEEDS(sut.add("b", 0, "other"));
  SUCCEEDS(sut.add("a", 4, "two"));
  LONGS_EQUAL(7, std::filesystem::file_size(sut.brought_by("a")));
  LONGS_EQUAL(5, std::filesystem::file_size(sut.brought_by("b")));
  SUCCEEDS(sut.add("a", 0, "anew"));
  LONGS_EQUAL(4, std::filesystem::file_size(sut.brought_by("a")));
  LONGS_EQUAL(2, files());
  sut.drop("a");
  CHECK(sut.brought_by("a").empty());
  LONGS_EQUAL(1, files());
}

TEST(Exchange, WhatDoesNotFitOrIsTooMuchGoes) {
  Exchange sut{place};
  FAILS_NAMING(Errc::WrongState, "", sut.add("a", 4, "two"));
  SUCCEEDS(sut.add("a", 0, "one"));
  FAILS_NAMING(Errc::WrongState, "", sut.add("a", 2, "two"));
  LONGS_EQUAL(0, files());
  SUCCEEDS(sut.add("a", 0, "one"));
  FAILS_NAMING(Errc::WrongState, "", sut.add("a", Exchange::k_most_bytes + 1, "x"));
  for (std::size_t i = 0; i < Exchange::k_most_uploads; ++i)
    SUCCEEDS(sut.add("owner " + std::to_string(i), 0, "x"));
  FAILS_NAMING(Errc::WrongState, "", sut.add("one more", 0, "x"));
  LONGS_EQUAL(Exchange::k_most_uploads, files());
}

TEST(Exchange, WhoStopsIsForgottenAndAKilledServiceLeavesNothing) {
  {
    Exchange sut{place};
    SUCCEEDS(sut.add("a", 0, "one"));
    sut.forget_idle();
    LONGS_EQUAL(1, files());
    sut.forget_idle(Exchange::Clock::now() + 2 * Exchange::k_idle);
    LONGS_EQUAL(0, files());
    SUCCEEDS(sut.add("a", 0, "one"));
  }
  LONGS_EQUAL(1, files());
  const Exchange next{place};
  LONGS_EQUAL(0, files());
}

TEST(Exchange, OnlyTheLastFilesStayToBeRead) {
  Exchange sut{place};
  for (std::size_t i = 0; i < 2 * Exchange::k_most_downloads; ++i) {
    const auto file = sut.outgoing();
    SUCCEEDS(file);
    folder.write("exchange/" + file->filename().string(), "x");
  }
  LONGS_EQUAL(Exchange::k_most_downloads, files());
}

}  // namespace biteline::api
