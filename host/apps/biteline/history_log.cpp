// SPDX-License-Identifier: MIT
#include "host/apps/biteline/history_log.hpp"

#include <vector>

namespace biteline::app {
namespace {

std::string words_of(const memory::LogVerdict& verdict, std::size_t kept) {
  if (verdict.first_linked == 0)
    return "the log has no chain yet: " + std::to_string(verdict.rows) +
           " rows of a program before; its next row seals them";
  std::string words = "whole: " + std::to_string(verdict.rows) + " rows";
  if (verdict.sealed > 0)
    words += ", of them " + std::to_string(verdict.sealed) + " of before the chain, sealed by row " +
             std::to_string(verdict.first_linked);
  if (kept > 0) words += "; all " + std::to_string(kept) + " kept links stand";
  return words + "\nlast link: row " + std::to_string(verdict.last.row) + " " + verdict.last.link;
}

nlohmann::ordered_json json_of(const memory::LogVerdict& verdict, std::size_t kept) {
  nlohmann::ordered_json json{{"rows", verdict.rows},
                              {"first_linked_row", verdict.first_linked},
                              {"sealed_rows", verdict.sealed},
                              {"last_link", {{"row", verdict.last.row}, {"sha256", verdict.last.link}}},
                              {"kept_links", kept},
                              {"more_faults", verdict.more_faults}};
  auto faults = nlohmann::ordered_json::array();
  for (const memory::LogFault& fault : verdict.faults)
    faults.push_back(
        {{"reason_code", report::refusal_row(fault.code).name}, {"row", fault.row}, {"what", fault.what}});
  json["faults"] = std::move(faults);
  return json;
}

}  // namespace

Result<ExitStatus> verify_log(const memory::Memory& memory, const std::filesystem::path& kept_file,
                              const GlobalOptions& global) {
  std::vector<memory::LogLink> kept;
  if (!kept_file.empty()) {
    BITELINE_ASSIGN(kept, memory::read_kept_links(kept_file));
  }
  BITELINE_ASSIGN(const memory::LogVerdict verdict, memory.verify_log(kept));
  report::Report report;
  report.fields["log"] = json_of(verdict, kept.size());
  std::string words;
  if (verdict.faults.empty()) {
    words = words_of(verdict, kept.size());
    if (!kept_file.empty() && verdict.first_linked > 0)
      BITELINE_TRY(memory::keep_link(kept_file, verdict.last));
  } else {
    const memory::LogFault& first = verdict.faults.front();
    const std::int64_t more = static_cast<std::int64_t>(verdict.faults.size()) - 1 + verdict.more_faults;
    words = first.what;
    if (more > 0) words += " (and " + std::to_string(more) + " more faults)";
    report.refuse(report::Refusal<memory::LogRefused>{.code = first.code, .reason = words});
  }
  // The verdict is the result: --quiet leaves it.
  return tell(report, {.quiet = false, .json = global.json}, words);
}

}  // namespace biteline::app
