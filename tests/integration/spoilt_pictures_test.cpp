// SPDX-License-Identifier: MIT
// A session whose pictures came otherwise than its head was calibrated gives no line.
#include <CppUTest/TestHarness.h>

#include "tests/integration/replayed_session.hpp"
#include "tests/support/spoilt_pictures.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

using test::Spoil;

TEST_GROUP(SpoiltPictures) {
  test::TemporaryFolder folder;

  /// A scan with a check lap: its profiles lie near enough for a surface through them.
  void setup() override {
    LONGS_EQUAL(0, test::run_to_end(BITELINE_CELL, {"record", "--seed", "4", "--head", "7", "--check-lap",
                                                    "50", "--speed-mm-s", "120", "--out", sound().string()}));
  }
  [[nodiscard]] std::filesystem::path sound() const {
    return folder.path() / "sound";
  }

  [[nodiscard]] test::Replayed spoilt(const Spoil& spoil, int every = 1) const {
    SUCCEEDS(test::write_spoilt_session(sound(), folder.path() / "spoilt", spoil, every));
    return test::replayed(folder.path() / "spoilt", folder.path() / "out");
  }

  void is_refused(const Spoil& spoil, const std::string& words) const {
    const test::Replayed sut = spoilt(spoil);
    const std::string name = spoil.name() + ": " + sut.report.dump();
    CHECK_EQUAL_TEXT(3, sut.exit, name.c_str());
    STRCMP_EQUAL_TEXT("not_as_calibrated", sut.reason_code().c_str(), name.c_str());
    CHECK_TEXT(sut.report["reason"].get<std::string>().find(words) != std::string::npos, name.c_str());
    CHECK_FALSE(std::filesystem::exists(folder.path() / "out" / "line.csv"));
    CHECK(std::filesystem::exists(folder.path() / "out" / "index.html"));
  }
};

TEST(SpoiltPictures, AreRefusedByName) {
  const test::Replayed sut = test::replayed(sound(), folder.path() / "out");
  CHECK_EQUAL_TEXT(0, sut.exit, sut.report.dump().c_str());
  STRCMP_EQUAL("agree", sut.pictures("status").c_str());
  is_refused({Spoil::Kind::Turned}, "turned by 180 degrees");
  // Of another size they are no pictures of this head at all.
  LONGS_EQUAL(2, spoilt({Spoil::Kind::Small}, 20).exit);
  CHECK_FALSE(std::filesystem::exists(folder.path() / "out" / "line.csv"));
}

}  // namespace biteline
