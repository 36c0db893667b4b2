// SPDX-License-Identifier: MIT
#include "host/records/release/shelf.hpp"

#include <CppUTest/TestHarness.h>

#include "host/records/archive/archive.hpp"
#include "host/records/digest/digest.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::release {
namespace {

namespace fs = std::filesystem;

}  // namespace

TEST_GROUP(ReleaseShelf) {
  test::TemporaryFolder folder;
  Shelf sut{folder.path() / "releases"};

  /// A release of one process, its bytes collected.
  Manifest collected(const std::string& words, const char* kind = k_archive_kind) {
    fs::create_directories(sut.folder());
    const fs::path file = folder.path() / "release.tar";
    const std::vector<archive::Entry> entries{
        {.name = "processes/grind.yaml", .file = folder.write("grind.yaml", words)}};
    SUCCEEDS(archive::write(file, {.kind = kind, .program = {}, .time = {}}, entries));
    const Manifest manifest{.name = "x", .sha256 = *digest_of_file(file), .bytes = fs::file_size(file)};
    fs::copy_file(file, sut.part_of(manifest.sha256), fs::copy_options::overwrite_existing);
    return manifest;
  }
};

TEST(ReleaseShelf, WholeReleaseGetsItsName) {
  const Manifest manifest = collected("one");
  CHECK(!sut.has(manifest.sha256));
  SUCCEEDS(sut.take_in(manifest));
  CHECK(sut.has(manifest.sha256));
  CHECK(fs::exists(sut.folder() / manifest.sha256 / "processes/grind.yaml"));
  CHECK(!fs::exists(sut.part_of(manifest.sha256)));
  LONGS_EQUAL(1, sut.hashes().size());
}

TEST(ReleaseShelf, WrongBytesGoAndLeaveNothing) {
  Manifest manifest = collected("one");
  fs::resize_file(sut.part_of(manifest.sha256), manifest.bytes - 1);
  FAILS_NAMING(Errc::SizeMismatch, "bytes expected", sut.take_in(manifest));
  CHECK(fs::is_empty(sut.folder()));
  // Signed, but no release.
  manifest = collected("one", "backup");
  FAILS_NAMING(Errc::BadFormat, "expected a release", sut.take_in(manifest));
  CHECK(fs::is_empty(sut.folder()));
}

TEST(ReleaseShelf, ScanTakesAllFromTheReleaseInForce) {
  FAILS_NAMING(Errc::FileNotFound, "no folder of releases", in_force(sut.folder(), 0));
  fs::create_directories(sut.folder());
  CHECK(!in_force(sut.folder(), 0).value().has_value());
  const Manifest manifest = collected("one");
  SUCCEEDS(sut.take_in(manifest));
  CHECK(!in_force(sut.folder(), 0).value().has_value());
  SUCCEEDS(sut.write({.current = manifest.sha256, .before = {}, .next = {}, .order = {}}));
  const auto release = in_force(sut.folder(), 0);
  SUCCEEDS(release);
  STRCMP_EQUAL(manifest.sha256.c_str(), (*release)->hash.c_str());
  CHECK(fs::exists((*release)->processes / "grind.yaml"));
  // Never another one in its place.
  fs::remove_all(sut.folder() / manifest.sha256);
  FAILS_NAMING(Errc::FileNotFound, "is in force, but is not there", in_force(sut.folder(), 0));
}

TEST(ReleaseShelf, TidyKeepsWhatThePlanNamesAndWhatIsWanted) {
  std::vector<std::string> hashes;
  for (const char* words : {"one", "two", "three", "four", "five"}) {
    const Manifest manifest = collected(words);
    SUCCEEDS(sut.take_in(manifest));
    hashes.push_back(manifest.sha256);
  }
  const Plan plan{.current = hashes[0], .before = hashes[1], .next = hashes[2], .order = {}};
  SUCCEEDS(sut.write(plan));
  std::ofstream(sut.part_of(hashes[4])) << "half";
  SUCCEEDS(sut.tidy(plan, hashes[3]));
  for (int i = 0; i < 4; ++i) CHECK(sut.has(hashes[static_cast<std::size_t>(i)]));
  CHECK(!sut.has(hashes[4]));
  CHECK(!fs::exists(sut.part_of(hashes[4])));
  CHECK(plan_of(sut.folder()).value() == plan);
}

}  // namespace biteline::release
