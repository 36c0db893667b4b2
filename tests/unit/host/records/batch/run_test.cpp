// SPDX-License-Identifier: MIT
#include "host/records/batch/run.hpp"

#include <CppUTest/TestHarness.h>

#include <map>

#include "host/records/batch/merge.hpp"
#include "host/records/digest/digest.hpp"
#include "tests/unit/host/records/batch/fake_build.hpp"

namespace biteline::batch {

TEST_GROUP(BatchRun) {
  test::FakeBatch files;

  RunCounts run_all(const BatchRun& run) {
    RunCounts counts;
    SUCCEEDS(run_local(run, 2, {}, counts));
    SUCCEEDS(count_verdicts(run, counts));
    return counts;
  }
  std::map<std::string, std::string> shard_bytes(const BatchRun& run) {
    std::map<std::string, std::string> all;
    for (std::size_t i = 0; i < run.plan.shards.size(); ++i) {
      const std::string bytes = files.read(run.shard_file(i));
      CHECK(!bytes.empty());
      all[run.shard_file(i).filename()] = bytes;
    }
    return all;
  }
};

TEST(BatchRun, CrashHangAndRefusalCostThemselvesOnlyAndAreNamed) {
  for (const char* name :
       {"a.xyz", "crash.xyz", "hang.xyz", "refuse.xyz", "review.xyz", "eat.xyz", "bad.xyz", "z.xyz"})
    files.add_cloud(name);
  BatchRun run = files.planned(test::fake_program());
  run.limits.time_s = 2;
  const RunCounts counts = run_all(run);
  LONGS_EQUAL(8, counts.computed);
  for (const auto& [verdict, count] : std::map<std::string, std::size_t>{{"ok", 2},
                                                                         {"crashed", 1},
                                                                         {"timed_out", 1},
                                                                         {"refused", 1},
                                                                         {"review", 1},
                                                                         {"out_of_memory", 1},
                                                                         {"unreadable", 1}}) {
    CHECK_TEXT(counts.by_verdict.contains(verdict), verdict.c_str());
    LONGS_EQUAL(count, counts.by_verdict.at(verdict));
  }
  LONGS_EQUAL(3, counts.without_answer.size());
  STRCMP_CONTAINS("crash.xyz: crashed: biteline: signal 11", counts.without_answer[0].c_str());
  STRCMP_CONTAINS("eat.xyz: out_of_memory", counts.without_answer[1].c_str());
  STRCMP_CONTAINS("hang.xyz: timed_out: biteline: killed after 2 s", counts.without_answer[2].c_str());
}

TEST(BatchRun, NothingIsComputedTwice) {
  files.add_cloud("a.xyz");
  files.add_cloud("b.xyz", 1);
  const BatchRun run = files.planned(test::fake_program());
  LONGS_EQUAL(2, run_all(run).computed);
  LONGS_EQUAL(0, run_all(run).computed);
  LONGS_EQUAL(2, files.asked());
  // A recording more: the old ones are known, whatever shard they are in now.
  files.add_cloud("aa.xyz", 2);
  const BatchRun grown = files.planned(test::fake_program());
  LONGS_EQUAL(1, run_all(grown).computed);
  LONGS_EQUAL(3, files.asked());
}

TEST(BatchRun, AnotherBuildOrOtherSettingsAreComputedAnew) {
  files.add_cloud("a.xyz");
  const BatchRun run = files.planned(test::fake_program());
  LONGS_EQUAL(1, run_all(run).computed);
  LONGS_EQUAL(1, run_all(files.planned(test::fake_program("a.xyz"), "other")).computed);
  BatchRun settings = run;
  settings.plan.settings.unit.append("m");
  SUCCEEDS(begin_run(settings));
  LONGS_EQUAL(1, run_all(settings).computed);
}

TEST(BatchRun, AShardThatRanTwiceGivesTheSameBytes) {
  for (const char* name : {"a.xyz", "crash.xyz", "refuse.xyz", "bad.xyz"}) files.add_cloud(name);
  const BatchRun run = files.planned(test::fake_program());
  run_all(run);
  const auto first = shard_bytes(run);
  std::filesystem::remove_all(run.folder / "store");
  std::filesystem::remove_all(run.run_folder());
  SUCCEEDS(begin_run(run));
  RunCounts counts;
  for (std::size_t shard = 0; shard < run.plan.shards.size(); ++shard)
    SUCCEEDS(run_shard(run, shard, counts));
  LONGS_EQUAL(4, counts.computed);
  CHECK(first == shard_bytes(run));
}

TEST(BatchRun, AStoppedRunGoesOnWhereItWas) {
  for (const char* name : {"a.xyz", "b.xyz", "c.xyz"}) files.add_cloud(name);
  const BatchRun run = files.planned(test::fake_program());
  RunCounts counts;
  SUCCEEDS(run_shard(run, 1, counts));
  LONGS_EQUAL(2, missing_shards(run).size());
  // A file that a broken disk left in half is no result.
  run_all(run);
  std::filesystem::resize_file(run.shard_file(2), 40);
  LONGS_EQUAL(1, missing_shards(run).size());
  LONGS_EQUAL(0, run_all(run).computed);
  LONGS_EQUAL(0, missing_shards(run).size());
}

TEST(BatchRun, WhatFailedIsComputedAgainOnRequestOnly) {
  files.add_cloud("a.xyz");
  files.add_cloud("crash.xyz", 1);
  const BatchRun run = files.planned(test::fake_program());
  run_all(run);
  LONGS_EQUAL(0, run_all(run).computed);
  SUCCEEDS(forget_failures(run));
  LONGS_EQUAL(1, run_all(run).computed);
}

TEST(BatchRun, ARecordingThatChangedSinceItWasPlannedIsNoResult) {
  files.add_cloud("a.xyz");
  const BatchRun run = files.planned(test::fake_program());
  files.add_cloud("a.xyz", 5);
  LONGS_EQUAL(1, run_all(run).by_verdict.at("changed"));
  CHECK(!run.store().find(run.key_of(run.plan.recordings[0])));
}

TEST(BatchRun, MergeHoldsAllAndSaysWhatIsMissing) {
  files.add_cloud("a.xyz");
  files.add_cloud("crash.xyz");
  const BatchRun run = files.planned(test::fake_program());
  RunCounts counts;
  SUCCEEDS(run_shard(run, 0, counts));
  FAILS_NAMING(Errc::FileNotFound, "1 of 2 shards", merge_run(run, files.path("merged")));
  run_all(run);
  const auto merged = merge_run(run, files.path("merged"));
  SUCCEEDS(merged);
  LONGS_EQUAL(2, merged->rows().size());
  STRCMP_EQUAL("a.xyz", merged->rows()[0].name.c_str());
  DOUBLES_EQUAL(400, *merged->rows()[0].outcome.length_mm, 0);
  STRCMP_EQUAL("crashed", merged->rows()[1].outcome.verdict.c_str());
  CHECK(merged->rows()[0].cost.has_value());
  const auto line = merged->line(0);
  SUCCEEDS(line);
  LONGS_EQUAL(200, line->size());
  DOUBLES_EQUAL(63, (*line)[0].x_mm, 1e-5);
  DOUBLES_EQUAL(0.06, (*line)[0].u95_mm, 1e-6);
  SUCCEEDS(write_results_page(*merged, run.plan, files.path("merged"), 3));
  const std::string page = files.read(files.path("merged/index.html"));
  STRCMP_CONTAINS("1 crashed, 1 ok", page.c_str());
  STRCMP_CONTAINS("worst_1.svg", page.c_str());
  STRCMP_CONTAINS("<polyline", files.read(files.path("merged/worst_1.svg")).c_str());
}

TEST(BatchRun, ALineIsJudgedByTheTruthBesideIt) {
  files.add_cloud("a.xyz", 0.3);
  files.add_cloud("truth/groove.csv");
  files.add_cloud("off.xyz", 3);
  const BatchRun run = files.planned(test::fake_program());
  run_all(run);
  const auto merged = merge_run(run, files.path("merged"));
  SUCCEEDS(merged);
  LONGS_EQUAL(2, merged->rows().size());
  const Outcome &near = merged->rows()[0].outcome, &off = merged->rows()[1].outcome;
  // A circle moved by d is off by d |cos a|: on average 2 / pi of it.
  DOUBLES_EQUAL(0.3 * 2 / 3.14159, *near.error_mean_mm, 0.01);
  DOUBLES_EQUAL(0.3, *near.error_max_mm, 0.01);
  // Within 0.06 mm where |cos a| is below a fifth: 0.128 of the way round.
  DOUBLES_EQUAL(0.128, *near.u95_inside, 0.02);
  CHECK(!is_wrong(near));
  CHECK(is_wrong(off));
}

}  // namespace biteline::batch
