// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/release_orders.hpp"

#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>

#include "common/options/command.hpp"
#include "common/system/file.hpp"
#include "host/fleet/program.hpp"
#include "host/fleet/releases.hpp"
#include "host/interfaces/control/messages.hpp"
#include "host/report/report.hpp"

namespace biteline::fleet {
namespace {

using control::Json;

/// A script needs so long from --order to --switch.
constexpr int k_to_sign_s = 5;
constexpr std::chrono::milliseconds k_between_release_looks{200};

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

Result<ExitStatus> list_releases(Centre& centre, bool json) {
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

/// What is to be signed where releases are made.
Result<ExitStatus> write_order(const ReleaseOrders& orders, Centre& centre) {
  BITELINE_ASSIGN(const release::Order order,
                  Releases{centre}.order_of(*orders.order, orders.in_s, orders.after));
  BITELINE_TRY(report::write_file_atomically(orders.out, release::to_text(order)));
  std::printf("%s: release %lld is to be in force in %s from %s on; sign it, then --switch\n",
              orders.out.c_str(), static_cast<long long>(*orders.order), names(order.cells).c_str(),
              memory::to_iso(order.at_ms).c_str());
  return ExitStatus::Done;
}

/// Waits until the running centre has decided.
Result<ExitStatus> switch_by(const ReleaseOrders& orders, Centre& centre) {
  BITELINE_ASSIGN(const std::string order, read_regular_file(orders.turn, release::k_most_order_bytes));
  BITELINE_ASSIGN(
      const std::string signature,
      read_regular_file(orders.turn.string() + release::k_order_signature_suffix, k_most_settings_bytes));
  Releases releases{centre};
  BITELINE_ASSIGN(const std::int64_t number, releases.plan_switch(order, signature, orders.after));
  while (!told_to_stop()) {
    BITELINE_ASSIGN(const SwitchRow row, releases.switch_row(number));
    if (row.state == SwitchState::Sure) {
      std::printf("switch %lld is sure: its release is in force everywhere from %s on\n",
                  static_cast<long long>(number), memory::to_iso(row.at_ms).c_str());
      return ExitStatus::Done;
    }
    const bool nobody = memory::now_ms() > row.at_ms;
    if (row.state == SwitchState::Withdrawn || nobody) {
      const std::string silent = names(row.silent);
      const std::string who =
          silent.empty() ? "the running centre did not decide it" : "no word that it is known from " + silent;
      std::printf("switch %lld is not made, all keep what they have: %s%s\n", static_cast<long long>(number),
                  who.c_str(), row.state == SwitchState::Planned ? "; does biteline-fleet run?" : "");
      return ExitStatus::Refused;
    }
    std::this_thread::sleep_for(k_between_release_looks);
  }
  std::printf("switch %lld goes on without this command; see --releases\n", static_cast<long long>(number));
  return ExitStatus::Done;
}

}  // namespace

void add_release_options(options::Command& app, ReleaseOrders& orders) {
  auto* offer =
      app.add_option("--offer", orders.offer,
                     "Offer this release (a file of `biteline model release`, its manifest and signature "
                     "beside it) to cells, which fetch and check it, and leave");
  app.add_option("--cells", orders.cells,
                 "With --offer: the cells that it is for; without: all that were heard")
      ->delimiter(',')
      ->needs(offer);
  app.add_flag("--releases", orders.list, "Print the releases and which cell has them, and leave");
  auto* order =
      app.add_option("--order", orders.order,
                     "Write the order of a switch to this release (its number) in all its cells at one "
                     "time, to be signed, and leave")
          ->excludes(offer);
  auto* out = app.add_option("--out", orders.out, "With --order: its file")->needs(order);
  order->needs(out);
  auto* turn =
      app.add_option("--switch", orders.turn,
                     "Carry out this signed order (its signature beside it, FILE.sig), and leave; exit "
                     "status 3 where not all could be told, and all keep what they have")
          ->excludes(offer)
          ->excludes(order);
  app.add_option(
         "--forget", orders.forget,
         "Remove this release (its number) from the centre, and leave; refused while a cell has it in force")
      ->excludes(offer)
      ->excludes(order)
      ->excludes(turn);
  app.add_option("--in", orders.in_s, "With --order: so many seconds from now")
      ->check(options::whole_number(k_least_ahead_s + k_to_sign_s, k_most_ahead_s))
      ->capture_default_str()
      ->needs(order);
  app.add_option("--after", orders.after,
                 "With --order and --switch: the newest switch that its cells know, where they say that they "
                 "know one that this database, put back from long ago, does not")
      ->check(options::whole_number(std::int64_t{0}, std::int64_t{std::numeric_limits<std::int32_t>::max()}));
}

Result<ExitStatus> carry_out(const ReleaseOrders& orders, Centre& centre, bool json) {
  if (!orders.offer.empty()) return offer(orders, centre);
  if (orders.order) return write_order(orders, centre);
  if (!orders.turn.empty()) return switch_by(orders, centre);
  if (orders.forget) {
    BITELINE_TRY(Releases{centre}.forget(*orders.forget));
    std::printf("release %lld is forgotten; cells keep what they have\n",
                static_cast<long long>(*orders.forget));
    return ExitStatus::Done;
  }
  return list_releases(centre, json);
}

}  // namespace biteline::fleet
