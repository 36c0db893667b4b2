// SPDX-License-Identifier: MIT
#include "firmware/record/room.hpp"

#include <CppUTest/TestHarness.h>

#include <chrono>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::record {
namespace fs = std::filesystem;

TEST_GROUP(Room) {
  test::TemporaryFolder folder;
  fs::path series = folder.path() / "scan";
  static constexpr std::size_t k_bytes = 1000;

  /// A recording of 1000 bytes that ended so many hours ago.
  fs::path make(const std::string& name, int hours_ago) const {
    folder.write(name + "/cam0/data/1.png", std::string(k_bytes, 'x'));
    const fs::path facts = folder.write(name + "/recording.yaml", "");
    fs::last_write_time(facts, fs::file_time_type::clock::now() - std::chrono::hours{hours_ago});
    return folder.path() / name;
  }
};

TEST(Room, OldestGoUntilTheOthersFit) {
  const fs::path first = make("scan", 3), second = make("scan-2", 4), third = make("scan-3", 1);
  LONGS_EQUAL(1, make_room(series, 2 * k_bytes));
  CHECK(fs::exists(first) && !fs::exists(second) && fs::exists(third));
  LONGS_EQUAL(0, make_room(series, 2 * k_bytes));
  LONGS_EQUAL(1, make_room(series, 2 * k_bytes - 1));
  CHECK(!fs::exists(first) && fs::exists(third));
}

TEST(Room, HeldRecordingStays) {
  const fs::path old = make("scan", 3), newer = make("scan-2", 1);
  const auto held = HeldRecording::hold(old);
  SUCCEEDS(held);
  FAILS_NAMING(Errc::WrongState, "somebody writes it", HeldRecording::hold(old));
  LONGS_EQUAL(1, make_room(series, 0));
  CHECK(fs::exists(old) && !fs::exists(newer));
}

TEST(Room, FoldersOfOthersStay) {
  const fs::path others[] = {make("scanner", 9), make("scan-b", 9), make("scan-", 9), make("other", 9)};
  fs::create_directories(folder.path() / "scan-4");  // no recording.yaml
  fs::create_directory_symlink(others[3], folder.path() / "scan-5");
  LONGS_EQUAL(0, make_room(series, 0));
  for (const fs::path& other : others) CHECK(fs::exists(other / "cam0/data/1.png"));
  CHECK(fs::exists(folder.path() / "scan-4") && fs::exists(folder.path() / "scan-5"));
}

}  // namespace biteline::record
