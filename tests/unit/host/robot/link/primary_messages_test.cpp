// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/primary_messages.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/unit/host/robot/link/said_bytes.hpp"

namespace biteline::robot::ur {
namespace {

using About = ControllerSaid::About;
using test::Bytes;

}  // namespace

TEST_GROUP(PrimaryMessages){};

TEST(PrimaryMessages, OfProgramsAreRead) {
  Bytes heard = test::joined({test::key_message("PROGRAM_XXX_STARTED", "biteline"), test::robot_state(),
                              test::runtime_exception(3, 7, "compile_error_name_not_found:movee:"),
                              test::error_code(210, 5, 3, "not\nallowed"),
                              test::key_message("PROGRAM_XXX_STOPPED", "biteline")});
  const auto sut = take_said(heard);
  SUCCEEDS(sut);
  LONGS_EQUAL(4, sut->size());
  CHECK((*sut)[0].about == About::Started);
  STRCMP_EQUAL("biteline", (*sut)[0].text.c_str());
  CHECK((*sut)[1].about == About::ProgramError);
  STRCMP_EQUAL("line 3, column 7: compile_error_name_not_found:movee:", (*sut)[1].text.c_str());
  CHECK((*sut)[2].about == About::Fault);
  STRCMP_EQUAL("C210A5: not allowed", (*sut)[2].text.c_str());
  CHECK((*sut)[3].about == About::Ended);
  CHECK(heard.empty());
}

/// Violation, fault, critical fault; below them warnings, above them words for developers.
TEST(PrimaryMessages, FaultsAreTakenByTheirLevel) {
  for (const auto& [level, count] : {std::pair{2, 0}, {3, 1}, {4, 1}, {5, 1}, {6, 0}, {131, 0}}) {
    Bytes heard = test::error_code(100, 0, level, "text");
    const auto sut = take_said(heard);
    SUCCEEDS(sut);
    LONGS_EQUAL(count, sut->size());
  }
}

TEST(PrimaryMessages, WarningsAndOtherKindsSayNothingOfAProgram) {
  Bytes heard =
      test::joined({test::error_code(100, 0, 2, "a warning"), test::key_message("SOMETHING_ELSE", "x"),
                    test::robot_message(3, Bytes(20, 9))});
  const auto sut = take_said(heard);
  SUCCEEDS(sut);
  CHECK(sut->empty());
  CHECK(heard.empty());
}

TEST(PrimaryMessages, APieceWaitsForItsRest) {
  const Bytes whole = test::runtime_exception(1, 2, "why");
  for (std::size_t cut = 1; cut < whole.size(); ++cut) {
    Bytes heard(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut));
    const auto none = take_said(heard);
    SUCCEEDS(none);
    CHECK(none->empty());
    LONGS_EQUAL(cut, heard.size());
    heard.insert(heard.end(), whole.begin() + static_cast<std::ptrdiff_t>(cut), whole.end());
    const auto all = take_said(heard);
    SUCCEEDS(all);
    LONGS_EQUAL(1, all->size());
  }
}

TEST(PrimaryMessages, MessagesThatAreTooShortForTheirKindSayNothing) {
  for (const std::uint8_t kind : {6, 7, 10}) {
    for (std::size_t size = 0; size < 9; ++size) {
      if (kind == 10 && size == 8) continue;  // whole, and says why with no word
      Bytes heard = test::robot_message(kind, Bytes(size, 1));
      const auto sut = take_said(heard);
      SUCCEEDS(sut);
      CHECK(sut->empty());
    }
  }
}

TEST(PrimaryMessages, OtherProtocolsAreRefused) {
  Bytes zeros(1100, 0), text{'C', 'o', 'n', 'n', 'e', 'c', 't', 'e', 'd'};
  CHECK(take_said(zeros).error().code == Errc::BadFormat);
  CHECK(take_said(text).error().code == Errc::BadFormat);
}

TEST(PrimaryMessages, WhatAControllerSaysIsCutToALine) {
  Bytes heard = test::runtime_exception(1, 1, std::string(5000, 'x'));
  const auto sut = take_said(heard);
  SUCCEEDS(sut);
  CHECK((*sut)[0].text.size() < 300);
}

}  // namespace biteline::robot::ur
