// SPDX-License-Identifier: MIT
#pragma once
/// \file Where a Prometheus reads the centre: the port, and who may.

#include <filesystem>

#include "host/fleet/metrics.hpp"
#include "host/interfaces/accounts/accounts.hpp"

namespace biteline::fleet {

/// The file in the folder of accounts, of page and metrics alike.
inline constexpr const char* k_accounts_file = "accounts.sqlite";

/// Thread: the port asks on its own.
class MetricsDoor {
 public:
  /// `accounts`: their folder, made where there is none.
  [[nodiscard]] static Result<std::unique_ptr<MetricsDoor>> open(std::uint16_t port,
                                                                 const std::filesystem::path& accounts);
  [[nodiscard]] std::uint16_t port() const { return port_->port(); }
  void show(std::string text) { port_->show(std::move(text)); }

 private:
  explicit MetricsDoor(memory::Memory memory) : memory_{std::move(memory)}, accounts_{memory_} {}

  memory::Memory memory_;
  accounts::Accounts accounts_;
  std::unique_ptr<MetricsPort> port_;  ///< last: its thread uses the rest
};

}  // namespace biteline::fleet
