// SPDX-License-Identifier: MIT
#pragma once
/// \file A folder as the bytes of one tar file, from any place on, without writing it anywhere.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::archive {

/// The same folder gives the same bytes, whoever opens it again.  Thread: one owner.
class TarStream {
 public:
  /// The regular files below `folder` by name, under its own name; hidden ones and links are left out.
  /// Errc::FileNotFound: no such folder; Errc::SizeMismatch: more than `most_bytes`, or too many files;
  /// Errc::BadValue: a file's name is none for an archive.
  [[nodiscard]] static Result<TarStream> open(const std::filesystem::path& folder, std::uint64_t most_bytes);

  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  /// At most `most` bytes, less only at the end.  Errc::SizeMismatch: a file is not as long as it was;
  /// Errc::FileNotFound: it is gone.
  [[nodiscard]] Result<std::string> read(std::uint64_t at, std::size_t most) const;

 private:
  struct File {
    std::string name;  ///< within the archive
    std::filesystem::path path;
    std::uint64_t bytes{0};
    std::uint64_t begin{0};  ///< of its header
  };
  [[nodiscard]] Result<void> add_file(const File& file, std::uint64_t at, std::string& out,
                                      std::size_t most) const;

  std::vector<File> files_;
  std::uint64_t bytes_{0};
};

}  // namespace biteline::archive
