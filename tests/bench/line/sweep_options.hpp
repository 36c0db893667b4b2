// SPDX-License-Identifier: MIT
#pragma once
/// \file Which cells of a sweep a bench is asked for, and how many of them are right, refused and wrong.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/options/command.hpp"
#include "tests/support/line_sweep.hpp"

namespace biteline::bench {

struct SweepOptions {
  std::uint64_t count{200}, seed{1}, from{0};
  std::string only{};  ///< these indices, I,J,.., instead of `count` from `from`
  std::string shoe_class{};

  /// --count, --seed, --from, --only and --class.
  void add_to(options::Command& command);
  [[nodiscard]] std::vector<std::uint64_t> indices() const;
  [[nodiscard]] bool asks_for(const test::SweepCell& cell) const;
};

/// Exit status where the bench does not begin: --help, or words that it does not know, told on stderr.
[[nodiscard]] std::optional<int> read_options(options::Command& command, int argc, char** argv);

[[nodiscard]] const char* word_for(test::Judged judged);

struct SweepTally {
  int scans{0}, right{0}, refused{0}, wrong{0};
  int plain{0}, plain_refused{0};  ///< shoes whose crease is plain to see

  void add(const test::SweepVerdict& verdict, bool plain_to_see);
  /// Members of a row, from "ours" to "plain_refused".
  [[nodiscard]] std::string row(const char* unit) const;
};

}  // namespace biteline::bench
