// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/rooms.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {

TEST_GROUP(ScanRooms) {
  test::TemporaryFolder folder;
  std::filesystem::path own{folder.path() / "own"}, shipped{folder.path() / "shipped"},
      saved{folder.path() / "saved"};
  release::InForce released{.hash = std::string(64, 'a'),
                            .models = folder.path() / "release/models",
                            .processes = folder.path() / "release/processes"};

  void setup() override {
    for (const char* file : {"own/taught/model.json", "release/models/boot/model.json", "shipped/rough.yaml",
                             "saved/mine.yaml", "saved/grind.yaml", "release/processes/grind.yaml"})
      folder.write(file, "x");
  }
};

TEST(ScanRooms, WithoutAReleaseTheCellsOwn) {
  const Rooms rooms = rooms_of(std::nullopt, own, shipped, saved);
  CHECK(rooms.models.folder() == own);
  for (const char* name : {"rough", "mine", "grind"}) SUCCEEDS(rooms.processes.find(name));
}

TEST(ScanRooms, WithAReleaseNothingButItsOwn) {
  const Rooms rooms = rooms_of(released, own, shipped, saved);
  CHECK(!rooms.models.has("taught"));
  CHECK(rooms.models.names().value() == std::vector<std::string>{"boot"});
  for (const char* name : {"rough", "mine"}) CHECK_TEXT(!rooms.processes.find(name), name);
  const auto grind = rooms.processes.find("grind");
  SUCCEEDS(grind);
  CHECK(grind->file == released.processes / "grind.yaml");
}

TEST(ScanRooms, ReleaseOfModelsAloneHasNoProcess) {
  std::filesystem::remove_all(released.processes);
  CHECK(rooms_of(released, own, shipped, saved).processes.list().empty());
}

}  // namespace biteline::service
