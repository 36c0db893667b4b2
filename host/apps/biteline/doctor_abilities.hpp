// SPDX-License-Identifier: MIT
#pragma once
/// \file What a person can do with this machine, from what of it is ready.

#include <string>
#include <vector>

namespace biteline::app {

/// One thing that was looked at.
struct Finding {
  std::string what;
  bool ready{false};
  std::string seen;
  std::string step;  ///< empty when ready
};

struct Ability {
  std::string what;
  std::vector<std::string> missing;  ///< what of the findings, and what was seen there

  [[nodiscard]] bool can() const { return missing.empty(); }
  /// In one sentence; empty where it can be done.
  [[nodiscard]] std::string because() const;
};

/// Of the machine; of the board and the robot where they were looked at.
[[nodiscard]] std::vector<Ability> abilities_of(const std::vector<Finding>& findings);

}  // namespace biteline::app
