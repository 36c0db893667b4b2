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

namespace CLI {
class App;
}

namespace biteline::fleet {

struct ReleaseOrders {
  std::filesystem::path offer;
  std::vector<std::string> cells;  ///< of --offer; empty: all that the centre knows
  std::optional<std::int64_t> turn, forget;
  int in_s{30};
  bool list{false};

  [[nodiscard]] bool any() const { return !offer.empty() || turn || forget || list; }
};

void add_release_options(CLI::App& app, ReleaseOrders& orders);
/// Prints what came of it; Refused where a switch was withdrawn.
[[nodiscard]] Result<ExitStatus> carry_out(const ReleaseOrders& orders, Centre& centre, bool json);

}  // namespace biteline::fleet
