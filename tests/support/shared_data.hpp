// SPDX-License-Identifier: MIT
#pragma once
/// \file Where the recorded and made data sets are.  They are no part of the repository; tests skip without
/// them.

#include <filesystem>
#include <optional>
#include <string>

namespace biteline::test {

/// `$BITELINE_DATA/<relative>`, or `../shared/data/<relative>` beside the source tree; nothing when absent.
/// Says so once on stderr and counts as a skipped test.
[[nodiscard]] std::optional<std::filesystem::path> shared_data(const std::string& relative);

/// Says why a test does nothing here.
void note_skipped(const std::string& reason);
/// To be called by a test that did run, so that a partly skipped executable does not count as skipped.
void note_ran();

/// True when at least one test skipped and none of those that may skip ran.
[[nodiscard]] bool everything_was_skipped();

}  // namespace biteline::test

/// Declares `name`, a path in the shared data, or leaves the test as skipped.
#define BITELINE_SHARED_DATA_OR_SKIP(name, relative)                 \
  const auto name##_found = ::biteline::test::shared_data(relative); \
  if (!name##_found) return;                                         \
  const std::filesystem::path& name = *name##_found
