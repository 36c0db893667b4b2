// SPDX-License-Identifier: MIT
#include "host/transfer/shape_store.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>

#include "common/system/file.hpp"
#include "host/cloud/ply.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/made_pair.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::transfer {
namespace {

namespace fs = std::filesystem;

const test::MadePair& made() {
  static const test::MadePair pair =
      test::made_pair({.seed = 1, .scan = {.profile_step_mm = 1.5, .column_step_mm = 0.4}});
  return pair;
}

bool same(const RoughShape& a, const RoughShape& b) {
  return a.few.positions == b.few.positions && a.few.normals == b.few.normals &&
         a.coarse.positions == b.coarse.positions && a.coarse.normals == b.coarse.normals &&
         a.coarse.pitch_mm == b.coarse.pitch_mm && a.few.pitch_mm == b.few.pitch_mm;
}

}  // namespace

TEST_GROUP(ShapeStore) {
  test::TemporaryFolder folder;
  Library library{folder.path() / "models"};
  const fs::path note = library.folder() / ".shapes" / "shoe";

  void setup() override {
    const fs::path sample = folder.path() / "sample";
    fs::create_directories(sample);
    SUCCEEDS(cloud::write_cloud(sample / k_cloud_file, made().sample_cloud));
    SUCCEEDS(cloud::write_line(sample / k_line_file, made().sample_line));
    SUCCEEDS(library.save("shoe", sample));
  }

  /// One byte of the cloud becomes another, in place and without a trace but its time of change.
  void spoil_cloud() const {
    std::fstream file(library.path_of("shoe") / k_cloud_file,
                      std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-2, std::ios::end);
    const char byte = static_cast<char>(file.peek());
    file.seekp(-2, std::ios::end);
    file.put(static_cast<char>(byte ^ 1));
  }
};

TEST(ShapeStore, IsTheSameFromItsNote) {
  const ShapeStore sut{library};
  const Result<RoughShape> first = sut.shape_of("shoe");
  SUCCEEDS(first);
  CHECK(fs::exists(note));
  const Result<RoughShape> again = ShapeStore{library}.shape_of("shoe");
  SUCCEEDS(again);
  CHECK(same(*first, *again));
}

TEST(ShapeStore, ANoteCountsUntilAFileOfItsModelChanges) {
  const ShapeStore sut{library};
  SUCCEEDS(sut.shape_of("shoe"));
  const fs::path cloud = library.path_of("shoe") / k_cloud_file;
  const auto before = fs::last_write_time(cloud);
  spoil_cloud();
  fs::last_write_time(cloud, before);
  SUCCEEDS(sut.shape_of("shoe"));  // nothing was read: the damage shows when it is compared
  fs::last_write_time(cloud, before + std::chrono::seconds{1});
  const Result<RoughShape> seen = sut.shape_of("shoe");
  CHECK_FALSE(seen.has_value());
  STRCMP_CONTAINS("model shoe is damaged", seen.error().where.c_str());
}

TEST(ShapeStore, ADamagedNoteIsMadeAnew) {
  const ShapeStore sut{library};
  const Result<RoughShape> right = sut.shape_of("shoe");
  SUCCEEDS(right);
  const Result<std::string> whole = read_regular_file(note, 1U << 20U);
  SUCCEEDS(whole);
  for (const std::size_t length : {std::size_t{0}, std::size_t{3}, std::size_t{40}, whole->size() - 1}) {
    std::ofstream(note, std::ios::binary) << whole->substr(0, length);
    const Result<RoughShape> again = sut.shape_of("shoe");
    SUCCEEDS(again);
    CHECK(same(*right, *again));
  }
  for (std::size_t at = 0; at < whole->size(); at += whole->size() / 8) {
    std::string flipped = *whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x40);
    std::ofstream(note, std::ios::binary) << flipped;
    const Result<RoughShape> again = sut.shape_of("shoe");
    SUCCEEDS(again);
    CHECK(same(*right, *again));
  }
}

TEST(ShapeStore, NeedsNoNote) {
  SUCCEEDS(ShapeStore{library}.shape_of("shoe"));
  fs::remove_all(note.parent_path());
  std::ofstream(note.parent_path()) << "no folder can be made here";
  SUCCEEDS(ShapeStore{library}.shape_of("shoe"));
}

}  // namespace biteline::transfer
