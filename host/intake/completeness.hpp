// SPDX-License-Identifier: MIT
#pragma once
/// \file Did a scan come to its own end?  The sensor's word alone is not enough.

#include <optional>
#include <string>

#include "common/wire/messages.hpp"
#include "host/intake/cloud_builder.hpp"

namespace biteline::intake {

/// What the light did, from the health messages of a scan.
class LightAccount {
 public:
  void add(const wire::Health& health);
  /// It shone in this scan and failed then.
  [[nodiscard]] const std::optional<std::string>& fault() const { return fault_; }

 private:
  bool shone_{false};
  std::optional<std::string> fault_;
};

/// What contradicts a scan's end that says "complete": one plain sentence, or nothing.  The counts of the
/// camera's edges, the frames, the profiles and what came in must go together, and the light must not have
/// failed.
[[nodiscard]] std::optional<std::string> contradiction(const wire::EndOfScan& end,
                                                       const wire::SensorHello& hello,
                                                       const IngestCounts& counts,
                                                       std::uint64_t messages_lost,
                                                       const LightAccount& light);

}  // namespace biteline::intake
