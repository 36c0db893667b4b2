// SPDX-License-Identifier: MIT
#include "common/csv/table.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::csv {

TEST_GROUP(Table) {
  test::TemporaryFolder folder;
  std::vector<double> sums;

  Result<void> read(const std::string& text) {
    return read_table(folder.write("t.csv", text), 2, 2, [this](const Row& row) -> Result<void> {
      BITELINE_ASSIGN(const double a, row.number(0));
      BITELINE_ASSIGN(const double b, row.number(1));
      sums.push_back(a + b);
      return {};
    });
  }
};

TEST(Table, RowsAreReadWhateverTheLineEndsAndComments) {
  SUCCEEDS(read("#a,b\n1,2\r\n\n 3 , 4 \n5,6"));
  LONGS_EQUAL(3, sums.size());
  DOUBLES_EQUAL(3, sums[0], 0);
  DOUBLES_EQUAL(7, sums[1], 0);
  DOUBLES_EQUAL(11, sums[2], 0);
}

TEST(Table, FirstFaultIsNamedAndTheOthersCounted) {
  FAILS_NAMING(Errc::BadFormat, "row 2: 2 fields expected, found 1", read("1,2\n3\nx,4\n5\n"));
  FAILS_NAMING(Errc::BadFormat, "and 2 more faults", read("1,2\n3\nx,4\n5\n"));
}

TEST(Table, WhatIsNoFiniteNumberIsRefused) {
  FAILS_NAMING(Errc::BadValue, "row 1, field 2", read("1,nan\n"));
  FAILS_NAMING(Errc::BadValue, "row 1, field 1", read("inf,1\n"));
  FAILS_NAMING(Errc::BadValue, "found '1e'", read("1e,1\n"));
  FAILS_NAMING(Errc::BadValue, "row 1, field 1", read(",1\n"));
}

TEST(Table, NumbersBeyondAllLengthsAreRefused) {
  for (const char* far : {"1e9,1\n", "-1e9,1\n", "1e308,1\n", "100000.1,1\n", "1e12,1\n"})
    FAILS_NAMING(Errc::BadValue, "row 1, field 1: a finite number from -100000 to 100000", read(far));
  SUCCEEDS(read("100000,-100000\n"));
}

TEST(Table, WhatWasFoundIsToldWithoutControlCharacters) {
  FAILS_NAMING(Errc::BadValue, "found '?[31mred?'", read("\x1b[31mred\x07,1\n"));
}

TEST(Table, MissingFileAndFolderAreTold) {
  const auto take = [](const Row&) -> Result<void> { return {}; };
  FAILS_NAMING(Errc::FileNotFound, "nothing.csv", read_table(folder.path() / "nothing.csv", 1, 1, take));
  FAILS_NAMING(Errc::FileUnreadable, folder.path().c_str(), read_table(folder.path(), 1, 1, take));
}

}  // namespace biteline::csv
