// SPDX-License-Identifier: MIT
#pragma once
/// \file One holder at a time of something that a file stands for.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"

namespace biteline::report {

/// A lock of the kernel (flock) that ends with its process, however that ends; the file stays.  Move-only.
class FileLock {
 public:
  /// Errc::PeerRefused, naming who holds it, when another one does.  `holder`: one line about the caller.
  /// A file of another user serves as well, and keeps that user's line.
  [[nodiscard]] static Result<FileLock> take(const std::filesystem::path& file, const std::string& holder);

  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;
  ~FileLock();

 private:
  explicit FileLock(int fd) : fd_{fd} {}
  int fd_{-1};
};

/// Takes the lock of an open file; Errc::PeerRefused with `what` when another one has it.
[[nodiscard]] Result<void> lock_open_file(int fd, const std::string& what);

}  // namespace biteline::report
