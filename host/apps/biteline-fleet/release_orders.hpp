// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline-fleet --offer`, `--releases`, `--switch`, `--forget`: what a person orders beside the
/// running centre.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/core/error.hpp"
#include "host/fleet/centre.hpp"

namespace biteline::options {
class Command;
}

namespace biteline::fleet {

struct ReleaseOrders {
  std::filesystem::path offer;
  std::vector<std::string> cells;  ///< of --offer; empty: all that the centre knows
  std::filesystem::path turn;      ///< a signed order
  std::optional<std::int64_t> order, forget;
  std::filesystem::path out;  ///< of --order
  int in_s{600};
  std::int64_t after{0};  ///< of --order and --switch: a newer switch that a person knows of
  bool list{false};

  [[nodiscard]] bool any() const { return !offer.empty() || order || !turn.empty() || forget || list; }
};

void add_release_options(options::Command& app, ReleaseOrders& orders);
/// Prints what came of it; Refused where a switch was withdrawn.
[[nodiscard]] Result<ExitStatus> carry_out(const ReleaseOrders& orders, Centre& centre, bool json);

}  // namespace biteline::fleet
