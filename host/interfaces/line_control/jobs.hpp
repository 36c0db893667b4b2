// SPDX-License-Identifier: MIT
#pragma once
/// \file The jobs that the line's control may choose: a number stands for a model, a foot, a size and
/// a process, or some of them.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::line_control {

struct Job {
  int number{0};          ///< 1 to k_most_jobs
  std::string model{};    ///< empty: as recognised, or as found
  std::string process{};  ///< empty: the model's own, or the service's
  std::string foot{};     ///< left or right; empty: as recognised, here and below
  std::string size{};     ///< as its samples name it, e.g. "EU 42"
};

inline constexpr int k_most_jobs = 999;

/// YAML: `jobs: {1: {model: NAME, foot: left, size: EU 42, process: NAME}, 2: {}}`, in the order of the
/// numbers.  An Error names file and key; a file without a job is one.
[[nodiscard]] Result<std::vector<Job>> read_jobs(const std::filesystem::path& file);

}  // namespace biteline::line_control
