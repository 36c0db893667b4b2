// SPDX-License-Identifier: MIT
#pragma once
/// \file Files of one folder for people outside: nothing beyond it, whatever the name or a link says.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::web {

/// A regular file, open for reading.  Move-only.
class ServedFile {
 public:
  ServedFile(int fd, std::uint64_t size_bytes, std::int64_t changed_ns)
      : fd_{fd}, size_bytes_{size_bytes}, changed_ns_{changed_ns} {}
  ServedFile(ServedFile&& other) noexcept;
  ServedFile& operator=(ServedFile&& other) noexcept;
  ~ServedFile();

  [[nodiscard]] std::uint64_t size_bytes() const { return size_bytes_; }
  [[nodiscard]] std::int64_t changed_ns() const { return changed_ns_; }
  /// Fills `out` from `offset` on; the number of bytes read, less only at the file's end.
  [[nodiscard]] Result<std::size_t> read(std::uint64_t offset, std::string& out) const;

 private:
  int fd_{-1};
  std::uint64_t size_bytes_{0};
  std::int64_t changed_ns_{0};
};

struct ListedFile {
  std::string path;  ///< within the folder
  std::uint64_t size_bytes{0};
  std::int64_t changed_ns{0};
};

inline constexpr std::size_t k_most_listed_files = 2000;
inline constexpr int k_most_listed_depth = 6;

/// Opens `folder`/`path` without following any link, and not beyond `folder` (openat2, RESOLVE_BENEATH and
/// RESOLVE_NO_SYMLINKS).  Errc::FileNotFound for whatever is no regular file there.  `path` is relative.
[[nodiscard]] Result<ServedFile> open_served_file(const std::filesystem::path& folder,
                                                  const std::string& path);

/// The regular files below `folder`/`path` by the same rules, by name; hidden ones (a leading dot) are left
/// out, and what is beyond the two bounds above.
[[nodiscard]] Result<std::vector<ListedFile>> list_served_files(const std::filesystem::path& folder,
                                                                const std::string& path);

/// UTC, ISO 8601, whole seconds.
[[nodiscard]] std::string utc_text(std::int64_t ns_since_1970);

/// By the name's ending; application/octet-stream for others.
[[nodiscard]] std::string_view content_type(std::string_view path);

}  // namespace biteline::web
