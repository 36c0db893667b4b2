// SPDX-License-Identifier: MIT
#pragma once
/// \file A batch's plan: which recordings, how they are computed, and what is computed together.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/records/batch/recording.hpp"

namespace biteline::batch {

/// How each line is looked for; part of every result's key.
struct BatchSettings {
  std::string method{"default"};
  std::string unit;  ///< of clouds; empty: as their files say, mm unless told
};

struct BatchPlan {
  BatchSettings settings;
  std::vector<Recording> recordings;             ///< by name
  std::vector<std::vector<std::size_t>> shards;  ///< indices of recordings; each once
};

struct PlanRequest {
  std::vector<Recording> recordings;
  BatchSettings settings;
  double shard_s{100};  ///< what a shard takes at least, as estimated
  int jobs{1};          ///< files read at a time
};

inline constexpr const char* k_plan_file = "plan.json";

/// Seconds of one core that a recording takes; rough, and only for the size of shards.
[[nodiscard]] double estimated_s(const Recording& recording);

/// Hashes what has no hash yet and cuts into shards.
[[nodiscard]] Result<BatchPlan> make_plan(PlanRequest request);

/// plan.json in `folder`, which is made.
[[nodiscard]] Result<void> write_plan(const std::filesystem::path& folder, const BatchPlan& plan);
[[nodiscard]] Result<BatchPlan> read_plan(const std::filesystem::path& folder);

/// The settings as one text, for keys and for people.
[[nodiscard]] std::string settings_text(const BatchSettings& settings);

}  // namespace biteline::batch
