// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/scan_row.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/system/file.hpp"
#include "host/apps/biteline-host/part.hpp"
#include "host/apps/biteline-host/work_book.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/interfaces/api/json_fields.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json read_json(const fs::path& file) {
  const Result<std::string> text = read_regular_file(file, k_most_settings_bytes);
  if (!text) return {};
  Json json = Json::parse(*text, nullptr, false);
  return json.is_object() ? json : Json{};
}

std::string text_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string{};
}

std::optional<double> number_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

memory::UnixMs time_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return memory::now_ms();
  return memory::UnixMs{status.st_mtim.tv_sec} * 1000 + status.st_mtim.tv_nsec / 1'000'000;
}

void take_refusal(const Json& report, memory::Scan& scan, const char* verdict = "refused") {
  scan.verdict = verdict;
  scan.reason_code = text_of(report, "reason_code");
  scan.reason = text_of(report, "reason");
  scan.next_step = text_of(report, "next_step");
}

/// Whose yes a path was sent by: a person's, at a door or at the start, or nobody's.
void take_word(const Json& inputs, memory::Scan& scan) {
  const auto part = [&](const char* key) {
    const Json found = inputs.value(key, Json{});
    return found.is_object() ? found : Json::object();
  };
  const std::string approved = text_of(part("result"), "approved_by");
  const Json word = part("scan").value("confirmed", Json{});
  if (word.is_object()) scan.decided_by = text_of(word, "by");
  if (scan.decided_by.empty() && !approved.starts_with(k_automatic))
    scan.decided_by = approved.substr(0, approved.find(", "));
  scan.decision = scan.decided_by.empty() ? k_automatic : "accepted";
}

/// What the gate said no to first; nothing: it let the path through.
std::optional<report::ToldRefusal> gate_refusal(const Json& gate) {
  const auto rows = gate.find("rows");
  if (rows == gate.end() || !rows->is_array()) return std::nullopt;
  for (const Json& row : *rows) {
    if (!row.is_object() || text_of(row, "state") != "failed") continue;
    return report::ToldRefusal{.reason_code = text_of(row, "reason_code"),
                               .reason = "not sent: " + text_of(row, "name") + ": " + text_of(row, "value") +
                                         " (" + text_of(row, "limit") + ")",
                               .next_step = text_of(row, "next_step")};
  }
  return std::nullopt;
}

/// What stopped the arm on its way; nothing: nothing did.
std::optional<report::ToldRefusal> halt_of(const Json& followed) {
  const auto stopped = followed.find("stopped");
  if (stopped == followed.end() || !stopped->is_object()) return std::nullopt;
  return report::ToldRefusal{.reason_code = text_of(*stopped, "reason_code"),
                             .reason = text_of(*stopped, "reason"),
                             .next_step = text_of(*stopped, "next_step")};
}

void take(const report::ToldRefusal& told, memory::Scan& scan) {
  scan.reason_code = told.reason_code;
  scan.reason = told.reason;
  scan.next_step = told.next_step;
}

void take_gate(const Json& gate, memory::Scan& scan) {
  const auto permitted = gate.find("permitted");
  scan.sent = permitted != gate.end() && permitted->is_boolean() && permitted->get<bool>();
  if (const auto inputs = gate.find("inputs"); scan.sent && inputs != gate.end() && inputs->is_object())
    take_word(*inputs, scan);
  if (scan.sent) return;
  if (const auto told = gate_refusal(gate)) take(*told, scan);
}

/// A file that cannot be read tells nothing.
void take_work(const fs::path& folder, memory::Scan& scan) {
  const Result<std::optional<WorkBook>> book = read_work(folder);
  if (!book || !*book) return;
  scan.work = (*book)->work;
  if (!(*book)->told.reason.empty()) take((*book)->told, scan);
}

void take_line(const fs::path& file, memory::Scan& scan) {
  const Result<cloud::ClosedLine> line = cloud::read_line(file);
  if (!line) return;
  for (const cloud::LinePoint& point : line->points) {
    if (point.u95_mm) scan.u95_mm = std::max(scan.u95_mm.value_or(0), *point.u95_mm);
  }
}

}  // namespace

std::optional<report::ToldRefusal> why_not_followed(const fs::path& folder) {
  if (const Json followed = read_json(folder / "followed.json"); followed.is_object())
    return halt_of(followed);
  const Json gate = read_json(folder / "gate.json");
  return gate.is_object() ? gate_refusal(gate) : std::nullopt;
}

std::optional<memory::Scan> row_of(const fs::path& folder) {
  const Json report = read_json(folder / "report.json");
  if (!report.is_object()) return std::nullopt;
  memory::Scan scan;
  scan.name = folder.filename().string();
  scan.time = time_of(folder / "report.json");
  scan.length_mm = number_of(report, "length_mm");
  scan.confidence = number_of(report, "confidence");
  scan.part = text_of(report, "part");
  // The report of a scan that was set aside does not say it.
  if (scan.part.empty()) scan.part = marked_part(folder);
  scan.foot = text_of(report, "foot");
  scan.size = text_of(report, "size");
  if (const auto follows = report.find("follows"); follows != report.end() && follows->is_object())
    scan.follows = text_of(*follows, "scan");
  if (const auto account = report.find("scan"); account != report.end())
    scan.scan_s = number_of(*account, "duration_s");
  if (const auto stages = report.find("stages"); stages != report.end() && stages->is_object()) {
    scan.line_s = number_of(*stages, "last profile to line");
    if (!scan.line_s) scan.line_s = number_of(*stages, "transfer");
  }
  if (const std::optional<double> version = number_of(report, "line_version"))
    scan.line_version = static_cast<int>(*version);
  if (const auto weak = report.find("weak_stretches"); weak != report.end() && weak->is_array())
    scan.weak_stretches = static_cast<int>(weak->size());
  if (text_of(report, "status") == "review") {
    // Nothing is planned along it, and that has no other reason.
    take_refusal(report, scan, "review");
    take_line(folder / "line.csv", scan);
  } else if (text_of(report, "status") == "ok") {
    const auto check = report.find("calibration_check");
    const bool drifted =
        check != report.end() && check->is_object() && text_of(*check, "status") == "drifted";
    const auto prior = report.find("prior");
    const bool off_mended = prior != report.end() && prior->is_object() && prior->contains("reason_code");
    const bool amber = scan.weak_stretches > 0 || scan.line_version > 0 || drifted || off_mended;
    scan.verdict = amber ? "amber" : "ok";
    if (drifted || off_mended) {
      const Json& told = drifted ? *check : *prior;
      scan.reason_code = text_of(told, "reason_code");
      scan.reason = text_of(told, "words");
      scan.next_step = text_of(told, "next_step");
    }
    take_line(folder / "line.csv", scan);
    const Json plan = read_json(folder / "path/report.json");
    if (plan.is_object() && text_of(plan, "status") == "refused") take_refusal(plan, scan);
    if (const auto tip = plan.is_object() ? plan.find("tip") : plan.end();
        tip != plan.end() && tip->is_object())
      scan.tip_bound_mm = number_of(*tip, "bound_mm");
    if (const Json gate = read_json(folder / "gate.json"); gate.is_object()) take_gate(gate, scan);
    if (const Json followed = read_json(folder / "followed.json"); followed.is_object()) {
      const auto completed = followed.find("completed");
      scan.followed = completed != followed.end() && completed->is_boolean() && completed->get<bool>() &&
                      !followed.contains("stopped");
      if (const auto told = halt_of(followed)) take(*told, scan);
    }
    take_work(folder, scan);
  } else {
    take_refusal(report, scan);
  }
  return scan;
}

Result<int> take_up_rows(memory::Memory& memory, const fs::path& results) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::directory_iterator at{results, error}, end; !error && at != end; at.increment(error)) {
    if (api::is_scan_id(at->path().filename().string())) folders.push_back(at->path());
  }
  std::ranges::sort(folders);
  int taken = 0;
  for (const fs::path& folder : folders) {
    const std::string name = folder.filename().string();
    BITELINE_ASSIGN(const std::optional<memory::Scan> known, memory.scan(name));
    // A row "working" is of a decision on a scan whose result never came to the memory.
    if (known && known->verdict != "working") continue;
    std::optional<memory::Scan> row = row_of(folder);
    if (!row) continue;
    if (known) {
      // A person's word stands.
      row->decision = known->decision;
      row->decided_by = known->decided_by;
      row->decided_at = known->decided_at;
      row->why = known->why;
    }
    BITELINE_TRY(memory.put_scan(*row, {.id = 0,
                                        .time = memory::now_ms(),
                                        .who = "service",
                                        .door = {},
                                        .action = "taken up",
                                        .subject = name,
                                        .before = {},
                                        .after = row->verdict}));
    ++taken;
  }
  return taken;
}

}  // namespace biteline::service
