// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/served_folder.hpp"

#include <CppUTest/TestHarness.h>
#include <sys/stat.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::web {

TEST_GROUP(ServedFolder) {
  test::TemporaryFolder folder;
  std::filesystem::path root = folder.path() / "results";

  void setup() override {
    folder.write("secret.txt", "secret");
    folder.write("results/scan-0001/line.csv", "0123456789");
    folder.write("results/scan-0001/stages/1.png", "png");
    folder.write("results/scan-0001/.part", "hidden");
    std::filesystem::create_symlink("../../secret.txt", root / "scan-0001/link.txt");
    std::filesystem::create_directory_symlink("../..", root / "scan-0001/up");
    std::filesystem::create_symlink("line.csv", root / "scan-0001/own.csv");
    LONGS_EQUAL(0, mkfifo((root / "scan-0001/pipe").c_str(), 0600));
  }
};

TEST(ServedFolder, AFileIsReadFromAnyPlace) {
  const auto file = open_served_file(root, "scan-0001/line.csv");
  SUCCEEDS(file);
  LONGS_EQUAL(10, file->size_bytes());
  std::string piece(4, '\0');
  LONGS_EQUAL(4, *file->read(3, piece));
  STRCMP_EQUAL("3456", piece.c_str());
  LONGS_EQUAL(2, *file->read(8, piece));
  LONGS_EQUAL(0, *file->read(100, piece));
}

TEST(ServedFolder, NothingBeyondItIsOpened) {
  for (const char* path : {"../secret.txt", "scan-0001/../../secret.txt", "/etc/passwd", "scan-0001/link.txt",
                           "scan-0001/up/secret.txt", "scan-0001/own.csv", "scan-0001", "scan-0001/", "", ".",
                           "scan-0002/line.csv", "scan-0001/pipe"}) {
    CHECK_TEXT(!open_served_file(root, path), path);
  }
  FAILS_NAMING(Errc::FileNotFound, "gone", open_served_file(folder.path() / "none", "gone"));
}

TEST(ServedFolder, TheListHasFilesOnly) {
  const auto files = list_served_files(root, "scan-0001");
  SUCCEEDS(files);
  LONGS_EQUAL(2, files->size());
  STRCMP_EQUAL("line.csv", files->at(0).path.c_str());
  LONGS_EQUAL(10, files->at(0).size_bytes);
  STRCMP_EQUAL("stages/1.png", files->at(1).path.c_str());
  CHECK(!list_served_files(root, "scan-0001/up"));
  CHECK(!list_served_files(root, ".."));
  CHECK(!list_served_files(root, "scan-0001/line.csv"));
}

TEST(ServedFolder, ManyFilesEndTheList) {
  for (std::size_t i = 0; i < k_most_listed_files + 10; ++i) {
    folder.write("results/scan-0002/" + std::to_string(i), "");
  }
  LONGS_EQUAL(k_most_listed_files, list_served_files(root, "scan-0002")->size());
}

TEST(ServedFolder, TimesAndTypesAreTheWebs) {
  STRCMP_EQUAL("1970-01-02T00:00:01Z", utc_text(86'401'000'000'000).c_str());
  STRCMP_EQUAL("image/png", std::string{content_type("stages/1.png")}.c_str());
  STRCMP_EQUAL("application/octet-stream", std::string{content_type("cloud.ply")}.c_str());
  STRCMP_EQUAL("application/octet-stream", std::string{content_type("png")}.c_str());
}

}  // namespace biteline::web
