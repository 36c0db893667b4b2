// SPDX-License-Identifier: MIT
#pragma once
/// \file Which scans are kept: every so many, or those that somebody asks for, the last one included.

#include <cstdint>
#include <filesystem>

#include "common/core/result.hpp"

namespace biteline::record {

/// The first of each `every` scans that began.  Thread: one owner.
class EveryNth {
 public:
  explicit EveryNth(std::uint32_t every) : every_{every} {}
  [[nodiscard]] bool due() const { return passed_ % every_ == 0; }
  void pass() { ++passed_; }

 private:
  std::uint32_t every_;
  std::uint64_t passed_{0};
};

// Scans that nobody asked for yet wait under another name; the newest stays until the next one is written.
// Asking is done by files beside them, by any program that may write there.

/// "scan-last" of "scan", "scan-last.mcap" of "scan.mcap".
[[nodiscard]] std::filesystem::path waiting_name(const std::filesystem::path& series);

/// Gives the newest scan that waits and is not being written its name in the series, which it returns.
/// Errc::FileNotFound: none waits.
[[nodiscard]] Result<std::filesystem::path> keep_last(const std::filesystem::path& series);
/// The scan that ends next is kept.  Errc::DiskFull, Errc::WriteFailed.
[[nodiscard]] Result<void> keep_next(const std::filesystem::path& series);

/// For who wrote `waiting` and still holds it: its name in the series where somebody asked for it; else
/// where it was.
[[nodiscard]] Result<std::filesystem::path> settle_wish(const std::filesystem::path& waiting,
                                                        const std::filesystem::path& series);

}  // namespace biteline::record
