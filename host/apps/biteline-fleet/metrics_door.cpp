// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/metrics_door.hpp"

#include "host/interfaces/accounts/metrics_token.hpp"
#include "host/report/report.hpp"

namespace biteline::fleet {

Result<std::unique_ptr<MetricsDoor>> MetricsDoor::open(std::uint16_t port,
                                                       const std::filesystem::path& accounts) {
  BITELINE_TRY(report::prepare_folder(accounts));
  BITELINE_ASSIGN(memory::Memory memory, memory::Memory::open(accounts / k_accounts_file));
  std::unique_ptr<MetricsDoor> door{new MetricsDoor{std::move(memory)}};
  BITELINE_ASSIGN(door->port_, MetricsPort::open(port, [raw = door.get()](const std::string& token) {
                    return accounts::may_read_metrics(raw->memory_, raw->accounts_, token).value_or(false);
                  }));
  return door;
}

}  // namespace biteline::fleet
