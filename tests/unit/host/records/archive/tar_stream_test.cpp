// SPDX-License-Identifier: MIT
#include "host/records/archive/tar_stream.hpp"

#include <CppUTest/TestHarness.h>

#include <cstdlib>
#include <fstream>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::archive {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t k_plenty = 1 << 20;

}  // namespace

TEST_GROUP(TarStream) {
  test::TemporaryFolder folder;
  fs::path scan{folder.path() / "scan-0007"};

  void setup() override {
    folder.write("scan-0007/line.csv", std::string(1300, 'a'));
    folder.write("scan-0007/cloud.ply", std::string(512, 'b'));
    folder.write("scan-0007/stages/one.png", "c");
    folder.write("scan-0007/empty", "");
    folder.write("scan-0007/.attempt", "hidden");
    folder.write("secret", "of another folder");
    fs::create_symlink(folder.path() / "secret", scan / "link");
  }
  std::string all(std::size_t piece) {
    const Result<TarStream> sut = TarStream::open(scan, k_plenty);
    SUCCEEDS(sut);
    std::string bytes;
    while (bytes.size() < sut->bytes()) {
      const Result<std::string> next = sut->read(bytes.size(), piece);
      SUCCEEDS(next);
      CHECK(!next->empty() && next->size() <= piece);
      bytes += *next;
    }
    return bytes;
  }
};

TEST(TarStream, AnyTarProgramUnpacksIt) {
  folder.write("all.tar", all(100'000));
  const std::string out = (folder.path() / "out").string();
  fs::create_directories(out);
  LONGS_EQUAL(0, std::system(("tar -xf " + (folder.path() / "all.tar").string() + " -C " + out).c_str()));
  const std::string same =
      "diff -r --exclude=.attempt --exclude=link " + scan.string() + " " + out + "/scan-0007";
  LONGS_EQUAL(0, std::system(same.c_str()));
  CHECK(!fs::exists(fs::path{out} / "scan-0007/link"));
  CHECK(!fs::exists(fs::path{out} / "scan-0007/.attempt"));
}

TEST(TarStream, PiecesOfAnySizeAreTheSameBytes) {
  const std::string whole = all(100'000);
  LONGS_EQUAL(0, whole.size() % 512);
  for (const std::size_t piece : {1U, 7U, 511U, 512U, 513U, 2000U}) CHECK(all(piece) == whole);
  CHECK(TarStream::open(scan, k_plenty)->read(whole.size(), 10)->empty());
}

TEST(TarStream, WhatIsGoneOrChangedIsTold) {
  FAILS_NAMING(Errc::FileNotFound, "no such folder", TarStream::open(folder.path() / "scan-0008", k_plenty));
  FAILS_NAMING(Errc::FileNotFound, "no such folder", TarStream::open(scan / "link", k_plenty));
  FAILS_NAMING(Errc::SizeMismatch, "at most 1000", TarStream::open(scan, 1000));
  const Result<TarStream> sut = TarStream::open(scan, k_plenty);
  SUCCEEDS(sut);
  folder.write("scan-0007/line.csv", "short");
  FAILS_NAMING(Errc::SizeMismatch, "line.csv has become shorter", sut->read(0, k_plenty));
  fs::remove(scan / "line.csv");
  FAILS_NAMING(Errc::FileNotFound, "line.csv", sut->read(0, k_plenty));
  folder.write("scan-0007/bad name", "");
  FAILS_NAMING(Errc::BadValue, "bad name", TarStream::open(scan, k_plenty));
}

}  // namespace biteline::archive
