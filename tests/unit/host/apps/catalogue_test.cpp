// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/catalogue.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {

TEST_GROUP(ScanCatalogue) {
  test::TemporaryFolder folder;
  std::filesystem::path own{folder.path() / "own"}, shipped{folder.path() / "shipped"},
      saved{folder.path() / "saved"};
  release::InForce released{.hash = std::string(64, 'a'),
                            .models = folder.path() / "release/models",
                            .processes = folder.path() / "release/processes"};

  [[nodiscard]] CatalogueFolders folders() const {
    return {.library = own, .shipped_processes = shipped, .saved_processes = saved};
  }
  void setup() override {
    for (const char* file : {"own/taught/model.json", "release/models/boot/model.json", "shipped/rough.yaml",
                             "saved/mine.yaml", "saved/grind.yaml", "release/processes/grind.yaml"})
      folder.write(file, "x");
  }
};

TEST(ScanCatalogue, WithoutAReleaseTheCellsOwn) {
  const api::Catalogue catalogue = catalogue_of(std::nullopt, folders());
  CHECK(catalogue.models.folder() == own);
  for (const char* name : {"rough", "mine", "grind"}) SUCCEEDS(catalogue.processes.find(name));
}

TEST(ScanCatalogue, WithAReleaseNothingButItsOwn) {
  const api::Catalogue catalogue = catalogue_of(released, folders());
  CHECK(!catalogue.models.has("taught"));
  CHECK(catalogue.models.names().value() == std::vector<std::string>{"boot"});
  for (const char* name : {"rough", "mine"}) CHECK_TEXT(!catalogue.processes.find(name), name);
  const auto grind = catalogue.processes.find("grind");
  SUCCEEDS(grind);
  CHECK(grind->file == released.processes / "grind.yaml");
}

TEST(ScanCatalogue, ReleaseOfModelsAloneHasNoProcess) {
  std::filesystem::remove_all(released.processes);
  CHECK(catalogue_of(released, folders()).processes.list().empty());
}

}  // namespace biteline::service
