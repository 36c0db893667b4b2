// SPDX-License-Identifier: MIT
#pragma once
/// \file Shoes added up by what they have in common.

#include <map>
#include <string>
#include <vector>

#include "tests/bench/tip/work.hpp"

namespace biteline::bench {

/// What shoes of a kind came to; off the line counts what is sent without a person's word.
struct TipTally {
  int shoes{0}, refused{0}, waits{0};
  std::vector<double> off_mm{}, largest_mm{};  ///< of all places; of each shoe

  void add(const Worked& worked);
};

/// Tallies by what they are of, printed in that order as benches are.
class TipTallies {
 public:
  /// `bench`: class, budget or arm; `what`: process and kind.
  void add(const std::string& bench, const std::string& what, const Worked& worked) {
    tallies_[{bench, what}].add(worked);
  }
  void print() const;

 private:
  std::map<std::pair<std::string, std::string>, TipTally> tallies_;
};

}  // namespace biteline::bench
