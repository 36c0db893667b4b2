// SPDX-License-Identifier: MIT
#include "tests/support/shared_data.hpp"

#include <cstdio>
#include <cstdlib>

namespace biteline::test {
namespace {

int g_skipped = 0;
int g_ran = 0;

}  // namespace

std::optional<std::filesystem::path> shared_data(const std::string& relative) {
  const char* root = std::getenv("BITELINE_DATA");
  const std::filesystem::path path =
      (root != nullptr ? std::filesystem::path{root}
                       : std::filesystem::path{BITELINE_SOURCE_DIR}.parent_path() / "shared" / "data") /
      relative;
  if (!std::filesystem::exists(path)) {
    note_skipped("no shared data at " + relative);
    return std::nullopt;
  }
  note_ran();
  return path;
}

void note_skipped(const std::string& reason) {
  ++g_skipped;
  std::fprintf(stderr, "skipped: %s\n", reason.c_str());
}

void note_ran() {
  ++g_ran;
}

bool everything_was_skipped() {
  return g_skipped > 0 && g_ran == 0;
}

}  // namespace biteline::test
