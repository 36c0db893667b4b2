// SPDX-License-Identifier: MIT
#pragma once
/// \file What the factory's centre says of this cell's shoes, from biteline-uplink to the service: one file
/// in the folder of results.
///
/// The uplink writes no memory, and the service knows no network.  A row that the centre could not read is
/// kept here with its reason; the row itself stands in the memory as ever.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::centre_word {

inline constexpr const char* k_file = "centre.json";
/// The oldest goes; `count` still has it.
inline constexpr std::size_t k_most_letters = 1000;

/// A row that the centre has without what it could not read.
struct DeadLetter {
  std::string book;     ///< of the memory file
  std::int64_t seq{0};  ///< of the outbox
  std::string scan;
  std::string why;
  std::string time;  ///< when the cell heard of it
  bool operator==(const DeadLetter&) const = default;
};

struct CentreWord {
  std::int64_t count{0};              ///< of all dead letters that were ever heard of
  std::vector<DeadLetter> letters{};  ///< oldest first
  std::string held{};                 ///< why the centre takes rows later; empty: it does not
  bool operator==(const CentreWord&) const = default;
  /// Takes what is not known yet.  False: it is.
  bool add(DeadLetter letter);
};

/// None is an empty one.  Errc::BadFormat: it is damaged.
[[nodiscard]] Result<CentreWord> read(const std::filesystem::path& results);
[[nodiscard]] Result<void> write(const std::filesystem::path& results, const CentreWord& word);

}  // namespace biteline::centre_word
