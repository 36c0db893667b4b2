// SPDX-License-Identifier: MIT
#include "host/records/archive/archive.hpp"

#include <CppUTest/TestHarness.h>

#include <cstdlib>
#include <fstream>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::archive {

TEST_GROUP(Archive) {
  test::TemporaryFolder folder;
  std::filesystem::path file{folder.path() / "all.tar"};

  static std::string text_of(const std::filesystem::path& path) {
    std::ifstream in{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
  }
  void write_some() {
    const std::vector<Entry> entries{
        {.name = "a.txt", .file = folder.write("one", "first")},
        {.name = "models/b/c.bin", .file = folder.write("two", std::string(1024, '\0'))},
        {.name = "empty", .file = folder.write("three", "")}};
    SUCCEEDS(
        write(file, {.kind = "backup", .program = "1.2.3", .time = "now", .more = {{"name", "x"}}}, entries));
  }
  Result<About> unpack_text(const std::string& bytes, const std::string& to) {
    return unpack(folder.write("changed.tar", bytes), "backup", folder.path() / to);
  }
};

TEST(Archive, WhatGoesInComesOut) {
  write_some();
  const Result<About> about = unpack(file, "backup", folder.path() / "out");
  SUCCEEDS(about);
  STRCMP_EQUAL("1.2.3", about->program.c_str());
  STRCMP_EQUAL("x", about->more.at("name").c_str());
  STRCMP_EQUAL("first", text_of(folder.path() / "out/a.txt").c_str());
  LONGS_EQUAL(1024, text_of(folder.path() / "out/models/b/c.bin").size());
  CHECK(std::filesystem::exists(folder.path() / "out/empty"));
}

TEST(Archive, AnyTarProgramReadsIt) {
  write_some();
  const std::string out = (folder.path() / "tar").string();
  std::filesystem::create_directories(out);
  LONGS_EQUAL(0, std::system(("tar -xf " + file.string() + " -C " + out).c_str()));
  STRCMP_EQUAL("first", text_of(folder.path() / "tar/a.txt").c_str());
  STRCMP_CONTAINS("\"kind\": \"backup\"", text_of(folder.path() / "tar/biteline.json").c_str());
}

TEST(Archive, AnotherKindOrNoArchiveIsTold) {
  write_some();
  FAILS_NAMING(Errc::BadFormat, "expected a model", unpack(file, "model", folder.path() / "out"));
  FAILS_NAMING(Errc::BadFormat, "cut short", unpack_text("", "none"));
  FAILS_NAMING(Errc::BadFormat, "no tar file", unpack_text(std::string(4096, 'x'), "other"));
  FAILS_NAMING(Errc::BadFormat, "not made by biteline", unpack_text(std::string(1024, '\0'), "zeros"));
}

TEST(Archive, EveryChangedByteThatCountsIsFound) {
  write_some();
  const std::string good = text_of(file);
  int found = 0;
  for (std::size_t at = 0; at < good.size(); at += 37) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x20);
    const std::filesystem::path out = folder.path() / "changed";
    std::filesystem::remove_all(out);
    const Result<About> about = unpack_text(bad, "changed");
    found += about ? 0 : 1;
    // What passes gives the same bytes: the change fell on padding, or on words beside the files.
    if (about) STRCMP_EQUAL("first", text_of(out / "a.txt").c_str());
  }
  CHECK(found > 20);
}

TEST(Archive, NamesThatLeaveTheFolderOrHideAreRefused) {
  const std::filesystem::path source = folder.write("source", "bytes");
  for (const char* name : {"../a", "/a", "a/../b", ".a", "a/.b", "a b", "a//b", "a/", "", "biteline.json"}) {
    FAILS_NAMING(
        Errc::InvalidArgument, "no name",
        write(file, {.kind = "backup", .program = {}, .time = {}}, std::vector{Entry{name, source}}));
    CHECK(!std::filesystem::exists(file));
  }
  // Of another program's tar, too.
  const std::string made = (folder.path() / "made.tar").string();
  const std::string command = "cd " + folder.path().string() + " && mkdir -p sub && tar --format=ustar -cf " +
                              made + " --transform='s|^source|../source|' -P source 2>/dev/null";
  LONGS_EQUAL(0, std::system(command.c_str()));
  FAILS_NAMING(Errc::BadFormat, "plain", unpack(made, "backup", folder.path() / "sub/out"));
  CHECK(!std::filesystem::exists(folder.path() / "sub/source"));
  LONGS_EQUAL(0, std::system(("cd " + folder.path().string() +
                              " && ln -s /etc/passwd link && tar --format=ustar -cf " + made + " link")
                                 .c_str()));
  FAILS_NAMING(Errc::BadFormat, "plain files", unpack(made, "backup", folder.path() / "out"));
}

}  // namespace biteline::archive
