// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/black_box.hpp"

#include <algorithm>
#include <system_error>

#include "host/intake/scan_intake.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

struct Kept {
  fs::path file;
  std::uint64_t bytes{0};
};

/// "scan-10000" is newer than "scan-9999".
bool is_older(const Kept& a, const Kept& b) {
  const std::string first = a.file.parent_path().filename().string();
  const std::string second = b.file.parent_path().filename().string();
  return first.size() != second.size() ? first.size() < second.size() : first < second;
}

}  // namespace

std::vector<fs::path> messages_to_go(const fs::path& folder, std::uint64_t most_bytes,
                                     const std::function<bool(const std::string&)>& may_go) {
  std::vector<Kept> kept;
  std::uint64_t bytes = 0;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator{folder, error}) {
    const fs::path file = entry.path() / intake::k_messages_name;
    std::error_code unseen;
    const std::uint64_t size = fs::file_size(file, unseen);
    if (unseen || !may_go(entry.path().filename().string())) continue;
    bytes += size;
    kept.push_back({.file = file, .bytes = size});
  }
  std::ranges::sort(kept, is_older);
  std::vector<fs::path> go;
  for (const Kept& one : kept) {
    if (bytes <= most_bytes || go.size() + 1 == kept.size()) break;
    bytes -= one.bytes;
    go.push_back(one.file);
  }
  return go;
}

}  // namespace biteline::service
