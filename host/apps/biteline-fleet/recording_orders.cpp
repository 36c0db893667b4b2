// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/recording_orders.hpp"

#include <chrono>
#include <cstdio>
#include <thread>

#include "common/options/command.hpp"
#include "host/fleet/program.hpp"
#include "host/fleet/recording_messages.hpp"
#include "host/fleet/recordings.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::fleet {
namespace {

using control::Json;

constexpr std::chrono::milliseconds k_between_fetch_looks{200};

std::string where(const FetchRow& row) {
  if (row.state == FetchState::Whole || row.state == FetchState::Refused || row.state == FetchState::Removed)
    return std::string{to_text(row.state)} +
           (row.marked && row.state == FetchState::Whole ? ", marked: " : ": ") + row.words;
  if (row.total > 0)
    return std::to_string(row.have) + " of " + std::to_string(row.total) + " bytes" +
           (row.online ? "" : ", its cell is away");
  return row.online ? "asked for; the cell sends it when it rests" : "asked for; its cell is away";
}

struct ScanOfCell {
  std::string cell, scan;
};
Result<ScanOfCell> scan_of(const char* option, const std::string& text) {
  const std::size_t slash = text.find('/');
  ScanOfCell named{.cell = text.substr(0, slash),
                   .scan = slash == std::string::npos ? "" : text.substr(slash + 1)};
  if (is_cell_name(named.cell) && is_scan_folder(named.scan)) return named;
  return fail(Errc::InvalidArgument, "%s '%.140s': CELL/SCAN expected, e.g. cell-1/scan-0007", option,
              text.c_str());
}

Result<ExitStatus> mark(const RecordingOrders& orders, Centre& centre) {
  const bool marked = !orders.mark.empty();
  const std::string& text = marked ? orders.mark : orders.unmark;
  BITELINE_ASSIGN(const ScanOfCell named, scan_of(marked ? "--mark" : "--unmark", text));
  BITELINE_TRY(Recordings{centre}.mark(named.cell, named.scan, marked));
  std::printf("%s %s\n", text.c_str(), marked ? "is marked: it stays" : "is marked no more");
  return ExitStatus::Done;
}

/// Waits until the running centre has it or knows why not.
Result<ExitStatus> fetch(const RecordingOrders& orders, Centre& centre) {
  BITELINE_ASSIGN(const ScanOfCell named, scan_of("--fetch", orders.fetch));
  Recordings recordings{centre};
  BITELINE_ASSIGN(const std::int64_t number, recordings.ask(named.cell, named.scan));
  std::string told;
  while (!told_to_stop()) {
    BITELINE_ASSIGN(const FetchRow row, recordings.row(number));
    if (const std::string words = where(row); words != told) {
      told = words;
      std::printf("fetch %lld, %s: %s\n", static_cast<long long>(number), orders.fetch.c_str(),
                  words.c_str());
      std::fflush(stdout);
    }
    // Removed: it was whole for a moment.
    if (row.state == FetchState::Whole || row.state == FetchState::Removed) return ExitStatus::Done;
    if (row.state == FetchState::Refused) return ExitStatus::Refused;
    std::this_thread::sleep_for(k_between_fetch_looks);
  }
  std::printf("fetch %lld goes on without this command; see --fetches\n", static_cast<long long>(number));
  return ExitStatus::Done;
}

Result<ExitStatus> list_fetches(Centre& centre, bool json) {
  BITELINE_ASSIGN(const std::vector<FetchRow> rows, Recordings{centre}.list());
  Json told = Json::array();
  for (const FetchRow& row : rows) {
    told.push_back({{"number", row.number},
                    {"cell", row.cell},
                    {"scan", row.scan},
                    {"state", to_text(row.state)},
                    {"have", row.have},
                    {"total", row.total},
                    {"marked", row.marked},
                    {"words", row.words}});
    if (!json)
      std::printf("fetch %lld, %s/%s: %s\n", static_cast<long long>(row.number), row.cell.c_str(),
                  row.scan.c_str(), where(row).c_str());
  }
  if (json) std::printf("%s\n", Json{{"schema_version", 1}, {"fetches", std::move(told)}}.dump(2).c_str());
  return ExitStatus::Done;
}

}  // namespace

void add_recording_options(options::Command& app, RecordingOrders& orders) {
  app.add_option("--fetch", orders.fetch,
                 "CELL/SCAN: fetch the folder of this scan from its cell, as one tar file into the running "
                 "centre's --recordings, and leave when it is there; exit status 3 where it cannot be had");
  app.add_option(
      "--mark", orders.mark,
      "CELL/SCAN: keep this recording at the centre, whatever --keep-days and --keep-gb say, and leave");
  app.add_option("--unmark", orders.unmark, "CELL/SCAN: let it go again, and leave");
  app.add_flag("--fetches", orders.list,
               "Print what was asked for with --fetch and where it stands, and leave");
}

Result<ExitStatus> carry_out(const RecordingOrders& orders, Centre& centre, bool json) {
  if (orders.list) return list_fetches(centre, json);
  if (!orders.mark.empty() || !orders.unmark.empty()) return mark(orders, centre);
  return fetch(orders, centre);
}

}  // namespace biteline::fleet
