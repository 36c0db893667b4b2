// SPDX-License-Identifier: MIT
#include "host/transfer/library.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>

#include <fstream>

#include "host/cloud/ply.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::transfer {

TEST_GROUP(Library) {
  test::TemporaryFolder folder;
  Library sut{folder.path() / "models"};

  /// A sample of `points` points and a triangle as its line.
  std::filesystem::path sample(std::size_t points) const {
    const std::filesystem::path path = folder.path() / ("sample" + std::to_string(points));
    std::filesystem::create_directories(path);
    cloud::PointCloud cloud;
    for (std::size_t i = 0; i < points; ++i) cloud.points.emplace_back(static_cast<float>(i), 0.0F, 1.0F);
    SUCCEEDS(cloud::write_cloud(path / k_cloud_file, cloud));
    cloud::ClosedLine line;
    for (const Vec3& position : {Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{0, 4, 0}}) {
      line.points.push_back(
          {.position = position, .normal = Vec3::UnitZ(), .tangent = Vec3::UnitX(), .confidence = 1});
    }
    SUCCEEDS(cloud::write_line(path / k_line_file, line));
    return path;
  }

  void overwrite(const std::string& model, const char* file, const std::string& bytes) const {
    std::ofstream(sut.path_of(model) / file, std::ios::binary) << bytes;
  }
};

TEST(Library, WhatIsSavedIsLoadedAgain) {
  SUCCEEDS(sut.save("runner-42", sample(7)));
  const Result<SampleFiles> loaded = sut.load("runner-42");
  SUCCEEDS(loaded);
  LONGS_EQUAL(7, loaded->cloud.size());
  LONGS_EQUAL(3, loaded->line.points.size());
  const Result<std::vector<ModelInfo>> list = sut.list();
  SUCCEEDS(list);
  LONGS_EQUAL(1, list->size());
  STRCMP_EQUAL("runner-42", list->front().name.c_str());
  LONGS_EQUAL(7, list->front().points);
  DOUBLES_EQUAL(12.0, list->front().line_length_mm, 1e-6);
}

TEST(Library, ALineThatAPersonMustSettleIsNoSample) {
  const std::filesystem::path path = sample(7);
  Result<cloud::ClosedLine> line = cloud::read_line(path / k_line_file);
  SUCCEEDS(line);
  for (cloud::LinePoint& point : line->points) point.flags = cloud::k_line_unsure;
  SUCCEEDS(cloud::write_line(path / k_line_file, *line));
  FAILS_NAMING(Errc::Refused, "settle", sut.save("open", path));
  CHECK(!sut.load("open"));
}

TEST(Library, ALineWhoseReportRefusesItIsNoSample) {
  const std::filesystem::path path = sample(7);
  std::ofstream(path / "report.json") << R"({"status":"refused","reason_code":"line_check"})";
  FAILS_NAMING(Errc::Refused, "refused", sut.save("open", path));
  std::ofstream(path / "report.json") << R"({"status":"ok"})";
  SUCCEEDS(sut.save("open", path));
}

TEST(Library, ManifestThatNamesAnotherFileIsDamagedAndThatFileStaysUnread) {
  SUCCEEDS(sut.save("a", sample(7)));
  std::ifstream in(sut.path_of("a") / "model.json");
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  for (const char* foreign : {"/dev/zero", "../a/line.csv", "model.json", "..", "", "sub/line.csv"}) {
    std::string text = good;
    const std::string extra =
        std::string{"{\"name\": \""} + foreign + "\", \"bytes\": 1, \"crc32c\": \"0\"}, {";
    text.replace(text.find('{', text.find("\"files\"")), 1, extra);
    overwrite("a", "model.json", text);
    FAILS_NAMING(Errc::BadFormat, "is no file of a model", sut.load("a"));
  }
  std::filesystem::remove(sut.path_of("a") / "model.json");
  std::filesystem::create_symlink("/dev/zero", sut.path_of("a") / "model.json");
  FAILS_NAMING(Errc::FileUnreadable, "a regular file expected", sut.load("a"));
}

TEST(Library, SavingAgainReplacesAndLeavesNothingBeside) {
  SUCCEEDS(sut.save("a", sample(7)));
  FAILS_NAMING(Errc::InvalidArgument, "--replace", sut.save("a", sample(9)));
  SUCCEEDS(sut.save("a", sample(9), {.replace = true}));
  LONGS_EQUAL(9, sut.load("a")->cloud.size());
  std::vector<std::string> entries;
  for (const auto& entry : std::filesystem::directory_iterator(sut.folder()))
    entries.push_back(entry.path().filename().string());
  std::sort(entries.begin(), entries.end());
  CHECK((entries == std::vector<std::string>{".undo", "a"}));
  LONGS_EQUAL(1, sut.list()->size());
}

TEST(Library, UndoBringsBackWhatWasReplacedOrRemoved) {
  SUCCEEDS(sut.save("a", sample(7)));
  LONGS_EQUAL(2, sut.save("a", sample(9), {.replace = true})->made.version);
  SUCCEEDS(sut.undo("a"));
  LONGS_EQUAL(7, sut.load("a")->cloud.size());
  SUCCEEDS(sut.undo("a"));  // undo of the undo
  LONGS_EQUAL(9, sut.load("a")->cloud.size());
  SUCCEEDS(sut.remove("a"));
  SUCCEEDS(sut.undo("a"));
  LONGS_EQUAL(9, sut.load("a")->cloud.size());
  FAILS_NAMING(Errc::FileNotFound, "nothing to undo", sut.undo("b"));
}

TEST(Library, ARenamedModelIsTheSameUnderItsNewNameAlone) {
  ModelMade made;
  made.size = "EU 42";
  SUCCEEDS(sut.save("a", sample(7), {.made = made}));
  SUCCEEDS(sut.save("b", sample(9)));
  FAILS_NAMING(Errc::InvalidArgument, "model b exists", sut.rename("a", "b"));
  LONGS_EQUAL(9, sut.load("b")->cloud.size());
  FAILS_NAMING(Errc::FileNotFound, "no model c", sut.rename("c", "d"));
  CHECK_FALSE(sut.rename("a", "../a").has_value());
  const auto renamed = sut.rename("a", "c");
  SUCCEEDS(renamed);
  STRCMP_EQUAL("c", renamed->name.c_str());
  STRCMP_EQUAL("EU 42", sut.info("c")->made.size.c_str());
  LONGS_EQUAL(7, sut.load("c")->cloud.size());
  CHECK(!sut.has("a"));
  LONGS_EQUAL(2, sut.names()->size());
}

TEST(Library, SizeFootAndTimeGoWithTheModel) {
  ModelMade made;
  made.time = "2026-11-20T21:04:05.123Z";
  made.size = "EU 42";
  made.foot = "left";
  made.scan = "scan-0007";
  SUCCEEDS(sut.save("a", sample(7), {.made = made}));
  const auto info = sut.info("a");
  SUCCEEDS(info);
  STRCMP_EQUAL("EU 42", info->made.size.c_str());
  STRCMP_EQUAL("left", info->made.foot.c_str());
  STRCMP_EQUAL("scan-0007", info->made.scan.c_str());
  LONGS_EQUAL(1, info->made.version);
}

TEST(Library, TheProcessGoesWithTheModel) {
  const std::filesystem::path process = folder.write("cement.yaml", "tool: spray\n");
  SUCCEEDS(sut.save("a", sample(7), {.process_file = process}));
  CHECK(sut.list()->front().has_process);
  CHECK(std::filesystem::exists(sut.path_of("a") / k_process_file));
}

TEST(Library, ADamagedModelIsRefusedByName) {
  struct Row {
    const char* file;
    std::string bytes;
    Errc code;
    const char* words;
  };
  const std::filesystem::path source = sample(7);
  SUCCEEDS(sut.save("good", source));
  std::ifstream in(sut.path_of("good") / k_cloud_file, std::ios::binary);
  std::string flipped{std::istreambuf_iterator<char>(in), {}};
  flipped.back() = static_cast<char>(flipped.back() ^ 1);
  for (const Row& row : {Row{k_cloud_file, "short", Errc::SizeMismatch, "cloud.ply has 5 bytes"},
                         Row{k_cloud_file, flipped, Errc::BadValue, "cloud.ply does not match its checksum"},
                         Row{"model.json", "{", Errc::BadFormat, "model.json"},
                         Row{"model.json", "{\"format\":1,\"points\":1,\"line_length_mm\":1,\"files\":[]}",
                             Errc::BadFormat, "does not name cloud.ply"}}) {
    SUCCEEDS(sut.save("bad", source, {.replace = true}));
    overwrite("bad", row.file, row.bytes);
    FAILS_NAMING(row.code, "model bad is damaged", sut.load("bad"));
    FAILS_NAMING(row.code, row.words, sut.load("bad"));
    LONGS_EQUAL(2, sut.list()->size());
    CHECK(sut.list()->front().damage.has_value());  // "bad" comes before "good"
    CHECK_FALSE(sut.list()->back().damage.has_value());
  }
  SUCCEEDS(sut.save("bad", source, {.replace = true}));
  std::filesystem::remove(sut.path_of("bad") / k_line_file);
  FAILS_NAMING(Errc::FileNotFound, "model bad is damaged: line.csv is missing", sut.load("bad"));
}

TEST(Library, ExportedModelComesBackElsewhereWhole) {
  folder.write("grind.yaml", "name: grind\n");
  ModelMade made;
  made.size = "EU 42";
  SUCCEEDS(sut.save("runner-42", sample(7), {.process_file = folder.path() / "grind.yaml", .made = made}));
  const std::filesystem::path file = folder.path() / "runner.tar";
  SUCCEEDS(sut.export_to("runner-42", file));
  FAILS_NAMING(Errc::FileNotFound, "no model", sut.export_to("boot", folder.path() / "boot.tar"));

  const Library other{folder.path() / "other"};
  const Result<ModelInfo> model = other.import_from(file, "", false);
  SUCCEEDS(model);
  STRCMP_EQUAL("runner-42", model->name.c_str());
  STRCMP_EQUAL("EU 42", model->made.size.c_str());
  CHECK(model->has_process);
  LONGS_EQUAL(7, other.load("runner-42")->cloud.size());
  FAILS_NAMING(Errc::InvalidArgument, "--replace", other.import_from(file, "", false));
  const Result<ModelInfo> again = other.import_from(file, "", true);
  SUCCEEDS(again);
  LONGS_EQUAL(2, again->made.version);
  SUCCEEDS(other.import_from(file, "runner-43", false));
  LONGS_EQUAL(7, other.load("runner-43")->cloud.size());
  LONGS_EQUAL(2, other.list()->size());
  FAILS_NAMING(Errc::InvalidArgument, "model name", other.import_from(file, "../out", false));
}

TEST(Library, DamagedExportChangesNothing) {
  SUCCEEDS(sut.save("a", sample(7)));
  const std::filesystem::path file = folder.path() / "a.tar";
  SUCCEEDS(sut.export_to("a", file));
  std::ifstream in(file, std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  const Library other{folder.path() / "other"};
  const auto import_of = [&](const std::string& bytes) {
    std::ofstream(folder.path() / "bad.tar", std::ios::binary) << bytes;
    return other.import_from(folder.path() / "bad.tar", "", false);
  };
  // The two empty blocks at the end say nothing; all before them counts.
  for (std::size_t bytes = 0; bytes + 1024 < good.size(); bytes += 200)
    CHECK_TEXT(!import_of(good.substr(0, bytes)).has_value(), std::to_string(bytes).c_str());
  std::string changed = good;
  changed[600] = static_cast<char>(changed[600] ^ 1);
  CHECK(!import_of(changed).has_value());
  CHECK(other.list()->empty());
  SUCCEEDS(import_of(good));
}

TEST(Library, RemovedIsGone) {
  SUCCEEDS(sut.save("a", sample(7)));
  SUCCEEDS(sut.remove("a"));
  CHECK(sut.list()->empty());
  FAILS_NAMING(Errc::FileNotFound, "no model a", sut.load("a"));
  FAILS_NAMING(Errc::FileNotFound, "no model a", sut.remove("a"));
}

TEST(Library, NamesThatCouldLeaveTheFolderAreRefused) {
  for (const char* name : {"", "..", "../x", "a/b", ".hidden", "two words"}) {
    FAILS_NAMING(Errc::InvalidArgument, "model name", sut.save(name, sample(7)));
    CHECK_FALSE(sut.load(name).has_value());
    CHECK_FALSE(sut.remove(name).has_value());
  }
}

TEST(Library, AScanThatWasRefusedIsNoSample) {
  const std::filesystem::path path = sample(7);
  std::filesystem::remove(path / k_line_file);
  folder.write("sample7/report.json", "{\"status\": \"refused\"}");
  FAILS_NAMING(Errc::FileNotFound, "this scan has no line", sut.save("a", path));
  CHECK(sut.list()->empty());
}

TEST(Library, OneThatDoesNotExistYetIsEmpty) {
  CHECK(sut.list()->empty());
}

}  // namespace biteline::transfer
