// SPDX-License-Identifier: MIT
#pragma once
/// \file Files on their way through the doors: in by pieces, out by name.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::api {

/// One folder, the service's own; what a killed service left there goes when the next one begins.
/// Thread: one at a time.
class Exchange {
 public:
  using Clock = std::chrono::steady_clock;
  /// A model of two million points has 60 MB.
  static constexpr std::uint64_t k_most_bytes = 256U << 20U;
  static constexpr std::size_t k_most_uploads = 4;
  static constexpr std::size_t k_most_downloads = 8;
  static constexpr std::chrono::seconds k_idle{60};

  explicit Exchange(std::filesystem::path folder);

  /// The next piece of what `owner` brings.  At 0 it begins anew.  Errc::WrongState: not where the last piece
  /// ended, too much, or too many bring something at once; what was there goes.
  [[nodiscard]] Result<void> add(const std::string& owner, std::uint64_t at, std::string_view piece);
  /// What `owner` has brought; empty: nothing.
  [[nodiscard]] std::filesystem::path brought_by(const std::string& owner) const;
  void drop(const std::string& owner);

  /// A fresh file's name, for a door to read soon: the oldest of k_most_downloads goes for it.
  [[nodiscard]] Result<std::filesystem::path> outgoing();

  /// Removes what nobody has added to for k_idle.
  void forget_idle(Clock::time_point now = Clock::now());

 private:
  struct Upload {
    std::string owner;
    std::filesystem::path file;
    std::uint64_t bytes{0};
    Clock::time_point last{};
  };
  [[nodiscard]] Result<std::filesystem::path> fresh(const char* kind);

  std::filesystem::path folder_;
  std::vector<Upload> uploads_;
  std::vector<std::filesystem::path> downloads_;
  std::uint64_t made_{0};
};

}  // namespace biteline::api
