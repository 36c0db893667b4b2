// SPDX-License-Identifier: MIT
// What a unit has been through, kept over restarts, boots, cuts and full disks.
#include "firmware/upkeep/upkeep_keeper.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::upkeep {

TEST_GROUP(Upkeep) {
  test::TemporaryFolder folder;

  UpkeepKeeper begin(double up_s) {
    auto keeper = UpkeepKeeper::open(folder.path(), up_s);
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
  begin(25);
  LONGS_EQUAL(3, kept().starts);
  LONGS_EQUAL(2, kept().boots);
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

TEST(Upkeep, AFileThatIsNotWholeIsSetAside) {
  folder.write(k_file, "starts: 7\nboots: 2\nrun");
  begin(5);
  LONGS_EQUAL(1, kept().starts);
  CHECK(std::filesystem::exists(folder.path() / "upkeep.bad.yaml"));
  folder.write(k_file, "starts: -1\nboots: 2\nrun_s: 0\nlaser_s: 0\nlightings: 0\nup_s: 1\n");
  FAILS_NAMING(Errc::BadValue, "starts", read_upkeep(folder.path() / k_file));
}

TEST(Upkeep, WithoutItsFolderItSaysSo) {
  FAILS_NAMING(Errc::WriteFailed, "upkeep.yaml", UpkeepKeeper::open(folder.path() / "none", 1));
}

}  // namespace biteline::upkeep
