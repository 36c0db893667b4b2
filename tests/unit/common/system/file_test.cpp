// SPDX-License-Identifier: MIT
#include "common/system/file.hpp"

#include <CppUTest/TestHarness.h>
#include <sys/stat.h>

#include <limits>

#include "common/core/numbers.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

TEST_GROUP(File) {
  test::TemporaryFolder folder;
};

TEST(File, WholeContentIsRead) {
  std::string text(100'000, 'a');
  text[50'000] = '\0';
  const auto sut = read_regular_file(folder.write("f", text), 100'000);
  SUCCEEDS(sut);
  CHECK(*sut == text);
  CHECK(read_regular_file(folder.write("empty", ""), 10)->empty());
}

TEST(File, PipesDevicesAndFoldersAreRefusedUnopened) {
  // Opening a pipe without a writer would wait for ever.
  const auto pipe = folder.path() / "pipe";
  LONGS_EQUAL(0, ::mkfifo(pipe.c_str(), 0600));
  FAILS_NAMING(Errc::FileUnreadable, "pipe: a regular file expected", read_regular_file(pipe, 10));
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", read_regular_file("/dev/zero", 10));
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", read_regular_file(folder.path(), 10));
  std::filesystem::create_symlink("/dev/zero", folder.path() / "link");
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected",
               read_regular_file(folder.path() / "link", 10));
  FAILS_NAMING(Errc::FileNotFound, "none", read_regular_file(folder.path() / "none", 10));
}

TEST(File, TooLargeAFileIsRefusedBeforeItIsRead) {
  const auto file = folder.write("large", "12345678901");
  FAILS_NAMING(Errc::BadValue, "at most 10 bytes expected, found 11", read_regular_file(file, 10));
  // A terabyte that takes no room on the disk.
  std::filesystem::resize_file(file, std::uintmax_t{1} << 40);
  FAILS_NAMING(Errc::BadValue, "at most", read_regular_file(file, k_most_cloud_bytes));
}

TEST(File, NumbersOutsideAreOutsideWhateverTheyAre) {
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double k_infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {k_nan, -k_nan, k_infinite, -k_infinite, 1e300, -1e300, 100'000.1})
    CHECK(!k_plausible_mm.holds(bad));
  for (const double good : {0.0, -0.0, 1e-300, -1e5, 1e5}) CHECK(k_plausible_mm.holds(good));
}

}  // namespace biteline
