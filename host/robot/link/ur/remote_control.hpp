// SPDX-License-Identifier: MIT
#pragma once
/// \file What a controller answers when it is asked whether it is in remote control.

#include <optional>
#include <string>
#include <utility>

namespace biteline::robot::ur {

/// One "no" may be a mistake: it is asked again at once, and two in a row are believed.
class RemoteControl {
 public:
  /// Nothing: a controller that does not tell (CB3), or nobody has answered.
  [[nodiscard]] std::optional<bool> told() const { return told_; }
  /// False: the same question again, at once; what was told before stays.
  [[nodiscard]] bool hear(const std::string& answer) {
    const bool no = answer == "false";
    if (no && !std::exchange(doubted_, true)) return false;
    doubted_ = no;
    told_ = no || answer == "true" ? std::optional{!no} : std::nullopt;
    return true;
  }
  void forget() { *this = {}; }

 private:
  bool doubted_{false};
  std::optional<bool> told_{};
};

}  // namespace biteline::robot::ur
