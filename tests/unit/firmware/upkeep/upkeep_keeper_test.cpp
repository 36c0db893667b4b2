// SPDX-License-Identifier: MIT
// What a unit has been through, kept over restarts, boots, cuts and full disks.
#include "firmware/upkeep/upkeep_keeper.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::upkeep {

TEST_GROUP(Upkeep) {
  test::TemporaryFolder folder;

  UpkeepKeeper begin(double up_s, const char* boot = "8f-1") {
    auto keeper = UpkeepKeeper::open(folder.path(), {.id = boot, .up_s = up_s});
    SUCCEEDS(keeper);
    return *keeper;
  }
  Upkeep kept() {
    const auto read = read_upkeep(folder.path() / k_file);
    SUCCEEDS(read);
    return *read;
  }
};

TEST(Upkeep, StartsAndBootsAreCountedOverRestarts) {
  begin(30);
  LONGS_EQUAL(1, kept().starts);
  LONGS_EQUAL(1, kept().boots);
  begin(500);
  LONGS_EQUAL(2, kept().starts);
  LONGS_EQUAL(1, kept().boots);
  // A boot is told by its name: this one began, ended and came again within what was never written.
  begin(501, "8f-2");
  LONGS_EQUAL(3, kept().starts);
  LONGS_EQUAL(2, kept().boots);
}

TEST(Upkeep, TheKernelNamesThisBootAndNoOther) {
  const Boot boot = present_boot();
  LONGS_EQUAL(36, boot.id.size());
  STRCMP_EQUAL(boot.id.c_str(), present_boot().id.c_str());
  CHECK(boot.up_s > 0 && present_boot().up_s >= boot.up_s);
  begin(boot.up_s, boot.id.c_str());
  STRCMP_EQUAL(boot.id.c_str(), kept().boot_id.c_str());
}

TEST(Upkeep, TimesLightingsAndTemperaturesAddUp) {
  UpkeepKeeper first = begin(100);
  first.see({.up_s = 110, .laser_on = false, .head_degc = 20});
  first.see({.up_s = 120, .laser_on = true, .head_degc = {}});
  first.see({.up_s = 150, .laser_on = true, .head_degc = 44});
  first.see({.up_s = 160, .laser_on = false, .head_degc = 6553.5});
  SUCCEEDS(first.write());
  UpkeepKeeper second = begin(200);
  second.see({.up_s = 230, .laser_on = true, .head_degc = 12});
  second.see({.up_s = 240, .laser_on = true, .head_degc = {}});
  SUCCEEDS(second.write());
  const Upkeep all = kept();
  DOUBLES_EQUAL(100, all.run_s, 1e-6);
  DOUBLES_EQUAL(5 + 30 + 5 + 15 + 10, all.laser_s, 1e-6);
  LONGS_EQUAL(2, all.lightings);
  DOUBLES_EQUAL(44, *all.hottest_degc, 0);
  DOUBLES_EQUAL(12, *all.coldest_degc, 0);
  STRCMP_EQUAL("2 starts, 1 boots, 0.0 h run, laser on 0.02 h in 2 times, head 12 to 44 degC",
               in_words(all).c_str());
}

TEST(Upkeep, ItIsWrittenEveryTenMinutesAndNeverInTheLight) {
  UpkeepKeeper sut = begin(0);
  sut.see({.up_s = 599, .laser_on = false, .head_degc = {}});
  CHECK_FALSE(sut.due());
  sut.see({.up_s = 700, .laser_on = true, .head_degc = {}});
  CHECK_FALSE(sut.due());
  sut.see({.up_s = 701, .laser_on = false, .head_degc = {}});
  CHECK(sut.due());
  SUCCEEDS(sut.write());
  CHECK_FALSE(sut.due());
  // A clock that steps back takes nothing away.
  sut.see({.up_s = 10, .laser_on = false, .head_degc = {}});
  DOUBLES_EQUAL(701, sut.upkeep().run_s, 1e-6);
}

TEST(Upkeep, FramesOfAllStartsAddUp) {
  UpkeepKeeper first = begin(0);
  first.see({.up_s = 1, .frames = 100});
  first.see({.up_s = 2, .frames = 250});
  SUCCEEDS(first.write());
  UpkeepKeeper second = begin(10);
  second.see({.up_s = 11, .frames = 30});
  SUCCEEDS(second.write());
  LONGS_EQUAL(280, kept().frames);
}

TEST(Upkeep, WhatANewerProgramCountsIsNotLost) {
  folder.write(k_file,
               "starts: 7\nboots: 2\nrun_s: 1\nlaser_s: 0\nlightings: 0\nfan_h: 12.5\n"
               "lens: \"8 mm, f/4\"\n");
  UpkeepKeeper sut = begin(5);
  sut.see({.up_s = 6});
  SUCCEEDS(sut.write());
  begin(7);
  const Upkeep all = kept();
  LONGS_EQUAL(9, all.starts);
  CHECK(all.others == (std::vector<std::string>{"fan_h: 12.5", "lens: \"8 mm, f/4\""}));
  CHECK(!std::filesystem::exists(folder.path() / "upkeep.bad.yaml"));
  // More than a plain value is no such line.
  for (const char* line :
       {"fans: [1, 2]", "fan: {a: 1}", "lens: \"8 mm", "Fan: 1", "fan h: 1", "fans:\n  - 1"}) {
    folder.write(k_file,
                 std::string{"starts: 7\nboots: 2\nrun_s: 1\nlaser_s: 0\nlightings: 0\n"} + line + "\n");
    CHECK_TEXT(!read_upkeep(folder.path() / k_file).has_value(), line);
  }
}

TEST(Upkeep, AFileThatIsNotWholeIsSetAside) {
  folder.write(k_file, "starts: 7\nboots: 2\nrun");
  begin(5);
  LONGS_EQUAL(1, kept().starts);
  CHECK(std::filesystem::exists(folder.path() / "upkeep.bad.yaml"));
  folder.write(k_file, "starts: -1\nboots: 2\nrun_s: 0\nlaser_s: 0\nlightings: 0\n");
  FAILS_NAMING(Errc::BadValue, "starts", read_upkeep(folder.path() / k_file));
  folder.write(k_file, "starts: 1\nboots: 2\nrun_s: 0\nlaser_s: 0\nlightings: 0\nboot_id: \"a b\"\n");
  FAILS_NAMING(Errc::BadValue, "boot_id", read_upkeep(folder.path() / k_file));
}

TEST(Upkeep, WithoutItsFolderItSaysSo) {
  FAILS_NAMING(Errc::WriteFailed, "upkeep.yaml", UpkeepKeeper::open(folder.path() / "none", {}));
}

}  // namespace biteline::upkeep
