// SPDX-License-Identifier: MIT
// biteline settings on the command line: sets by name, the start-up set, and what is left after a kill.
#include <CppUTest/TestHarness.h>

#include "common/settings/settings.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/said.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

namespace fs = std::filesystem;

TEST_GROUP(SettingsTool) {
  test::TemporaryFolder folder;
  fs::path store{folder.path() / "store"};
  fs::path start{store / settings::k_start_file};

  test::Said tool(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "settings");
    arguments.insert(arguments.end(), {"--store", store});
    return test::said_by(BITELINE_TOOL, std::move(arguments));
  }
  std::string works(const std::vector<std::string>& arguments) const {
    const test::Said said = tool(arguments);
    LONGS_EQUAL_TEXT(0, said.status, said.last_error.c_str());
    LONGS_EQUAL(0, said.errors);
    return said.out;
  }
  void fails(const std::vector<std::string>& arguments, const char* words) const {
    const test::Said said = tool(arguments);
    LONGS_EQUAL(2, said.status);
    LONGS_EQUAL(1, said.errors);
    STRCMP_CONTAINS(words, said.last_error.c_str());
  }
  std::string file(const std::string& name, const std::string& body) const {
    return folder.write(name, body + "\n...\n").string();
  }
  void save(const std::string& name, const std::string& body) const {
    works({"save", name, file("given.yaml", body)});
  }
  double starting_exposure_us() const {
    const auto set = settings::read_settings(start);
    SUCCEEDS(set);
    return set->number(settings::Key::ExposureUs).value_or(0);
  }
};

TEST(SettingsTool, SetsAreSavedShownComparedAndListed) {
  save("day", "note: white foam\ncamera: {exposure_us: 250}");
  save("night", "camera: {exposure_us: 400, gain: 6}");
  const std::string shown = works({"show", "day"});
  STRCMP_CONTAINS("white foam", shown.c_str());
  STRCMP_CONTAINS("* camera.exposure_us         250 us", shown.c_str());
  STRCMP_CONTAINS("  peaks.mode                 matched", shown.c_str());
  const std::string differences = works({"compare", "day", "night"});
  STRCMP_CONTAINS("250 us", differences.c_str());
  STRCMP_CONTAINS("camera.gain", differences.c_str());
  STRCMP_CONTAINS("no difference", works({"compare", "day", "day"}).c_str());
  works({"use", "night"});
  const std::string names = works({"list"});
  STRCMP_CONTAINS("  day ", names.c_str());
  STRCMP_CONTAINS("* night ", names.c_str());
}

TEST(SettingsTool, TheStartUpSetChangesAndGoesBack) {
  save("day", "camera: {exposure_us: 250}");
  save("night", "camera: {exposure_us: 400}");
  works({"use", "day"});
  DOUBLES_EQUAL(250, starting_exposure_us(), 0);
  works({"use", "night"});
  DOUBLES_EQUAL(400, starting_exposure_us(), 0);
  works({"use", "night"});
  works({"use", "--back"});
  DOUBLES_EQUAL(250, starting_exposure_us(), 0);
  works({"use", "--back"});
  DOUBLES_EQUAL(400, starting_exposure_us(), 0);
}

TEST(SettingsTool, ABadSetIsNeitherSavedNorUsed) {
  save("day", "camera: {exposure_us: 250}");
  works({"use", "day"});
  fails({"save", "bad", file("bad.yaml", "camera:\n  exposure_us: .nan")},
        "bad.yaml line 2, camera.exposure_us");
  CHECK(!fs::exists(store / "bad.yaml"));
  fails({"use", file("bad.yaml", "camera:\n  exposure_ms: 4")}, "not a key of this file");
  folder.write("store/torn.yaml", "camera: {exposure_us: 900}\n");
  fails({"use", "torn"}, "the file is cut");
  fails({"save", "start-up", file("good.yaml", "note: x")}, "a name of letters");
  DOUBLES_EQUAL(250, starting_exposure_us(), 0);
  STRCMP_CONTAINS("the file is cut", works({"list"}).c_str());
}

TEST(SettingsTool, KilledWhileItWritesTheFormerSetStands) {
  save("day", "camera: {exposure_us: 250}");
  save("night", "camera: {exposure_us: 400}");
  works({"use", "day"});
  // A limit of no bytes kills the program at its first write, before any rename.
  const test::Said killed =
      test::said_by("/bin/sh", {"-c", "ulimit -c 0; ulimit -f 0; exec \"$@\"", "sh", BITELINE_TOOL,
                                "settings", "use", "night", "--store", store.string()});
  CHECK(killed.status != 0);
  DOUBLES_EQUAL(250, starting_exposure_us(), 0);
  // What such a death leaves beside is in nobody's way.
  folder.write(std::string{"store/"} + settings::k_start_file + ".part", "camera: {expos");
  DOUBLES_EQUAL(250, starting_exposure_us(), 0);
  works({"use", "night"});
  DOUBLES_EQUAL(400, starting_exposure_us(), 0);
}

TEST(SettingsTool, TheSensorRefusesASetByLineBeforeItOpensAnything) {
  const std::string bad = file("bad.yaml", "peaks:\n  threshold_grey: 300");
  const test::Said said = test::said_by(
      BITELINE_SENSOR, {"--source", "board:/nowhere", "--sensor", "/nowhere", "--settings", bad});
  LONGS_EQUAL(2, said.status);
  LONGS_EQUAL(1, said.errors);
  STRCMP_CONTAINS("bad.yaml line 2, peaks.threshold_grey: a finite number from 1 to 254",
                  said.last_error.c_str());
  // A folder means its start-up set.
  save("day", "camera: {exposure_us: 250}");
  const test::Said none =
      test::said_by(BITELINE_SENSOR, {"--source", "board:/nowhere", "--settings", store.string()});
  STRCMP_CONTAINS("start-up.yaml", none.last_error.c_str());
}

}  // namespace biteline
