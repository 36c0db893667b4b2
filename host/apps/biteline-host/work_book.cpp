// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/work_book.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/system/file.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using second_look::FaultKind;
using WorkJson = nlohmann::ordered_json;

constexpr const char* k_work_file = "work.json";

const char* verdict_of(const second_look::Findings& findings, ExitStatus judged) {
  if (judged == ExitStatus::Refused) return "refused";
  if (judged == ExitStatus::Done) return k_work_ok;
  return findings.faults.empty() ? "unsure" : k_faulty;
}

int number_of(const WorkJson& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number_integer() ? found->get<int>() : 0;
}

std::string word_of(const WorkJson& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string{};
}

}  // namespace

memory::Work work_of(const second_look::Findings& findings, ExitStatus judged) {
  memory::Work work{.verdict = verdict_of(findings, judged)};
  if (findings.refusal) return work;
  work.missing_mm = 0;
  for (const second_look::Fault& fault : findings.faults) {
    const double length_mm = fault.along.to_mm - fault.along.from_mm;
    if (fault.kind == FaultKind::Missing)
      *work.missing_mm += length_mm < 0 ? length_mm + findings.line_mm : length_mm;
    work.narrow += fault.kind == FaultKind::Narrow ? 1 : 0;
    work.wide += fault.kind == FaultKind::Wide ? 1 : 0;
    work.beside += fault.kind == FaultKind::Beside ? 1 : 0;
    work.doubled += fault.kind == FaultKind::Doubled ? 1 : 0;
  }
  return work;
}

fs::path look_folder(const fs::path& scan, int number) {
  return scan / k_work_folder / ("look-" + std::to_string(number));
}

Result<void> write_work(const fs::path& scan, const WorkBook& book) {
  const WorkJson json{{"verdict", book.work.verdict},
                      {"looks", book.looks},
                      {"reworked", book.work.reworked},
                      {"missing_mm", api::or_null(book.work.missing_mm)},
                      {"narrow", book.work.narrow},
                      {"wide", book.work.wide},
                      {"beside", book.work.beside},
                      {"doubled", book.work.doubled},
                      {"reason_code", book.told.reason_code},
                      {"reason", book.told.reason},
                      {"next_step", book.told.next_step},
                      {"at_work", book.at_work},
                      {"next", book.next},
                      {"next_scan", book.next_scan}};
  BITELINE_TRY(report::prepare_folder(scan / k_work_folder));
  return report::write_file_atomically(scan / k_work_folder / k_work_file, report::to_text(json) + "\n");
}

Result<std::optional<WorkBook>> read_work(const fs::path& scan) {
  const fs::path file = scan / k_work_folder / k_work_file;
  std::error_code error;
  if (!fs::exists(file, error)) return std::optional<WorkBook>{};
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_settings_bytes));
  const WorkJson json = WorkJson::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("verdict") || !json["verdict"].is_string())
    return fail(Errc::BadFormat, "%.200s: 'verdict' expected", file.c_str());
  WorkBook book{.work = {.verdict = word_of(json, "verdict"),
                         .narrow = number_of(json, "narrow"),
                         .wide = number_of(json, "wide"),
                         .beside = number_of(json, "beside"),
                         .doubled = number_of(json, "doubled")},
                .looks = number_of(json, "looks"),
                .told = {.reason_code = word_of(json, "reason_code"),
                         .reason = word_of(json, "reason"),
                         .next_step = word_of(json, "next_step")},
                .next = word_of(json, "next"),
                .next_scan = word_of(json, "next_scan")};
  if (const auto at_work = json.find("at_work"); at_work != json.end() && at_work->is_boolean())
    book.at_work = at_work->get<bool>();
  if (const auto reworked = json.find("reworked"); reworked != json.end() && reworked->is_boolean())
    book.work.reworked = reworked->get<bool>();
  if (const auto missing = json.find("missing_mm"); missing != json.end() && missing->is_number())
    book.work.missing_mm = missing->get<double>();
  return std::optional{book};
}

void forget_work(const fs::path& scan) {
  std::error_code ignored;  // one that stays is closed when a service starts
  fs::remove_all(scan / k_work_folder, ignored);
}

}  // namespace biteline::service
