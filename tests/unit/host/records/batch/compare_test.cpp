// SPDX-License-Identifier: MIT
#include "host/records/batch/compare.hpp"

#include <CppUTest/TestHarness.h>

#include "host/records/batch/merge.hpp"
#include "tests/support/refusals.hpp"
#include "tests/unit/host/records/batch/fake_build.hpp"

namespace biteline::batch {

TEST_GROUP(BatchCompare) {
  test::FakeBatch files;

  ResultSet results(const std::string& program, const std::string& name) {
    const BatchRun run = files.planned(program, name);
    RunCounts counts;
    SUCCEEDS(run_local(run, 2, {}, counts));
    auto merged = merge_run(run, files.path("merged_" + name));
    SUCCEEDS(merged);
    return std::move(*merged);
  }
  Comparison compared(const ResultSet& before, const ResultSet& after) {
    auto comparison = compare_runs(before, after);
    SUCCEEDS(comparison);
    return std::move(*comparison);
  }
};

TEST(BatchCompare, EveryRefusalHasItsRow) {
  test::check_refusal_table(CompareRefused::Worse);
}

TEST(BatchCompare, EqualBuildsHaveNoRow) {
  for (const char* name : {"a.xyz", "b.xyz", "crash.xyz", "refuse.xyz"}) files.add_cloud(name);
  const ResultSet one = results(test::fake_program(), "one"),
                  two = results(test::fake_program() + "#\n", "two");
  CHECK(one.run().build != two.run().build);
  const Comparison comparison = compared(one, two);
  LONGS_EQUAL(0, comparison.differences.size());
  LONGS_EQUAL(4, comparison.compared);
  CHECK(!refusal_of(comparison));
}

TEST(BatchCompare, ASpoiledBuildIsFoundAndItsRecordingNamed) {
  for (const char* name : {"a.xyz", "b.xyz", "c.xyz"}) files.add_cloud(name);
  const ResultSet sound = results(test::fake_program(), "sound");
  const ResultSet spoiled = results(test::fake_program("b.xyz"), "spoiled");
  const Comparison comparison = compared(sound, spoiled);
  LONGS_EQUAL(1, comparison.differences.size());
  STRCMP_EQUAL("b.xyz", comparison.differences[0].name.c_str());
  CHECK(comparison.differences[0].judgement == Judgement::Worse);
  DOUBLES_EQUAL(0.5, comparison.differences[0].moved_mm, 0.001);
  const auto refusal = refusal_of(comparison);
  CHECK(refusal.has_value());
  STRCMP_CONTAINS("b.xyz: line moved by up to 0.500 mm", refusal->reason.c_str());
  SUCCEEDS(write_comparison_page(comparison, sound, spoiled, files.path("page"), 5));
  STRCMP_CONTAINS("difference_1.svg", files.read(files.path("page/index.html")).c_str());
  STRCMP_CONTAINS("#c62828", files.read(files.path("page/difference_1.svg")).c_str());
}

TEST(BatchCompare, TheTruthDecidesWhatIsBetter) {
  files.add_cloud("truth/groove.csv");
  files.add_cloud("b.xyz", -0.4);  // the spoiled build brings it to 0.1 mm
  const ResultSet sound = results(test::fake_program(), "sound");
  const ResultSet moved = results(test::fake_program("b.xyz"), "moved");
  LONGS_EQUAL(1, compared(sound, moved).count(Judgement::Better));
  LONGS_EQUAL(0, compared(sound, moved).count(Judgement::Worse));
  LONGS_EQUAL(1, compared(moved, sound).count(Judgement::Worse));
}

TEST(BatchCompare, ALostAnswerALostRecordingAndAnotherOneAreWorse) {
  for (const char* name : {"a.xyz", "b.xyz", "c.xyz"}) files.add_cloud(name);
  const ResultSet before = results(test::fake_program(), "before");
  std::filesystem::remove(files.path("clouds/a.xyz"));
  files.add_cloud("b.xyz", 9);
  files.add_cloud("d.xyz");
  const std::string crashing =
      "#!/bin/sh\ncase $2 in */c.xyz) kill -SEGV $$ ;; esac\n" + test::fake_program();
  const Comparison comparison = compared(before, results(crashing, "after"));
  LONGS_EQUAL(3, comparison.count(Judgement::Worse));
  LONGS_EQUAL(1, comparison.added);
  STRCMP_EQUAL("not in the new run", comparison.differences[0].what.c_str());
  STRCMP_EQUAL("another recording under the same name", comparison.differences[1].what.c_str());
  STRCMP_EQUAL("ok became crashed", comparison.differences[2].what.c_str());
}

TEST(BatchCompare, APinnedBaselineJudgesAsTheRunItCameFrom) {
  for (const char* name : {"a.xyz", "b.xyz", "refuse.xyz"}) files.add_cloud(name);
  const ResultSet sound = results(test::fake_program(), "sound");
  SUCCEEDS(write_baseline(files.path("pinned.json"), sound));
  const auto pinned = ResultSet::open(files.path("pinned.json"));
  SUCCEEDS(pinned);
  LONGS_EQUAL(0, compared(*pinned, sound).differences.size());
  const Comparison comparison = compared(*pinned, results(test::fake_program("b.xyz"), "spoiled"));
  LONGS_EQUAL(1, comparison.count(Judgement::Worse));
  STRCMP_EQUAL("b.xyz", comparison.differences[0].name.c_str());
}

TEST(BatchCompare, ADamagedBaselineIsRefusedByItsKey) {
  const auto opens = [&](const std::string& text) {
    std::ofstream(files.path("pinned.json")) << text;
    return ResultSet::open(files.path("pinned.json"));
  };
  const std::string head = R"({"build":"b","settings":"s","recordings":[)";
  const std::string row = R"({"name":"a","kind":"cloud","hash":"h","verdict":"ok","line":)";
  SUCCEEDS(opens(head + row + "[[1,2,3,0.1]]}]}"));
  FAILS_NAMING(Errc::BadFormat, "line", opens(head + row + "[[1,2,3]]}]}"));
  FAILS_NAMING(Errc::BadValue, "line", opens(head + row + "[[1,2,1e300,0]]}]}"));
  FAILS_NAMING(Errc::BadValue, "verdict",
               opens(head + R"({"name":"a","kind":"cloud","hash":"h","verdict":"great"}]})"));
  FAILS_NAMING(Errc::FileNotFound, "nowhere (made by", ResultSet::open(files.path("nowhere")));
}

}  // namespace biteline::batch
