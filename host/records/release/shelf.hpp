// SPDX-License-Identifier: MIT
#pragma once
/// \file A cell's folder of releases: HASH/models, HASH/processes, the plan, and what is being fetched.

#include <optional>
#include <string>
#include <vector>

#include "host/records/release/manifest.hpp"
#include "host/records/release/plan.hpp"

namespace biteline::release {

/// What one scan is worked with, from its begin to its end.
struct InForce {
  std::string hash;
  std::filesystem::path models, processes;
};

/// Nothing: no release was ever switched on here.  Errc: there is no such folder, the plan cannot be read, or
/// its release is gone.
[[nodiscard]] Result<std::optional<InForce>> in_force(const std::filesystem::path& folder,
                                                      std::int64_t now_ms);

/// Thread: one owner, biteline-uplink; readers beside it see whole releases and whole plans.
class Shelf {
 public:
  explicit Shelf(std::filesystem::path folder) : folder_{std::move(folder)} {}

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Where the bytes of this release are collected.
  [[nodiscard]] std::filesystem::path part_of(const std::string& hash) const;
  [[nodiscard]] bool has(const std::string& hash) const;
  /// All that are whole.
  [[nodiscard]] std::vector<std::string> hashes() const;

  /// Checks the collected bytes and unpacks them beside, then gives them their name.  The collected bytes go,
  /// also where they are wrong: they are fetched anew.  Pre: the manifest's signature was checked.
  [[nodiscard]] Result<void> take_in(const Manifest& manifest) const;
  [[nodiscard]] Result<void> write(const Plan& plan) const;
  /// Removes whatever the plan does not name and is not `wanted`.
  [[nodiscard]] Result<void> tidy(const Plan& plan, const std::string& wanted) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace biteline::release
