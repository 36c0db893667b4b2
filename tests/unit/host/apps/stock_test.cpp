// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/stock.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {

TEST_GROUP(ScanStock) {
  test::TemporaryFolder folder;
  std::filesystem::path own{folder.path() / "own"}, shipped{folder.path() / "shipped"},
      saved{folder.path() / "saved"};
  release::InForce released{.hash = std::string(64, 'a'),
                            .models = folder.path() / "release/models",
                            .processes = folder.path() / "release/processes"};

  [[nodiscard]] StockFolders folders() const {
    return {.library = own, .shipped_processes = shipped, .saved_processes = saved};
  }
  void setup() override {
    for (const char* file : {"own/taught/model.json", "release/models/boot/model.json", "shipped/rough.yaml",
                             "saved/mine.yaml", "saved/grind.yaml", "release/processes/grind.yaml"})
      folder.write(file, "x");
  }
};

TEST(ScanStock, WithoutAReleaseTheCellsOwn) {
  const api::Stock stock = stock_of(std::nullopt, folders());
  CHECK(stock.models.folder() == own);
  for (const char* name : {"rough", "mine", "grind"}) SUCCEEDS(stock.processes.find(name));
}

TEST(ScanStock, WithAReleaseNothingButItsOwn) {
  const api::Stock stock = stock_of(released, folders());
  CHECK(!stock.models.has("taught"));
  CHECK(stock.models.names().value() == std::vector<std::string>{"boot"});
  for (const char* name : {"rough", "mine"}) CHECK_TEXT(!stock.processes.find(name), name);
  const auto grind = stock.processes.find("grind");
  SUCCEEDS(grind);
  CHECK(grind->file == released.processes / "grind.yaml");
}

TEST(ScanStock, ReleaseOfModelsAloneHasNoProcess) {
  std::filesystem::remove_all(released.processes);
  CHECK(stock_of(released, folders()).processes.list().empty());
}

}  // namespace biteline::service
