// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether an MCAP file is what its writer wrote: every check sum, index, count and link of the chain.

#include <filesystem>
#include <map>

#include "common/mcap/records.hpp"

namespace biteline::mcap {

struct Fault {
  std::uint64_t at{0};  ///< byte in the file
  std::string what;
};

struct TopicCount {
  std::uint64_t messages{0};
  std::string sha256;  ///< of all its messages' data, in file order
};

struct Verdict {
  std::string library;  ///< who wrote it, as the file says
  std::map<std::string, TopicCount> topics;
  std::uint64_t messages{0};
  std::uint64_t chunks{0};
  std::uint64_t attachments{0};
  std::uint64_t metadata{0};
  std::uint64_t links{0};     ///< of the hash chain; 0: the file has none
  std::string last_link;      ///< 64 digits
  bool check_sums{true};      ///< false: the file leaves some out, what they would cover is unchecked
  std::vector<Fault> faults;  ///< at most k_most_faults; empty: the file is whole
  std::uint64_t more_faults{0};
};

inline constexpr std::size_t k_most_faults = 20;

/// Reads the whole file.  In a file with a chain a single changed byte, wherever it is, makes a fault.  The
/// chain itself has no key: who can write can write it anew, but for the last link that somebody else kept.
/// Errc::BadFormat when it is no MCAP file.
[[nodiscard]] Result<Verdict> verify(const std::filesystem::path& file);

}  // namespace biteline::mcap
