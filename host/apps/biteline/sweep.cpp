// SPDX-License-Identifier: MIT
// biteline sweep: shoes made by class and seed, run and merged as a batch.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string_view>
#include <utility>

#include "common/options/command.hpp"
#include "host/apps/biteline/batch_run.hpp"
#include "host/records/batch/plan.hpp"
#include "host/records/batch/recording.hpp"
#include "host/records/digest/digest.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

struct SweepOptions {
  fs::path out;
  std::vector<std::string> shoes, decoys, told;
  std::string seeds{"1-10"};
  bool sessions{false};
  double shard_s{100};
  batch::BatchSettings settings;
  BatchRunOptions run;
  BatchMergeOptions merge;
};

struct Seeds {
  std::uint64_t first{1}, last{1};
};

Result<Seeds> seeds_of(const std::string& text) {
  constexpr std::uint64_t k_most = 1'000'000;
  const std::size_t dash = text.find('-');
  const auto number = [](std::string_view part, std::uint64_t& value) {
    const auto [end, code] = std::from_chars(part.data(), part.data() + part.size(), value);
    return code == std::errc{} && end == part.data() + part.size();
  };
  Seeds seeds;
  const std::string_view all{text};
  const bool read = number(all.substr(0, dash), seeds.first) &&
                    number(dash == std::string::npos ? all : all.substr(dash + 1), seeds.last);
  if (!read || seeds.last < seeds.first || seeds.last - seeds.first >= k_most)
    return fail(Errc::InvalidArgument, "--seeds %.40s: FIRST-LAST expected, such as 1-100", text.c_str());
  return seeds;
}

/// Every class with every decoy and seed.
Result<std::vector<batch::Recording>> made_recordings(const SweepOptions& options, const fs::path& cell) {
  BITELINE_ASSIGN(const Seeds seeds, seeds_of(options.seeds));
  // Another biteline-cell makes another shoe of the same seed.
  BITELINE_ASSIGN(const std::string cell_hash, digest_of_file(cell));
  const std::vector<std::string> decoys =
      options.decoys.empty() ? std::vector<std::string>{""} : options.decoys;
  std::vector<batch::Recording> recordings;
  for (const std::string& shoe : options.shoes) {
    for (const std::string& decoy : decoys) {
      for (std::uint64_t seed = seeds.first; seed <= seeds.last; ++seed) {
        batch::Recording recording;
        recording.kind =
            options.sessions ? batch::RecordingKind::MadeSession : batch::RecordingKind::MadeCloud;
        char digits[24];
        std::snprintf(digits, sizeof digits, "%07llu", static_cast<unsigned long long>(seed));
        recording.name = shoe + (decoy.empty() ? "" : "-" + decoy) + "-" + digits;
        recording.recipe = {"--shoe", shoe, "--seed", std::to_string(seed)};
        if (!decoy.empty()) recording.recipe.insert(recording.recipe.end(), {"--decoy", decoy});
        recording.recipe.insert(recording.recipe.end(), options.told.begin(), options.told.end());
        Digest digest;
        digest.add_text(batch::name_of(recording.kind)).add_text(cell_hash);
        for (const std::string& word : recording.recipe) digest.add_text(word);
        recording.hash = digest.hex();
        recordings.push_back(std::move(recording));
      }
    }
  }
  std::ranges::sort(recordings, {}, &batch::Recording::name);
  const auto twice = std::ranges::adjacent_find(recordings, {}, &batch::Recording::name);
  if (twice != recordings.end())
    return fail(Errc::InvalidArgument, "--shoe, --decoy: %.100s twice", twice->name.c_str());
  return recordings;
}

Result<ExitStatus> sweep(const SweepOptions& options, const GlobalOptions& global) {
  report::Report report;
  std::error_code ignored;
  const fs::path cell = options.run.cell.empty()
                            ? fs::read_symlink("/proc/self/exe", ignored).parent_path() / "biteline-cell"
                            : options.run.cell;
  BITELINE_ASSIGN(std::vector<batch::Recording> recordings, made_recordings(options, cell));
  BITELINE_ASSIGN(const batch::BatchPlan plan, batch::make_plan({.recordings = std::move(recordings),
                                                                 .settings = options.settings,
                                                                 .shard_s = options.shard_s,
                                                                 .jobs = 1}));
  const fs::path folder = options.out / "batch";
  BITELINE_TRY(batch::write_plan(folder, plan));
  BITELINE_ASSIGN(const batch::BatchRun run, open_batch(folder, options.run));
  BITELINE_TRY(run_batch(run, options.run, global, report));
  return merge_batch(run, options.merge, global, report);
}

}  // namespace

void add_sweep(options::Command& app, Context& context) {
  auto options = std::make_shared<SweepOptions>();
  options::Command* command =
      app.add_subcommand("sweep", "Shoes made by class and seed, run as a batch and judged by their truth");
  add_merge_options(*command, options->merge);
  command->add_option("--shoe", options->shoes, "Classes of shoe (biteline-cell record --help lists them)")
      ->required()
      ->expected(1, 100);
  command
      ->add_option("--decoy", options->decoys, "What else runs round a designed sole; each with each class")
      ->expected(1, 100);
  command->add_option("--seeds", options->seeds, "FIRST-LAST")->capture_default_str();
  command->add_flag("--sessions", options->sessions,
                    "Pictures through the sensor's pipeline, not finished clouds: about a minute each");
  command->add_option("--tell-cell", options->told, "A further word for biteline-cell, such as --upper")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  command->add_option("--shard-s", options->shard_s, "What a shard takes at least, as estimated")
      ->capture_default_str()
      ->check(options::number({.minimum = 0, .maximum = 1e6}, "s"));
  add_build_options(*command, options->run);
  add_limit_options(*command, options->run);
  add_engine_options(*command, options->run);
  command->callback([options, &context] {
    context.run = [options, &context] {
      options->out = options->merge.out;
      return sweep(*options, context.options);
    };
  });
}

}  // namespace biteline::app
