// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/tables.hpp"

#include <cstdio>

#include "host/fleet/overview.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::fleet {

Result<ExitStatus> tell_cells(Centre& centre, bool as_json) {
  BITELINE_ASSIGN(const std::vector<CellRow> cells, centre.cells());
  control::Json json = control::Json::array();
  if (!as_json)
    std::printf("%-20s %-8s %-24s %8s %8s %8s %8s %8s %8s %8s\n", "cell", "state", "heard", "waiting",
                "shoes", "ok", "amber", "review", "refused", "failed");
  for (const CellRow& cell : cells) {
    if (as_json) {
      json.push_back({{"cell", cell.cell},
                      {"online", cell.online},
                      {"heard", memory::to_iso(cell.heard_ms)},
                      {"version", cell.version},
                      {"waiting", cell.waiting},
                      {"shoes", cell.shoes},
                      {"ok", cell.ok},
                      {"amber", cell.amber},
                      {"review", cell.review},
                      {"refused", cell.refused},
                      {"failed", cell.failed},
                      {"last_shoe", cell.last_shoe_ms ? control::Json(memory::to_iso(*cell.last_shoe_ms))
                                                      : control::Json{}}});
      continue;
    }
    std::printf("%-20s %-8s %-24s %8lld %8lld %8lld %8lld %8lld %8lld %8lld\n", cell.cell.c_str(),
                cell.online ? "online" : "away", memory::to_iso(cell.heard_ms).c_str(),
                static_cast<long long>(cell.waiting), static_cast<long long>(cell.shoes),
                static_cast<long long>(cell.ok), static_cast<long long>(cell.amber),
                static_cast<long long>(cell.review), static_cast<long long>(cell.refused),
                static_cast<long long>(cell.failed));
  }
  if (as_json)
    std::printf("%s\n", control::Json{{"schema_version", 1}, {"cells", std::move(json)}}.dump(2).c_str());
  return ExitStatus::Done;
}

Result<ExitStatus> tell_odd_cells(Centre& centre, bool as_json) {
  BITELINE_ASSIGN(const std::vector<OddOfModel> all, odd_of_all(centre));
  control::Json json = control::Json::array();
  for (const auto& [model, odd] : all) {
    json.push_back({{"model", model},
                    {"cell", odd.cell},
                    {"difference", to_text(odd.difference)},
                    {"mm", odd.mm},
                    {"u95_mm", odd.u95_mm},
                    {"shoes", odd.shoes},
                    {"since", odd.since}});
    if (!as_json)
      std::printf("%s, %s: %s by %.3f mm (U95 %.3f mm) in %d shoes since %s\n", odd.cell.c_str(),
                  model.c_str(), to_text(odd.difference), odd.mm, odd.u95_mm, odd.shoes, odd.since.c_str());
  }
  const bool none = json.empty();
  if (as_json) {
    std::printf("%s\n", control::Json{{"schema_version", 1}, {"odd", std::move(json)}}.dump(2).c_str());
  } else if (none) {
    std::printf("no cell differs from the others\n");
  }
  return none ? ExitStatus::Done : ExitStatus::Refused;
}

Result<ExitStatus> tell_log_links(Centre& centre, const std::string& cell) {
  BITELINE_ASSIGN(const std::vector<ToldLink> links, centre.log_links(cell));
  if (links.empty())
    return fail(Errc::FileNotFound, "%.64s: no link of its log was told; --list names the cells",
                cell.c_str());
  for (const ToldLink& told : links)
    std::printf("%lld %s %s %s\n", static_cast<long long>(told.link.row), told.link.link.c_str(),
                memory::to_iso(told.told_ms).c_str(), told.book.c_str());
  return ExitStatus::Done;
}

}  // namespace biteline::fleet
