// SPDX-License-Identifier: MIT
#pragma once
/// \file Which recordings at the centre go, by age and space.

#include <cstdint>
#include <optional>
#include <vector>

namespace biteline::fleet {

struct RecordingLimits {
  std::optional<double> days;  ///< older ones go
  std::optional<double> gb;    ///< beyond so much the oldest go, but for the newest one
  [[nodiscard]] bool any() const { return days || gb; }
};

/// A whole one.
struct KeptRecording {
  std::int64_t number{0};  ///< of its fetch
  std::int64_t bytes{0};
  double age_days{0};
  bool marked{false};  ///< never goes
  bool busy{false};    ///< it is being fetched anew
};

enum class GoesBy { Age, Space };
struct Going {
  std::int64_t number{0};
  GoesBy by{GoesBy::Age};
  bool operator==(const Going&) const = default;
};
/// `kept`: oldest first.
[[nodiscard]] std::vector<Going> beyond(const RecordingLimits& limits,
                                        const std::vector<KeptRecording>& kept);

}  // namespace biteline::fleet
