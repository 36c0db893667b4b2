// SPDX-License-Identifier: MIT
#include "host/fleet/releases.hpp"

#include <algorithm>

#include "common/system/file.hpp"
#include "host/fleet/centre_state.hpp"
#include "host/fleet/release_cells.hpp"
#include "host/records/release/manifest.hpp"

namespace biteline::fleet {
namespace {

namespace fs = std::filesystem;

/// A cell says something each 5 s.
constexpr int k_heard_within_s = 15;
constexpr std::int64_t k_most_clock_off_ms = 2000;
pqxx::binarystring blob(std::string_view bytes) {
  return {bytes.data(), bytes.size()};
}

std::string text_from(const pqxx::field& field) {
  return pqxx::binarystring{field}.str();
}

/// Hashes alone: nothing in them needs escaping.
std::string array_of(const std::vector<std::string>& hashes) {
  std::string text{"{"};
  for (const std::string& hash : hashes) text.append(text.size() > 1 ? "," : "").append(hash);
  return text + "}";
}

constexpr const char* k_cells_of = R"sql(
SELECT rc.cell, coalesce(c.online AND cr.heard > now() - make_interval(secs => $2), false),
  coalesce($3 = ANY (cr.has), false), coalesce(cr.current = $3, false), coalesce(cr.fault, ''),
  coalesce(cr.clock_off_ms, 0)
FROM release_cells rc LEFT JOIN cells c ON c.cell = rc.cell LEFT JOIN cell_releases cr ON cr.cell = rc.cell
WHERE rc.release = $1 ORDER BY rc.cell
)sql";

}  // namespace

std::vector<ReleaseCell> cells_of(pqxx::work& work, std::int64_t release, const std::string& sha256) {
  std::vector<ReleaseCell> cells;
  for (const pqxx::row& row : work.exec_params(k_cells_of, release, k_heard_within_s, sha256)) {
    ReleaseCell cell{.cell = row[0].as<std::string>(), .in_force = row[3].as<bool>(), .why = {}};
    const auto fault = row[4].as<std::string>();
    const auto off_ms = row[5].as<std::int64_t>();
    if (!row[1].as<bool>()) {
      cell.why = "it is away";
    } else if (!row[2].as<bool>()) {
      cell.why = fault.empty() ? "it has not fetched it yet" : fault;
    } else if (std::abs(off_ms) > k_most_clock_off_ms) {
      cell.why = "its clock is off by " + std::to_string(off_ms) + " ms";
    }
    cell.ready = cell.why.empty();
    cells.push_back(std::move(cell));
  }
  return cells;
}

Result<std::int64_t> Releases::offer(const fs::path& file, const std::vector<std::string>& cells) {
  BITELINE_ASSIGN(const std::string manifest_text,
                  read_regular_file(file.string() + release::k_manifest_suffix, k_most_settings_bytes));
  BITELINE_ASSIGN(const std::string signature,
                  read_regular_file(file.string() + release::k_signature_suffix, k_most_settings_bytes));
  BITELINE_ASSIGN(const release::Manifest manifest, release::read_manifest(manifest_text));
  if (signature.size() != release::k_signature_bytes)
    return fail(Errc::BadFormat, "%.150s%s: an ed25519 signature of %zu bytes expected", file.c_str(),
                release::k_signature_suffix, release::k_signature_bytes);
  BITELINE_TRY(release::check_file(file, manifest));
  BITELINE_ASSIGN(const std::string bytes, read_regular_file(file, release::k_most_bytes));
  return centre_.work<std::int64_t>([&](Centre::State& state) -> Result<std::int64_t> {
    pqxx::work work{state.connection};
    const auto number =
        work.exec_params1(
                "INSERT INTO releases (sha256, name, manifest, signature, bytes) VALUES ($1, $2, $3, $4, "
                "$5) ON CONFLICT (sha256) DO UPDATE SET offered = now(), name = $2, manifest = $3, signature "
                "= $4 RETURNING number",
                manifest.sha256, manifest.name, manifest_text, blob(signature),
                static_cast<std::int64_t>(manifest.bytes))[0]
            .as<std::int64_t>();
    work.exec_params0("DELETE FROM release_parts WHERE release = $1", number);
    for (std::size_t at = 0; at < bytes.size(); at += k_part_bytes)
      work.exec_params0("INSERT INTO release_parts (release, at, bytes) VALUES ($1, $2, $3)", number,
                        static_cast<std::int64_t>(at),
                        blob(std::string_view{bytes}.substr(at, k_part_bytes)));
    work.exec_params0("DELETE FROM release_cells WHERE release = $1", number);
    for (const std::string& cell : cells)
      work.exec_params0("INSERT INTO release_cells (release, cell) VALUES ($1, $2) ON CONFLICT DO NOTHING",
                        number, cell);
    work.commit();
    return number;
  });
}

Result<void> Releases::forget(std::int64_t release) {
  const Result<bool> forgotten = centre_.work<bool>([&](Centre::State& state) -> Result<bool> {
    pqxx::work work{state.connection};
    work.exec(k_release_lock);
    const pqxx::result found = work.exec_params("SELECT sha256 FROM releases WHERE number = $1", release);
    if (found.empty())
      return fail(Errc::InvalidArgument, "release %lld: there is none; see --releases",
                  static_cast<long long>(release));
    // What a cell said last counts, also of one that is away or no longer among its cells.
    std::string cells;
    for (const pqxx::row& row :
         work.exec_params("SELECT cell FROM cell_releases WHERE current = $1 ORDER BY cell",
                          found[0][0].as<std::string>()))
      cells.append(cells.empty() ? "" : ", ").append(row[0].as<std::string>());
    if (!cells.empty())
      return fail(Errc::WrongState, "release %lld is in force in %.300s; switch to another one first",
                  static_cast<long long>(release), cells.c_str());
    // The newest sure one of any of its cells: what plan_of() tells that cell, which may still wait for it.
    const pqxx::result open = work.exec_params(
        "SELECT s.number FROM switches s WHERE s.release = $1 AND (s.state = 'planned' OR (s.state = 'sure' "
        "AND EXISTS (SELECT 1 FROM switch_cells c WHERE c.switch = s.number AND NOT EXISTS (SELECT 1 FROM "
        "switches later JOIN switch_cells lc ON lc.switch = later.number AND lc.cell = c.cell WHERE "
        "later.state = 'sure' AND later.number > s.number))))",
        release);
    if (!open.empty())
      return fail(Errc::WrongState,
                  "release %lld: switch %s brings it into force; switch to another one first",
                  static_cast<long long>(release), open[0][0].c_str());
    work.exec_params0("DELETE FROM switches WHERE release = $1", release);
    work.exec_params0("DELETE FROM releases WHERE number = $1", release);
    work.commit();
    return true;
  });
  if (!forgotten) return tl::unexpected<Error>{forgotten.error()};
  return {};
}

Result<std::vector<ReleaseRow>> Releases::list() {
  return centre_.work<std::vector<ReleaseRow>>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    std::vector<ReleaseRow> rows;
    for (const pqxx::row& row :
         work.exec("SELECT number, name, sha256, bytes FROM releases ORDER BY offered DESC, number DESC"))
      rows.push_back({.number = row[0].as<std::int64_t>(),
                      .name = row[1].as<std::string>(),
                      .sha256 = row[2].as<std::string>(),
                      .bytes = row[3].as<std::int64_t>(),
                      .cells = {}});
    for (ReleaseRow& row : rows) row.cells = cells_of(work, row.number, row.sha256);
    return rows;
  });
}

Result<void> Releases::note(const std::string& cell, const ReleaseWord& word) {
  const Result<bool> noted = centre_.work<bool>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    work.exec_params0(
        "INSERT INTO cell_releases (cell, has, current, switch, fault, clock_off_ms, heard, newest, refused) "
        "VALUES ($1, $2::text[], $3, $4, $5, $6 - (extract(epoch FROM clock_timestamp()) * 1000)::bigint, "
        "now(), $7, $8) ON CONFLICT (cell) DO UPDATE SET newest = excluded.newest, refused = "
        "excluded.refused, "
        "has = excluded.has, current = excluded.current, switch = excluded.switch, fault = excluded.fault, "
        "clock_off_ms = excluded.clock_off_ms, heard = excluded.heard",
        cell, array_of(word.has), word.current, word.number, text_of(word.fault), word.clock_ms, word.newest,
        word.refused);
    work.commit();
    return true;
  });
  if (!noted) return tl::unexpected<Error>{noted.error()};
  return {};
}

Result<ReleasePlan> Releases::plan_of(const std::string& cell) {
  return centre_.work<ReleasePlan>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    ReleasePlan plan;
    const pqxx::result turn = work.exec_params(
        "SELECT r.sha256, s.order_text, s.order_signature, s.state = 'sure' FROM switches s JOIN releases r "
        "ON "
        "r.number = s.release JOIN switch_cells sc ON sc.switch = s.number AND sc.cell = $1 WHERE s.state <> "
        "'withdrawn' ORDER BY s.number DESC LIMIT 1",
        cell);
    std::string first;
    if (!turn.empty()) {
      first = turn[0][0].as<std::string>();
      if (auto order = turn[0][1].as<std::string>(); !order.empty())
        plan.turn = ReleasePlan::Switch{
            .order = std::move(order), .signature = text_from(turn[0][2]), .sure = turn[0][3].as<bool>()};
    }
    // What is in force comes before what is new.
    const pqxx::result wanted = work.exec_params(
        "SELECT manifest, signature FROM releases r LEFT JOIN cell_releases cr ON cr.cell = $1 WHERE "
        "r.sha256 = $2 OR EXISTS (SELECT 1 FROM release_cells rc WHERE rc.release = r.number AND rc.cell = "
        "$1) "
        "ORDER BY (r.sha256 = $2 AND NOT coalesce(r.sha256 = ANY (cr.has), false)) DESC, offered DESC, "
        "r.number DESC "
        "LIMIT 1",
        cell, first);
    if (!wanted.empty()) {
      plan.manifest = wanted[0][0].as<std::string>();
      plan.signature = text_from(wanted[0][1]);
    }
    return plan;
  });
}

Result<std::vector<Part>> Releases::parts(const PartAsk& ask) {
  return centre_.work<std::vector<Part>>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    std::vector<Part> parts;
    for (const pqxx::row& row :
         work.exec_params("SELECT p.at, p.bytes FROM release_parts p JOIN releases r ON r.number = p.release "
                          "WHERE r.sha256 = $1 AND p.at >= $2 ORDER BY p.at LIMIT $3",
                          ask.sha256, ask.at, k_parts_at_once))
      parts.push_back({.sha256 = ask.sha256, .at = row[0].as<std::int64_t>(), .bytes = text_from(row[1])});
    return parts;
  });
}

}  // namespace biteline::fleet
