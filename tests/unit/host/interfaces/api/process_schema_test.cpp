// SPDX-License-Identifier: MIT
#include "host/interfaces/api/process_schema.hpp"

#include <CppUTest/TestHarness.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "host/interfaces/api/process_store.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::api {
namespace {

using control::Json;

ProcessStore store_in(const test::TemporaryFolder& folder) {
  return {BITELINE_PROCESSES, folder.path() / "processes"};
}

}  // namespace

TEST_GROUP(ProcessSchema){};

TEST(ProcessSchema, EachKeyOfTheReaderHasHelpAndItsRange) {
  const config::KeysAsked keys = path::process_keys();
  CHECK(keys.size() > 30);
  for (const config::KeyAsked& key : keys) CHECK_TEXT(!help_of(key.path).empty(), key.path.c_str());
  const Json schema = process_schema();
  const Json& speed = schema["properties"]["motion"]["properties"]["speed_mm_s"];
  DOUBLES_EQUAL(0.1, speed["minimum"].get<double>(), 0);
  DOUBLES_EQUAL(1000, speed["maximum"].get<double>(), 0);
  STRCMP_EQUAL("mm/s", speed["x-unit"].get<std::string>().c_str());
  const Json& approval = schema["properties"]["gate"]["properties"]["approval"];
  STRCMP_EQUAL(R"(["none","person","automatic"])", test::text_of(approval["enum"]).c_str());
  STRCMP_EQUAL(R"(["name","tool","placement","motion"])", test::text_of(schema["required"]).c_str());
}

TEST(ProcessSchema, EachKeyOfTheReaderStandsInTheDocument) {
  std::ifstream stream{std::filesystem::path{BITELINE_DOCUMENTS} / "formats.md"};
  const std::string document{std::istreambuf_iterator<char>{stream}, {}};
  for (const config::KeyAsked& key : path::process_keys()) {
    std::string path = key.path;
    if (const std::size_t first = path.find("[0]"); first != std::string::npos) path.erase(first + 1, 1);
    CHECK_TEXT(document.find("`" + path + "`") != std::string::npos, path.c_str());
  }
}

TEST(ProcessSchema, EachKeyOfTheReaderHasWordsInEachLanguage) {
  int languages = 0;
  for (const auto& entry : std::filesystem::directory_iterator{BITELINE_WORDS}) {
    std::ifstream stream{entry.path()};
    const Json words = Json::parse(stream);
    const std::string language = entry.path().filename();
    // The English help is the service's own.
    const bool is_english = language == "en.json";
    ++languages;
    for (const config::KeyAsked& key : path::process_keys()) {
      std::string path = key.path;
      if (const std::size_t first = path.find("[0]"); first != std::string::npos)
        path.erase(first + 1, 1);  // "zones[0]" is "zones[]" there
      const std::string told = language + ": " + path;
      CHECK_TEXT(words.contains("field_" + path), told.c_str());
      CHECK_TEXT(is_english || words.contains("help_" + path), told.c_str());
      for (const std::string& choice : key.choices)
        CHECK_TEXT(words.contains("choice_" + choice), (told + " " + choice).c_str());
    }
  }
  CHECK(languages >= 2);
}

TEST(ProcessSchema, ZonesAreAListWithUnitsAndRanges) {
  const Json schema = process_schema();
  const Json& zones = schema["properties"]["zones"];
  STRCMP_EQUAL("array", zones["type"].get<std::string>().c_str());
  CHECK(!zones["description"].get<std::string>().empty());
  const Json& item = zones["items"];
  STRCMP_EQUAL(R"(["name"])", test::text_of(item["required"]).c_str());
  STRCMP_EQUAL("mm", item["properties"]["outward_by_mm"]["x-unit"].get<std::string>().c_str());
  STRCMP_EQUAL("degrees", item["properties"]["tilt_by_deg"]["x-unit"].get<std::string>().c_str());
  STRCMP_EQUAL("%", item["properties"]["from_percent"]["x-unit"].get<std::string>().c_str());
  LONGS_EQUAL(10, item["properties"]["passes"]["maximum"].get<int>());
  STRCMP_EQUAL(R"(["worked","left_out"])", test::text_of(item["properties"]["work"]["enum"]).c_str());
}

TEST(ProcessSchema, ZonesComeBackAsTheyWereSavedAndFaultsNameThem) {
  const test::TemporaryFolder folder;
  const ProcessStore store = store_in(folder);
  Json grind = *store.read("grind");
  CHECK_FALSE(grind.contains("zones"));
  grind["zones"] = Json::array({{{"name", "heel"}, {"where", "heel"}, {"work", "left_out"}},
                                {{"name", "side"}, {"from_percent", 30}, {"to_percent", 40}, {"passes", 2}}});
  SUCCEEDS(store.save("zoned", grind));
  const auto back = store.read("zoned");
  SUCCEEDS(back);
  LONGS_EQUAL(2, (*back)["zones"].size());
  STRCMP_EQUAL("left_out", (*back)["zones"][0]["work"].get<std::string>().c_str());
  LONGS_EQUAL(2, (*back)["zones"][1]["passes"].get<int>());
  grind["zones"][1]["passes"] = 11;
  FAILS_NAMING(Errc::CheckFailed, "zones[1].passes", store.save("zoned", grind));
}

TEST(ProcessSchema, ShippedProcessesAreReadAsJsonAndSavedAgain) {
  const test::TemporaryFolder folder;
  const ProcessStore store = store_in(folder);
  for (const char* name : {"grind", "rough", "spray", "cement"}) {
    const auto json = store.read(name);
    SUCCEEDS(json);
    CHECK(store.find(name)->shipped);
    SUCCEEDS(store.save(name, *json));
    // The saved one stands before the shipped one, and says the same.
    CHECK(!store.find(name)->shipped);
    STRCMP_EQUAL(json->dump().c_str(), store.read(name)->dump().c_str());
    const auto shipped =
        path::read_process(std::filesystem::path{BITELINE_PROCESSES} / (std::string{name} + ".yaml"));
    const auto saved = path::read_process(store.find(name)->file);
    SUCCEEDS(saved);
    DOUBLES_EQUAL(shipped->motion.speed_mm_s, saved->motion.speed_mm_s, 0);
    DOUBLES_EQUAL(shipped->placement.tilt_rad, saved->placement.tilt_rad, 1e-12);
  }
}

TEST(ProcessSchema, FaultIsNamedAndNothingIsWritten) {
  const test::TemporaryFolder folder;
  const ProcessStore store = store_in(folder);
  Json grind = *store.read("grind");
  grind["motion"]["speed_mm_s"] = 5000;
  FAILS_NAMING(Errc::CheckFailed, "motion.speed_mm_s", store.save("fast", grind));
  grind = *store.read("grind");
  grind["motion"]["sped"] = 5;
  FAILS_NAMING(Errc::CheckFailed, "motion.sped", store.save("fast", grind));
  FAILS_NAMING(Errc::CheckFailed, "name", store.save("fast", Json::object()));
  FAILS_NAMING(Errc::InvalidArgument, "name", store.save("../fast", *store.read("grind")));
  FAILS_NAMING(Errc::FileNotFound, "fast", store.find("fast"));
  CHECK(!std::filesystem::exists(folder.path() / "processes/fast.yaml"));
}

}  // namespace biteline::api
