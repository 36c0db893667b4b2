// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/backup.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>

#include "host/apps/biteline-host/service_words.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/ply.hpp"
#include "host/interfaces/accounts/accounts.hpp"
#include "host/report/file_lock.hpp"
#include "host/transfer/library.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

}  // namespace

TEST_GROUP(Backup) {
  test::TemporaryFolder folder;
  BackupPlaces cell{.results = folder.path() / "results", .library = folder.path() / "models"};
  BackupPlaces other{.results = folder.path() / "other/results", .library = folder.path() / "other/models"};
  fs::path file{folder.path() / "cell.tar"};

  void save_model(const BackupPlaces& places, const std::string& name, std::size_t points) const {
    const fs::path sample = folder.path() / "sample";
    fs::create_directories(sample);
    cloud::PointCloud cloud;
    for (std::size_t i = 0; i < points; ++i) cloud.points.emplace_back(static_cast<float>(i), 0.0F, 1.0F);
    SUCCEEDS(cloud::write_cloud(sample / transfer::k_cloud_file, cloud));
    cloud::ClosedLine line;
    for (const Vec3& position : {Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{0, 4, 0}})
      line.points.push_back(
          {.position = position, .normal = Vec3::UnitZ(), .tangent = Vec3::UnitX(), .confidence = 1});
    SUCCEEDS(cloud::write_line(sample / transfer::k_line_file, line));
    transfer::SaveOptions options;
    options.replace = true;
    SUCCEEDS(transfer::Library{places.library}.save(name, sample, options));
  }
  memory::Memory open(const BackupPlaces& places) const {
    fs::create_directories(places.results);
    auto memory = memory::Memory::open(places.results / memory::k_memory_file);
    SUCCEEDS(memory);
    return std::move(*memory);
  }
  static void put_scan(memory::Memory & memory, const std::string& name, const std::string& verdict) {
    memory::Scan scan;
    scan.name = name;
    scan.time = 1'000'000;
    scan.verdict = verdict;
    SUCCEEDS(memory.put_scan(scan, {}));
  }
  /// A scan, an account with a session, a setting, two models, a process.
  void fill() {
    memory::Memory memory = open(cell);
    accounts::Accounts accounts{memory};
    SUCCEEDS(accounts.add("ada", accounts::Role::Administrator, "a long password", "ada", "web"));
    const auto login = accounts.log_in("ada", "a long password", "web");
    SUCCEEDS(login);
    token = (*login)->token;
    put_scan(memory, "scan-0007", "refused");
    SUCCEEDS(memory.put_setting("language", "de", {}));
    save_model(cell, "runner", 7);
    save_model(cell, "boot", 9);
    fs::create_directories(cell.results / "processes");
    fs::copy_file(fs::path{BITELINE_PROCESSES} / "grind.yaml", cell.results / "processes/mine.yaml");
  }
  std::string token;
};

TEST(Backup, EverythingButTheSessionsComesBackElsewhere) {
  fill();
  const auto wrote = write_backup(cell, file);
  SUCCEEDS(wrote);
  LONGS_EQUAL(2, wrote->models);
  LONGS_EQUAL(1, wrote->processes);
  const auto restored = restore_backup(other, file);
  SUCCEEDS(restored);
  LONGS_EQUAL(2, restored->models);

  memory::Memory memory = open(other);
  accounts::Accounts accounts{memory};
  CHECK(accounts.is_password_of("ada", "a long password").value_or(false));
  const auto session = accounts.who_is(token);
  CHECK(session && !*session);
  const auto scan = memory.scan("scan-0007");
  CHECK(scan && *scan);
  STRCMP_EQUAL("de", memory.setting("language")->value_or("").c_str());
  LONGS_EQUAL(9, transfer::Library{other.library}.load("boot")->cloud.size());
  CHECK(fs::exists(other.results / "processes/mine.yaml"));
  // Nothing is left beside, and passwords' hashes are their owner's alone.
  for (const fs::directory_entry& entry : fs::directory_iterator{other.results})
    CHECK(!entry.path().filename().string().starts_with("."));
  CHECK((fs::status(file).permissions() & fs::perms::others_all) == fs::perms::none);
}

TEST(Backup, IsWrittenWhileAServiceHoldsTheResults) {
  fill();
  const memory::Memory running = open(cell);
  const auto lock = report::FileLock::take(cell.results / k_results_lock, "a service");
  SUCCEEDS(lock);
  SUCCEEDS(write_backup(cell, file));
  FAILS_NAMING(Errc::PeerRefused, "a service", restore_backup(cell, file));
}

TEST(Backup, IsNotRestoredOverAMemory) {
  fill();
  SUCCEEDS(write_backup(cell, file));
  FAILS_NAMING(Errc::WrongState, "is there already", restore_backup(cell, file));
}

TEST(Backup, ModelOfTheLibraryIsReplacedAndCanBeBroughtBack) {
  fill();
  SUCCEEDS(write_backup(cell, file));
  save_model(other, "boot", 5);
  SUCCEEDS(restore_backup(other, file));
  const transfer::Library library{other.library};
  LONGS_EQUAL(9, library.load("boot")->cloud.size());
  SUCCEEDS(library.undo("boot"));
  LONGS_EQUAL(5, library.load("boot")->cloud.size());
}

TEST(Backup, DamagedFileChangesNothing) {
  fill();
  SUCCEEDS(write_backup(cell, file));
  std::ifstream in{file, std::ios::binary};
  const std::string good{std::istreambuf_iterator<char>{in}, {}};
  for (const std::size_t bytes : {std::size_t{0}, good.size() / 2, good.size() - 2000}) {
    const fs::path cut = folder.write("cut.tar", good.substr(0, bytes));
    CHECK(!restore_backup(other, cut).has_value());
    CHECK(!fs::exists(other.results / memory::k_memory_file));
    CHECK(!fs::exists(other.library));
  }
  SUCCEEDS(restore_backup(other, file));
}

TEST(Backup, DamagedModelIsToldAndNothingIsWritten) {
  fill();
  std::ofstream{cell.library / "boot/line.csv"} << "damaged";
  FAILS_NAMING(Errc::SizeMismatch, "model boot", write_backup(cell, file));
  CHECK(!fs::exists(file));
}

}  // namespace biteline::service
