// SPDX-License-Identifier: MIT
// The centre's side of a switch: ordered, signed elsewhere, planned, sure or withdrawn.
#include <algorithm>

#include "host/fleet/centre_state.hpp"
#include "host/fleet/release_cells.hpp"
#include "host/records/release/manifest.hpp"

namespace biteline::fleet {
namespace {

std::vector<std::string> silent_cells(pqxx::work& work, std::int64_t number) {
  std::vector<std::string> cells;
  for (const pqxx::row& row : work.exec_params(
           "SELECT sc.cell, coalesce(cr.fault, '') FROM switch_cells sc LEFT JOIN cell_releases cr "
           "ON cr.cell = sc.cell WHERE sc.switch = $1 AND (coalesce(cr.switch, 0) <> sc.switch OR "
           "cr.refused = sc.switch) "
           "ORDER BY sc.cell",
           number)) {
    const auto fault = row[1].as<std::string>();
    cells.push_back(row[0].as<std::string>() + (fault.empty() ? "" : " (" + fault + ")"));
  }
  return cells;
}

/// `after`: as a person has it.
std::int64_t newest_known(pqxx::work& work, std::int64_t after) {
  // A database that was put back to an older state knows less than the cells; but no cell's word ends all
  // orders.
  return work
      .exec_params1(
          "WITH own AS (SELECT greatest((SELECT max(number) FROM switches), $1) AS number) SELECT "
          "greatest(own.number, (SELECT max(greatest(switch, newest)) FROM cell_releases WHERE "
          "greatest(switch, newest) <= own.number + $2::bigint)) FROM own",
          after, k_most_step)[0]
      .as<std::int64_t>();
}

Result<void> check_number(pqxx::work& work, std::int64_t number, std::int64_t after) {
  const std::int64_t newest = newest_known(work, after);
  if (number > newest && number <= newest + k_most_step) return {};
  return fail(Errc::WrongState, "order of switch %lld: %lld is known already%s; write and sign a new one",
              static_cast<long long>(number), static_cast<long long>(newest),
              number > newest ? ", so many cannot have been between" : "");
}

/// One of its cells says that it does not follow it.
bool is_refused(pqxx::work& work, std::int64_t number) {
  return !work.exec_params(
                  "SELECT 1 FROM switch_cells sc JOIN cell_releases cr ON cr.cell = sc.cell WHERE sc.switch "
                  "= "
                  "$1 AND cr.refused = $1 LIMIT 1",
                  number)
              .empty();
}

/// Whatever stands in the way of a switch at this time.
Result<void> check_open_switches(pqxx::work& work, const std::string& order_cells, std::int64_t at_ms) {
  if (const pqxx::result open = work.exec("SELECT number FROM switches WHERE state = 'planned'");
      !open.empty())
    return fail(Errc::WrongState, "switch %s is planned and not decided yet; wait for it",
                open[0][0].c_str());
  if (const pqxx::result sure =
          work.exec("SELECT number FROM switches WHERE state = 'sure' AND at > now() LIMIT 1");
      !sure.empty())
    return fail(Errc::WrongState, "switch %s is sure and still to come; wait for it", sure[0][0].c_str());
  // It knows its last switch, but not that it is sure: with a newer number it would never take it.
  if (const pqxx::result behind =
          work.exec_params("SELECT cr.cell, s.number FROM cell_releases cr JOIN switches s ON s.number = "
                           "(SELECT max(l.number) FROM "
                           "switches l JOIN switch_cells lc ON lc.switch = l.number WHERE lc.cell = cr.cell "
                           "AND l.state = 'sure') "
                           "JOIN releases r ON r.number = s.release WHERE cr.cell = ANY (string_to_array($1, "
                           "' ')) AND cr.switch = "
                           "s.number AND cr.current <> r.sha256 ORDER BY cr.cell LIMIT 1",
                           order_cells);
      !behind.empty())
    return fail(Errc::WrongState, "%s has not come to switch %s yet; wait for it", behind[0][0].c_str(),
                behind[0][1].c_str());
  const auto ahead_ms = work.exec_params1("SELECT $1 - (extract(epoch FROM now()) * 1000)::bigint", at_ms)[0]
                            .as<std::int64_t>();
  if (ahead_ms >= std::int64_t{1000} * k_least_ahead_s && ahead_ms <= std::int64_t{1000} * k_most_ahead_s)
    return {};
  return fail(Errc::WrongState,
              "the order's time is %lld s from now, %d to %d expected: write and sign a new one",
              static_cast<long long>(ahead_ms / 1000), k_least_ahead_s, k_most_ahead_s);
}

/// The order is for just the cells that the release is for, and each of them is ready.
Result<void> check_cells(pqxx::work& work, std::int64_t release, const release::Order& order) {
  std::string missing;
  std::vector<std::string> names;
  for (const ReleaseCell& cell : cells_of(work, release, order.sha256)) {
    names.push_back(cell.cell);
    if (!cell.ready) missing.append(missing.empty() ? "" : "; ").append(cell.cell + ": " + cell.why);
  }
  std::vector<std::string> ordered = order.cells;
  std::ranges::sort(ordered);
  std::ranges::sort(names);
  if (names != ordered) missing = "it is for other cells than the order; write and sign a new one";
  if (missing.empty()) return {};
  return fail(Errc::WrongState, "release %lld is not switched: %.400s", static_cast<long long>(release),
              missing.c_str());
}

}  // namespace

Result<release::Order> Releases::order_of(std::int64_t release, int in_s, std::int64_t after) {
  return centre_.work<release::Order>([&](Centre::State& state) -> Result<release::Order> {
    pqxx::work work{state.connection};
    const pqxx::result found = work.exec_params(
        "SELECT sha256, (extract(epoch FROM now() + make_interval(secs => $2)) * 1000)::bigint FROM releases "
        "WHERE "
        "number = $1",
        release, in_s);
    if (found.empty())
      return fail(Errc::InvalidArgument, "release %lld: there is none; see --releases",
                  static_cast<long long>(release));
    release::Order order{.number = newest_known(work, after) + 1,
                         .sha256 = found[0][0].as<std::string>(),
                         .at_ms = found[0][1].as<std::int64_t>(),
                         .cells = {}};
    for (const ReleaseCell& cell : cells_of(work, release, order.sha256)) order.cells.push_back(cell.cell);
    if (order.cells.empty())
      return fail(Errc::WrongState, "release %lld is for no cell", static_cast<long long>(release));
    // As it will be read.
    BITELINE_TRY(release::read_order(release::to_text(order)));
    return order;
  });
}

Result<std::int64_t> Releases::plan_switch(const std::string& order_text, const std::string& signature,
                                           std::int64_t after) {
  BITELINE_ASSIGN(const release::Order order, release::read_order(order_text));
  if (signature.size() != release::k_signature_bytes)
    return fail(Errc::BadFormat, "order of switch %lld: an ed25519 signature of %zu bytes expected",
                static_cast<long long>(order.number), release::k_signature_bytes);
  return centre_.work<std::int64_t>([&](Centre::State& state) -> Result<std::int64_t> {
    pqxx::work work{state.connection};
    work.exec(k_release_lock);
    const pqxx::result found =
        work.exec_params("SELECT number FROM releases WHERE sha256 = $1", order.sha256);
    if (found.empty())
      return fail(Errc::InvalidArgument,
                  "order of switch %lld: its release %.16s is not here; see --releases",
                  static_cast<long long>(order.number), order.sha256.c_str());
    const auto release = found[0][0].as<std::int64_t>();
    BITELINE_TRY(check_cells(work, release, order));
    std::string cells;
    for (const std::string& cell : order.cells) cells.append(cells.empty() ? "" : " ").append(cell);
    BITELINE_TRY(check_open_switches(work, cells, order.at_ms));
    BITELINE_TRY(check_number(work, order.number, after));
    work.exec_params0(
        "INSERT INTO switches (number, release, at, state, order_text, order_signature) VALUES ($1, $2, "
        "to_timestamp($3::bigint / 1000.0), 'planned', $4, $5)",
        order.number, release, order.at_ms, order_text,
        pqxx::binarystring{signature.data(), signature.size()});
    // Kept with the switch: an offer to other cells takes nothing back.
    for (const std::string& cell : order.cells)
      work.exec_params0("INSERT INTO switch_cells (switch, cell) VALUES ($1, $2)", order.number, cell);
    work.commit();
    return order.number;
  });
}

Result<SwitchRow> Releases::switch_row(std::int64_t number) {
  return centre_.work<SwitchRow>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    const pqxx::row row = work.exec_params1(
        "SELECT state, (extract(epoch FROM at) * 1000)::bigint, words FROM switches WHERE number = $1",
        number);
    const auto word = row[0].as<std::string>();
    SwitchRow told{.at_ms = row[1].as<std::int64_t>(), .silent = silent_cells(work, number)};
    if (word == "sure") told.state = SwitchState::Sure;
    // By now no cell knows it any more.
    if (word == "withdrawn")
      told = {.state = SwitchState::Withdrawn, .at_ms = told.at_ms, .silent = {row[2].as<std::string>()}};
    return told;
  });
}

Result<std::vector<std::string>> Releases::decide() {
  return centre_.work<std::vector<std::string>>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    std::vector<std::string> tell;
    const pqxx::result planned = work.exec_params(
        "SELECT number, now() >= at - make_interval(secs => $1) FROM switches WHERE state = 'planned' FOR "
        "UPDATE",
        k_decided_before_s);
    for (const pqxx::row& row : planned) {
      const auto number = row[0].as<std::int64_t>();
      const std::vector<std::string> silent = silent_cells(work, number);
      const bool withdrawn = row[1].as<bool>() || is_refused(work, number);
      std::string words;
      for (const std::string& cell : silent) words.append(words.empty() ? "" : ", ").append(cell);
      if (withdrawn || silent.empty())
        work.exec_params0("UPDATE switches SET state = $2, words = $3 WHERE number = $1", number,
                          withdrawn ? "withdrawn" : "sure", words);
      for (const pqxx::row& cell :
           work.exec_params("SELECT cell FROM switch_cells WHERE switch = $1", number))
        tell.push_back(cell[0].as<std::string>());
    }
    work.commit();
    return tell;
  });
}

}  // namespace biteline::fleet
