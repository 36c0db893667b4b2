// SPDX-License-Identifier: MIT
// The messages of refused scans stay within bounds.
#include "host/apps/biteline-host/black_box.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>

#include "tests/support/temporary_folder.hpp"

namespace biteline::service {

namespace fs = std::filesystem;

TEST_GROUP(BlackBox) {
  test::TemporaryFolder folder;

  void keep(const std::string& scan, std::size_t bytes) {
    fs::create_directories(folder.path() / scan);
    std::ofstream{folder.path() / scan / "scan.btln"} << std::string(bytes, 'm');
  }
  /// What goes, as one text of the scans' names.
  std::string gone(std::uint64_t most_bytes, const std::string& held = "") {
    std::string names;
    for (const fs::path& file :
         messages_to_go(folder.path(), most_bytes, [&](const std::string& name) { return name != held; }))
      names += file.parent_path().filename().string() + " ";
    return names;
  }
};

TEST(BlackBox, TheOldestGoFirstByTheirNumber) {
  keep("scan-9998", 100);
  keep("scan-9999", 100);
  keep("scan-10000", 100);
  STRCMP_EQUAL("", gone(300).c_str());
  STRCMP_EQUAL("scan-9998 ", gone(299).c_str());
  STRCMP_EQUAL("scan-9998 scan-9999 ", gone(100).c_str());
}

TEST(BlackBox, TheNewestStaysHoweverLargeItIs) {
  keep("scan-0001", 10);
  keep("scan-0002", 1000);
  STRCMP_EQUAL("scan-0001 ", gone(1).c_str());
}

TEST(BlackBox, WhatMayNotGoStaysAndTakesNoneOfTheRoom) {
  keep("scan-0001", 1000);
  keep("scan-0002", 100);
  keep("scan-0003", 100);
  fs::create_directories(folder.path() / "scan-0004");  // without messages
  STRCMP_EQUAL("", gone(200, "scan-0001").c_str());
  STRCMP_EQUAL("scan-0002 ", gone(150, "scan-0001").c_str());
}

TEST(BlackBox, AFolderThatIsNotThereHasNothing) {
  CHECK(messages_to_go(folder.path() / "none", 1, [](const std::string&) { return true; }).empty());
}

}  // namespace biteline::service
