// SPDX-License-Identifier: MIT
#include "host/records/batch/plan.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <set>

#include "host/records/digest/digest.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::batch {

TEST_GROUP(BatchPlan) {
  test::TemporaryFolder folder;

  std::string names(const std::string& manifest) {
    const auto found = find_recordings(folder.path() / manifest);
    SUCCEEDS(found);
    std::string all;
    for (const Recording& recording : *found) all += recording.name + "=" + name_of(recording.kind) + " ";
    return all;
  }
  std::string hash(RecordingKind kind, const std::string& name) {
    const auto print = fingerprint(kind, folder.path() / name);
    SUCCEEDS(print);
    return print->hash;
  }
};

TEST(BatchPlan, DigestIsThatOfTheStandard) {
  // FIPS 180-2, appendix B.1.
  STRCMP_EQUAL("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
               Digest{}.add("abc").hex().c_str());
  const auto file = digest_of_file(folder.write("abc", "abc"));
  SUCCEEDS(file);
  STRCMP_EQUAL(Digest{}.add("abc").hex().c_str(), file->c_str());
}

TEST(BatchPlan, NeighbouringTextsDoNotRunIntoEachOther) {
  CHECK(Digest{}.add_text("ab").add_text("c").hex() != Digest{}.add_text("a").add_text("bc").hex());
}

TEST(BatchPlan, FindsFoldersSessionsCloudsAndPatterns) {
  folder.write("set/one/cloud.ply", "1");
  folder.write("set/one/truth/reference.ply", "no recording");
  folder.write("set/one/stages/5.ply", "no recording");
  folder.write("set/two/cam0/data.csv", "");
  folder.write("set/two/cam0/data/cloud.ply", "a session's inside is its own");
  folder.write("set/three.mcap", "a session as one file");
  folder.write("loose/a.csv", "1");
  folder.write("loose/b.csv", "1");
  folder.write("manifest.txt", "# all of it\nset\n loose/[ab].csv # two\nset/one/cloud.ply\n");
  STRCMP_EQUAL(
      "loose/a.csv=cloud loose/b.csv=cloud set/one/cloud.ply=cloud set/three.mcap=session set/two=session ",
      names("manifest.txt").c_str());
  STRCMP_EQUAL("one/cloud.ply=cloud three.mcap=session two=session ", names("set").c_str());
  STRCMP_EQUAL("three.mcap=session ", names("set/three.mcap").c_str());
  folder.write("same.mcap", "a session as one file");
  folder.write("other.mcap", "another session");
  const std::string print = hash(RecordingKind::Session, "set/three.mcap");
  CHECK(print == hash(RecordingKind::Session, "same.mcap"));
  CHECK(print != hash(RecordingKind::Session, "other.mcap"));
}

TEST(BatchPlan, NamesTheLineOfAManifestThatFindsNothing) {
  folder.write("a.ply", "1");
  folder.write("m.txt", "a.ply\n\nnothing_*.ply\n");
  FAILS_NAMING(Errc::FileNotFound, "m.txt line 3", find_recordings(folder.path() / "m.txt"));
  folder.write("n.txt", "missing\n");
  FAILS_NAMING(Errc::FileNotFound, "missing", find_recordings(folder.path() / "n.txt"));
}

TEST(BatchPlan, TheHashFollowsAllThatDecidesTheResult) {
  folder.write("a/cloud.ply", "points");
  folder.write("b/cloud.ply", "points");
  folder.write("c/cloud.ply", "pointz");
  folder.write("d/cloud.xyz", "points");
  folder.write("e/cloud.ply", "points");
  folder.write("e/truth/groove.csv", "truth");
  const std::string plain = hash(RecordingKind::Cloud, "a/cloud.ply");
  STRCMP_EQUAL(plain.c_str(), hash(RecordingKind::Cloud, "b/cloud.ply").c_str());
  for (const char* other : {"c/cloud.ply", "d/cloud.xyz", "e/cloud.ply"})
    CHECK_TEXT(plain != hash(RecordingKind::Cloud, other), other);

  folder.write("s/cam0/data.csv", "frames");
  folder.write("s/pose0/data.csv", "poses");
  const std::string before = hash(RecordingKind::Session, "s");
  folder.write("s/pose0/data.csv", "poses moved");
  CHECK(before != hash(RecordingKind::Session, "s"));
}

TEST(BatchPlan, EveryRecordingIsInOneShardOfTheWantedSize) {
  PlanRequest request;
  for (int i = 0; i < 40; ++i) {
    request.recordings.push_back({.name = std::to_string(100 + i),
                                  .kind = RecordingKind::Cloud,
                                  .path = "/x",
                                  .recipe = {},
                                  .hash = "h",
                                  .bytes = 1'000'000});
  }
  request.shard_s = 5;
  const double each_s = estimated_s(request.recordings.front());
  const auto plan = make_plan(request);
  SUCCEEDS(plan);
  std::set<std::size_t> seen;
  for (std::size_t i = 0; i < plan->shards.size(); ++i) {
    for (const std::size_t index : plan->shards[i]) CHECK(seen.insert(index).second);
    if (i + 1 < plan->shards.size()) CHECK(static_cast<double>(plan->shards[i].size()) * each_s >= 5);
  }
  LONGS_EQUAL(40, seen.size());
  CHECK(plan->shards.size() > 2);
}

TEST(BatchPlan, ReadsWhatItWrote) {
  BatchPlan plan{
      .settings = {.method = "default", .unit = "in"},
      .recordings =
          {{.name = "a", .kind = RecordingKind::Session, .path = "/a", .recipe = {}, .hash = "1", .bytes = 7},
           {.name = "b",
            .kind = RecordingKind::MadeCloud,
            .path = {},
            .recipe = {"--seed", "3"},
            .hash = "2",
            .bytes = 0}},
      .shards = {{1}, {0}}};
  SUCCEEDS(write_plan(folder.path() / "out", plan));
  const auto read = read_plan(folder.path() / "out");
  SUCCEEDS(read);
  STRCMP_EQUAL("in", read->settings.unit.c_str());
  LONGS_EQUAL(2, read->recordings.size());
  STRCMP_EQUAL("/a", read->recordings[0].path.c_str());
  CHECK(read->recordings[1].kind == RecordingKind::MadeCloud);
  STRCMP_EQUAL("3", read->recordings[1].recipe[1].c_str());
  CHECK(read->shards == plan.shards);
}

TEST(BatchPlan, RefusesADamagedPlan) {
  const auto reads = [&](const std::string& text) {
    folder.write("plan.json", text);
    return read_plan(folder.path());
  };
  const std::string head = R"({"settings":{"method":"default","unit":""},)";
  const std::string one = R"("recordings":[{"name":"a","kind":"cloud","path":"/a","hash":"1","bytes":1}],)";
  SUCCEEDS(reads(head + one + R"("shards":[[0]]})"));
  FAILS_NAMING(Errc::BadValue, "in none", reads(head + one + R"("shards":[]})"));
  FAILS_NAMING(Errc::BadValue, "twice or unknown", reads(head + one + R"("shards":[[0],[0]]})"));
  FAILS_NAMING(Errc::BadFormat, "shards", reads(head + one + R"("shards":[[-1]]})"));
  FAILS_NAMING(Errc::BadFormat, "settings", reads("{}"));
  FAILS_NAMING(Errc::BadFormat, "plan.json", reads("[]"));
}

}  // namespace biteline::batch
