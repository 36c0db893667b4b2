// SPDX-License-Identifier: MIT
// A release of the factory is in force: what scans are worked with is what the page lists.
#include <CppUTest/TestHarness.h>

#include "tests/support/json.hpp"
#include "tests/unit/host/interfaces/api/api_world.hpp"

namespace biteline::api {

struct ApiReleaseWorld : ApiWorld {
  const std::string hash = std::string(64, 'a');

  /// With the model "loafer" and the process "grind".
  void switch_on() {
    write_sample("sample");
    const std::filesystem::path release = folder.path() / "release";
    std::filesystem::create_directories(release / "processes");
    std::filesystem::copy_file(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml",
                               release / "processes/grind.yaml");
    catalogue = Catalogue{.release = hash,
                          .models = transfer::Library{release / "models"},
                          .processes = ProcessStore{release / "processes", {}}};
    SUCCEEDS(catalogue->models.save("loafer", folder.path() / "sample"));
  }
  static std::vector<std::string> names_of(const Json& rows) {
    std::vector<std::string> names;
    for (const Json& row : rows) names.push_back(row["name"].get<std::string>());
    return names;
  }
};

TEST_GROUP_BASE(ApiRelease, ApiReleaseWorld){};

TEST(ApiRelease, WithoutOneTheCellsOwnAreListed) {
  log_in("eng");
  CHECK(ask("GET", "/models").body["release"].is_null());
  CHECK(ask("GET", "/processes").body["release"].is_null());
}

TEST(ApiRelease, ItsModelsAndProcessesAreListedAndRead) {
  switch_on();
  log_in("eng");
  const Json models = ask("GET", "/models").body;
  STRCMP_EQUAL(hash.c_str(), models["release"].get<std::string>().c_str());
  CHECK(names_of(models["models"]) == std::vector<std::string>{"loafer"});
  LONGS_EQUAL(200, ask("GET", "/models/loafer").status);
  const Json processes = ask("GET", "/processes").body;
  CHECK(names_of(processes["processes"]) == std::vector<std::string>{"grind"});
  LONGS_EQUAL(404, ask("GET", "/processes/rough").status);
}

TEST(ApiRelease, WhatIsSavedHereWaitsForTheNextOne) {
  switch_on();
  write_sample("scan-0001");
  log_in("eng");
  LONGS_EQUAL(201, ask("POST", "/models", {{"name", "boot"}, {"scan", "scan-0001"}}).status);
  const Json grind = ask("GET", "/processes/grind").body["process"];
  LONGS_EQUAL(200, ask("PUT", "/processes/mine", grind).status);
  LONGS_EQUAL(404, ask("GET", "/models/boot").status);
  LONGS_EQUAL(404, ask("GET", "/processes/mine").status);
  catalogue = Catalogue{.release = {},
                        .models = transfer::Library{folder.path() / "models"},
                        .processes = ProcessStore{BITELINE_PROCESSES, folder.path() / "processes"}};
  LONGS_EQUAL(200, ask("GET", "/models/boot").status);
  LONGS_EQUAL(200, ask("GET", "/processes/mine").status);
}

TEST(ApiRelease, OneThatCannotBeReadIsToldAndNothingElseIsShownInItsPlace) {
  catalogue = fail(Errc::FileNotFound, "releases/plan.json");
  log_in("eng");
  for (const char* path : {"/models", "/processes", "/models/boot", "/processes/grind"}) {
    const control::Answer answer = ask("GET", path);
    CHECK_TEXT(answer.status >= 400, path);
    CHECK_TEXT(test::text_of(answer.body).find("plan.json") != std::string::npos,
               test::text_of(answer.body).c_str());
  }
}

}  // namespace biteline::api
