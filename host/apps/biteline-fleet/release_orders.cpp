// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/release_orders.hpp"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <thread>

#include "host/doors/control/messages.hpp"
#include "host/fleet/program.hpp"
#include "host/fleet/releases.hpp"

namespace biteline::fleet {
namespace {

using control::Json;

constexpr int k_most_ahead_s = 24 * 3600;
constexpr std::chrono::milliseconds k_between_looks{200};

std::string names(const std::vector<std::string>& cells) {
  std::string text;
  for (const std::string& cell : cells) text.append(text.empty() ? "" : ", ").append(cell);
  return text;
}

Result<ExitStatus> offer(const ReleaseOrders& orders, Centre& centre) {
  std::vector<std::string> cells = orders.cells;
  if (cells.empty()) {
    BITELINE_ASSIGN(const std::vector<CellRow> known, centre.cells());
    for (const CellRow& cell : known) cells.push_back(cell.cell);
  }
  for (const std::string& cell : cells) {
    if (!is_cell_name(cell))
      return fail(Errc::InvalidArgument, "--cells '%.70s': letters, digits, - and _ expected", cell.c_str());
  }
  if (cells.empty())
    return fail(Errc::InvalidArgument, "no cell was heard yet: name those that the release is for (--cells)");
  BITELINE_ASSIGN(const std::int64_t number, Releases{centre}.offer(orders.offer, cells));
  std::printf("release %lld is offered to %s\n", static_cast<long long>(number), names(cells).c_str());
  return ExitStatus::Done;
}

Result<ExitStatus> list(Centre& centre, bool json) {
  BITELINE_ASSIGN(const std::vector<ReleaseRow> rows, Releases{centre}.list());
  Json told = Json::array();
  for (const ReleaseRow& row : rows) {
    Json cells = Json::array();
    if (!json)
      std::printf("release %lld: %s, %.16s..., %lld bytes\n", static_cast<long long>(row.number),
                  row.name.c_str(), row.sha256.c_str(), static_cast<long long>(row.bytes));
    for (const ReleaseCell& cell : row.cells) {
      cells.push_back(
          {{"cell", cell.cell}, {"ready", cell.ready}, {"in_force", cell.in_force}, {"why", cell.why}});
      const std::string state = cell.ready ? "ready" : "not ready: " + cell.why;
      if (!json)
        std::printf("  %-20s %s%s\n", cell.cell.c_str(), cell.in_force ? "in force, " : "", state.c_str());
    }
    told.push_back({{"number", row.number},
                    {"name", row.name},
                    {"sha256", row.sha256},
                    {"bytes", row.bytes},
                    {"cells", std::move(cells)}});
  }
  if (json) std::printf("%s\n", Json{{"schema_version", 1}, {"releases", std::move(told)}}.dump(2).c_str());
  return ExitStatus::Done;
}

/// Waits until the running centre has decided.
Result<ExitStatus> switch_to(const ReleaseOrders& orders, Centre& centre) {
  Releases releases{centre};
  BITELINE_ASSIGN(const std::int64_t number, releases.plan_switch(*orders.turn, orders.in_s));
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds{orders.in_s};
  while (!told_to_stop()) {
    BITELINE_ASSIGN(const SwitchRow row, releases.switch_row(number));
    if (row.state == SwitchState::Sure) {
      std::printf("release %lld is in force everywhere from %s on\n", static_cast<long long>(*orders.turn),
                  memory::to_iso(row.at_ms).c_str());
      return ExitStatus::Done;
    }
    const bool nobody = std::chrono::steady_clock::now() > patience;
    if (row.state == SwitchState::Withdrawn || nobody) {
      const std::string who = row.silent.empty() ? "the running centre did not decide it"
                                                 : "nothing heard of " + names(row.silent);
      std::printf("release %lld is not switched, all keep what they have: %s%s\n",
                  static_cast<long long>(*orders.turn), who.c_str(),
                  row.state == SwitchState::Planned ? "; does biteline-fleet run?" : "");
      return ExitStatus::Refused;
    }
    std::this_thread::sleep_for(k_between_looks);
  }
  std::printf("switch %lld goes on without this command; see --releases\n", static_cast<long long>(number));
  return ExitStatus::Done;
}

}  // namespace

void add_release_options(CLI::App& app, ReleaseOrders& orders) {
  auto* offer =
      app.add_option("--offer", orders.offer,
                     "Offer this release (a file of `biteline model release`, its manifest and signature "
                     "beside it) to cells, which fetch and check it, and leave");
  app.add_option("--cells", orders.cells,
                 "With --offer: the cells that it is for; without: all that were heard")
      ->delimiter(',')
      ->needs(offer);
  app.add_flag("--releases", orders.list, "Print the releases and which cell has them, and leave");
  auto* turn =
      app.add_option("--switch", orders.turn,
                     "Put this release (its number) in force in all its cells at one time, and leave; exit "
                     "status 3 where not all could be told, and all keep what they have")
          ->excludes(offer);
  app.add_option(
         "--forget", orders.forget,
         "Remove this release (its number) from the centre, and leave; refused while a cell has it in force")
      ->excludes(offer)
      ->excludes(turn);
  app.add_option("--in", orders.in_s, "With --switch: so many seconds from now")
      ->check(CLI::Range(k_least_ahead_s, k_most_ahead_s))
      ->capture_default_str()
      ->needs(turn);
}

Result<ExitStatus> carry_out(const ReleaseOrders& orders, Centre& centre, bool json) {
  if (!orders.offer.empty()) return offer(orders, centre);
  if (orders.turn) return switch_to(orders, centre);
  if (orders.forget) {
    BITELINE_TRY(Releases{centre}.forget(*orders.forget));
    std::printf("release %lld is forgotten; cells keep what they have\n",
                static_cast<long long>(*orders.forget));
    return ExitStatus::Done;
  }
  return list(centre, json);
}

}  // namespace biteline::fleet
