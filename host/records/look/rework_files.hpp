// SPDX-License-Identifier: MIT
#pragma once
/// \file What a rework reads of a look, and what it leaves beside the first scan.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/second_look/second_look.hpp"

namespace biteline::look {

/// A report of a second look.
struct LookRead {
  bool refused{false};
  std::string line_sha256, process_sha256, foot, sha256;  ///< the last one of the report itself
  second_look::PlannedBand plan{};
  double line_mm{0};
  std::vector<second_look::Fault> faults{};
};

/// Of a look's folder.  Fails for a report of something else, or of a look before there was a rework.
[[nodiscard]] Result<LookRead> read_look(const std::filesystem::path& folder);

/// rework.json beside the first scan's line: that the shoe was worked once more.
struct ReworkRecord {
  std::string look_sha256;
  std::size_t pieces{0};
  std::string decided_by{};  ///< empty: by itself
};

/// How often; none: the file is not there.
[[nodiscard]] Result<std::size_t> reworks_of(const std::filesystem::path& first);

/// Writes down that it is, before its path is written.  The first one fails where another one was quicker.
[[nodiscard]] Result<void> record_rework(const std::filesystem::path& first, const ReworkRecord& record);

}  // namespace biteline::look
