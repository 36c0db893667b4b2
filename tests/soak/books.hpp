// SPDX-License-Identifier: MIT
#pragma once
/// \file What a scan's folder says became of it, and the sums that must come out even.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/soak/faults.hpp"

namespace biteline::soak {

struct ScanAccount {
  Outcome outcome{Outcome::Open};
  int profiles{0};
  std::string reason;     ///< code and words, where there is one
  bool permitted{false};  ///< the gate's decision
  std::string script;     ///< the path's own
  bool own_arm{false};    ///< it was planned with the arm's own kinematics
};

[[nodiscard]] ScanAccount read_account(const std::filesystem::path& scan);

/// Memory of one process through its life.
class MemoryBook {
 public:
  void note(const std::string& process, int pid, double mb);
  /// A life of twenty notes and more that grew from its second fifth to its last by more than a tenth and 10
  /// MB.
  [[nodiscard]] std::vector<std::string> growths() const;
  [[nodiscard]] std::string table() const;

 private:
  struct Life {
    int pid{0};
    std::vector<double> mb;
  };
  std::map<std::string, std::vector<Life>> lives_;
};

}  // namespace biteline::soak
