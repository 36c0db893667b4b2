// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/part.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/system/file.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/interfaces/line_control/part_number.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* k_part = "scan.part";

Json text_or_null(const std::string& text) {
  return text.empty() ? Json{} : Json(text);
}

}  // namespace

Result<void> mark_part(const fs::path& folder, const std::string& part) {
  return report::write_file_atomically(folder / k_part, part + "\n");
}

std::string marked_part(const fs::path& folder) {
  const Result<std::string> text = read_regular_file(folder / k_part, line_control::k_most_part_bytes + 1);
  return text ? line_control::part_number(text->substr(0, text->find('\n'))).value_or("") : std::string{};
}

Result<void> tell_shoe(const fs::path& folder, const ShoeWords& shoe) {
  const Result<std::string> text = read_regular_file(folder / "report.json", k_most_settings_bytes);
  Json report = text ? Json::parse(*text, nullptr, false) : Json{};
  if (!report.is_object()) return {};
  report["part"] = text_or_null(shoe.part);
  report["foot"] = text_or_null(shoe.foot);
  report["size"] = text_or_null(shoe.size);
  return report::write_file_atomically(folder / "report.json", report::to_text(report) + "\n");
}

std::string worked_before(const memory::Memory& memory, const std::string& scan, const std::string& part) {
  if (part.empty()) return {};
  const Result<std::optional<memory::Scan>> before = memory.sent_before(part, scan);
  if (!before) return "nobody knows whether part " + part + " was worked before: " + to_line(before.error());
  if (!*before) return {};
  const char* how_far =
      (*before)->followed.value_or(false) ? "already" : "already, but not to the line's end";
  return "part " + part + " was worked " + how_far + ": " + (*before)->name + ", " +
         memory::to_iso((*before)->time);
}

bool is_used_up(const memory::Memory& memory, const std::string& part, memory::UnixMs said) {
  memory::ScanFilter filter;
  filter.from = said;
  filter.part = part;
  const Result<memory::ScanPage> page = memory.scans(filter);
  // A part number that ends with * is a wider filter.
  return page &&
         std::ranges::any_of(page->scans, [&](const memory::Scan& scan) { return scan.part == part; });
}

}  // namespace biteline::service
