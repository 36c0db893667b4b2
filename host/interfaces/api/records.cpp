// SPDX-License-Identifier: MIT
// Scans, decisions, history and the log.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/core/text_bounds.hpp"
#include "common/system/file.hpp"
#include "host/bite_line/edit/versions.hpp"
#include "host/interfaces/api/air.hpp"
#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/interfaces/api/json_file.hpp"
#include "host/interfaces/api/rerun.hpp"
#include "host/records/digest/digest.hpp"
#include "host/records/memory/history.hpp"

namespace biteline::api {

using control::Answer;

namespace {

namespace fs = std::filesystem;

/// `LineVersion`s; a list that cannot be read shows what was found alone.
Json versions_json(const fs::path& folder, const memory::Scan& scan) {
  Json rows = Json::array();
  const Result<std::vector<edit::Version>> versions = edit::read_versions(folder);
  if (!versions) return rows;
  for (const edit::Version& version : *versions) {
    rows.push_back({{"version", version.version},
                    {"time", version.time.empty() ? memory::to_iso(scan.time) : version.time},
                    {"who", version.who},
                    {"why", version.why},
                    {"file", edit::line_file(version.version).string()}});
  }
  // Before the first mend the line stands in its own place.
  if (rows.size() == 1) rows[0]["file"] = "line.csv";
  return rows;
}

/// A process may have another name than its file, and the file another content by now: which of the list it
/// is.
Json process_file_json(const fs::path& folder, const Catalogue& catalogue) {
  const Result<std::string> kept = digest_of_file(folder / transfer::k_process_file);
  if (!kept) return {};
  for (const StoredProcess& stored : catalogue.processes.list()) {
    if (const Result<std::string> now = digest_of_file(stored.file); now && *now == *kept) return stored.name;
  }
  return {};
}

}  // namespace

Json file_json(const fs::path& file) {
  const Result<std::string> text = read_regular_file(file, k_most_settings_bytes);
  if (!text) return {};
  Json json = Json::parse(*text, nullptr, false);
  return json.is_discarded() ? Json{} : json;
}

Answer Api::list_scans(const Call& call) {
  const QueryFilter query = filter_of(call.request.query, rooms_.day);
  if (query.fault) return *query.fault;
  const Result<memory::ScanPage> page = rooms_.memory.scans(query.filter);
  if (!page) return answer_of(page.error());
  Json scans = Json::array();
  for (const memory::Scan& scan : page->scans) scans.push_back(to_json(scan));
  return ok({{"scans", std::move(scans)},
             {"next", page->next_id > 0 ? Json(std::to_string(page->next_id)) : Json{}}});
}

Answer Api::read_scan(const Call& call) {
  const std::string& id = call.names.front();
  if (!is_scan_id(id)) return control::refusal(404, "not_found", "no such scan; GET /scans lists them");
  const Result<std::optional<memory::Scan>> scan = rooms_.memory.scan(id);
  if (!scan) return answer_of(scan.error());
  if (!*scan) return control::refusal(404, "not_found", id + ": no such scan; GET /scans lists them");
  Json json = to_json(**scan);
  const fs::path folder = rooms_.results / id;
  json["report"] = file_json(folder / "report.json");
  json["gate"] = file_json(folder / "gate.json");
  json["follow"] = file_json(folder / "followed.json");
  json["air"] = air_json(folder / k_air_folder);
  if (const Result<Catalogue> catalogue = this->catalogue(); catalogue)
    json["process_file"] = process_file_json(folder, *catalogue);
  json["versions"] = versions_json(folder, **scan);
  json["reruns"] = reruns_json(folder, [&](int number) { return rooms_.cell.rerun_open(id, number); });
  Json stretches = Json::array();
  if (json["report"].is_object() && json["report"].contains("weak_stretches") &&
      json["report"]["weak_stretches"].is_array()) {
    for (const Json& weak : json["report"]["weak_stretches"]) {
      const double from = weak.value("from_mm", 0.0);
      Json stretch{{"from_mm", from},
                   {"to_mm", from + weak.value("length_mm", 0.0)},
                   {"place", weak.value("place", "")}};
      if (weak.contains("least_confidence")) stretch["confidence"] = weak["least_confidence"];
      if (weak.contains("u95_mm") && weak["u95_mm"].is_number()) stretch["u95_mm"] = weak["u95_mm"];
      if (weak.contains("reason_code")) stretch["why"] = weak["reason_code"];
      if (weak.contains("alternatives")) stretch["alternatives"] = weak["alternatives"];
      stretches.push_back(std::move(stretch));
    }
  }
  json["stretches"] = std::move(stretches);
  return ok(std::move(json));
}

Answer Api::decide(const Call& call, Decision::Kind kind, int status, bool needs_why) {
  const std::string& id = call.names.front();
  Fields fields{call.request.body};
  const std::string why = fields.text("why", bounds::k_why, needs_why);
  const std::string version = fields.text("version", bounds::k_name);
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (!is_scan_id(id)) return control::refusal(404, "not_found", "no such scan; GET /scans lists them");
  const Result<void> done = rooms_.cell.decide({.kind = kind,
                                                .scan = id,
                                                .who = call.person.name,
                                                .why = why,
                                                .door = call.request.door,
                                                .version = version,
                                                .stops = call.request.stops});
  if (!done) return answer_of(done.error());
  const Result<std::optional<memory::Scan>> scan = rooms_.memory.scan(id);
  if (!scan) return answer_of(scan.error());
  if (!*scan) return control::refusal(404, "not_found", id + ": no such scan");
  return ok(to_json(**scan), status);
}

Answer Api::accept_scan(const Call& call) {
  return decide(call, Decision::Kind::Accept, 200, false);
}
Answer Api::reject_scan(const Call& call) {
  return decide(call, Decision::Kind::Reject, 200, true);
}
Answer Api::hold_scan(const Call& call) {
  return decide(call, Decision::Kind::Hold, 200, false);
}
Answer Api::send_scan(const Call& call) {
  return decide(call, Decision::Kind::Send, 202, false);
}

Answer Api::choose_model(const Call& call) {
  const std::string& id = call.names.front();
  Fields fields{call.request.body};
  const std::string model = fields.text("model", bounds::k_name, true);
  if (!model.empty() && !is_name(model)) fields.fault("model", "a model's name expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (!is_scan_id(id)) return control::refusal(404, "not_found", "no such scan; GET /scans lists them");
  const Result<Catalogue> catalogue = this->catalogue();
  if (!catalogue) return answer_of(catalogue.error());
  const Result<transfer::ModelInfo> info = catalogue->models.info(model);
  if (!info) return answer_of(info.error());
  if (info->damage) return answer_of(*info->damage);
  const Result<void> chosen = rooms_.cell.choose_model(id, model, speaker(call));
  if (!chosen) return answer_of(chosen.error());
  return begun(call, "choose model", model, id + " goes on as " + model);
}

Answer Api::begun(const Call& call, const std::string& action, const std::string& what,
                  const std::string& words) {
  static_cast<void>(rooms_.memory.log({.id = 0,
                                       .time = memory::now_ms(),
                                       .who = call.person.name,
                                       .door = call.request.door,
                                       .action = action,
                                       .subject = call.names.front(),
                                       .before = {},
                                       .after = what}));
  return ok({{"done", false}, {"words", words}}, 202);
}

Answer Api::choose_process(const Call& call) {
  const std::string& id = call.names.front();
  Fields fields{call.request.body};
  const std::string process = fields.text("process", bounds::k_name, true);
  if (!process.empty() && !is_name(process)) fields.fault("process", "a process's name expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (!is_scan_id(id)) return control::refusal(404, "not_found", "no such scan; GET /scans lists them");
  const Result<Catalogue> catalogue = this->catalogue();
  if (!catalogue) return answer_of(catalogue.error());
  if (const auto stored = catalogue->processes.find(process); !stored) return answer_of(stored.error());
  const Result<void> chosen = rooms_.cell.choose_process(id, process, speaker(call));
  if (!chosen) return answer_of(chosen.error());
  teach_.chose_process(id, call.person.name);
  return begun(call, "choose process", process, "the path of " + id + " is planned with " + process);
}

Answer Api::run_in_air(const Call& call) {
  const std::string& id = call.names.front();
  Fields fields{call.request.body};
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (!is_scan_id(id)) return control::refusal(404, "not_found", "no such scan; GET /scans lists them");
  const std::string before = teach_.before_air(id);
  const Result<void> begins = rooms_.cell.run_in_air(id, speaker(call));
  if (!begins) return answer_of(begins.error());
  teach_.runs_in_air(id, call.person.name, before);
  return begun(call, "run in the air", "",
               "the arm runs the path of " + id + " in the air, if the gate opens");
}

Answer Api::look_again(const Call& call) {
  const std::string& id = call.names.front();
  Fields fields{call.request.body};
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (!is_scan_id(id)) return control::refusal(404, "not_found", "no such scan; GET /scans lists them");
  const Result<void> looks = rooms_.cell.look_again(id, speaker(call));
  if (!looks) return answer_of(looks.error());
  return begun(call, "look again", "",
               "the sensor looks whether the shoe of " + id + " still lies as scanned");
}

Answer Api::keep_scan(const Call& call) {
  const std::string& id = call.names.front();
  Fields fields{call.request.body};
  const std::optional<bool> kept = fields.boolean("kept");
  if (!kept) fields.fault("kept", "true or false expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Result<void> done = rooms_.memory.mark(id, *kept,
                                               {.id = 0,
                                                .time = memory::now_ms(),
                                                .who = call.person.name,
                                                .door = call.request.door,
                                                .action = *kept ? "keep" : "keep no longer",
                                                .subject = id,
                                                .before = {},
                                                .after = {}});
  if (!done) return answer_of(done.error());
  const Result<std::optional<memory::Scan>> scan = rooms_.memory.scan(id);
  if (!scan) return answer_of(scan.error());
  return ok(to_json(**scan));
}

Answer Api::read_log(const Call& call) {
  const QueryFilter query = filter_of(call.request.query, rooms_.day);
  if (query.fault) return *query.fault;
  const memory::ScanFilter& filter = query.filter;
  Result<std::vector<memory::LogRow>> rows =
      rooms_.memory.log_rows(filter.before_id, filter.limit + 1, filter.from, filter.to);
  if (!rows) return answer_of(rows.error());
  Json next;
  if (static_cast<int>(rows->size()) > filter.limit) {
    rows->pop_back();
    next = std::to_string(rows->back().id);
  }
  Json entries = Json::array();
  for (const memory::LogRow& row : *rows) entries.push_back(to_json(row));
  return ok({{"entries", std::move(entries)}, {"next", std::move(next)}});
}

Answer Api::read_trends(const Call& call) {
  const QueryFilter query = filter_of(call.request.query, rooms_.day);
  if (query.fault) return *query.fault;
  const auto asked = call.request.query.find("bucket");
  const std::string bucket = asked == call.request.query.end() ? "day" : asked->second;
  if (bucket != "hour" && bucket != "day" && bucket != "week")
    return control::refusal(400, "bad_request", "query bucket: hour, day or week expected");
  const memory::Span span = bucket == "hour"  ? memory::Span::Hour
                            : bucket == "day" ? memory::Span::Day
                                              : memory::Span::Week;
  const Result<memory::Trends> trends = rooms_.memory.trends(query.filter, rooms_.day, span);
  if (!trends) return answer_of(trends.error());
  Json json = memory::to_json(*trends);
  json["capability"] = nullptr;
  if (!query.filter.model.empty()) {
    const Result<memory::PlaceSums> sums =
        rooms_.memory.place_sums(query.filter.model, query.filter.from, query.filter.to);
    if (!sums) return answer_of(sums.error());
    // The tolerance is the model's process's; without one there is nothing to compare with.
    const Result<Catalogue> catalogue = this->catalogue();
    if (!catalogue) return answer_of(catalogue.error());
    const Result<path::Process> process =
        path::read_process(catalogue->models.path_of(query.filter.model) / transfer::k_process_file);
    if (process && process->gate.tolerance_mm) {
      if (const auto capability = memory::capability_of(*sums, *process->gate.tolerance_mm)) {
        json["capability"] = {{"model", query.filter.model},
                              {"tolerance_mm", *process->gate.tolerance_mm},
                              {"scans", sums->scans},
                              {"pp", capability->pp},
                              {"ppk", capability->ppk}};
      }
    }
  }
  return ok(std::move(json));
}

Answer Api::export_history(const Call& call) {
  const QueryFilter query = filter_of(call.request.query, rooms_.day);
  if (query.fault) return *query.fault;
  const auto asked = [&call](const char* name, const char* otherwise) {
    const auto found = call.request.query.find(name);
    return found == call.request.query.end() ? std::string{otherwise} : found->second;
  };
  const auto style = memory::csv_style(asked("separator", "comma"), asked("decimal", "point"),
                                       asked("byte_mark", "no") == "yes");
  if (!style)
    return control::refusal(400, "bad_request",
                            "query separator: comma, semicolon or tab, and query decimal: point or comma "
                            "expected, two different signs");
  const Result<std::string> csv = memory::history_csv(rooms_.memory, query.filter, *style, rooms_.day);
  if (!csv) return answer_of(csv.error());
  Answer answer = ok(*csv);
  answer.type = "text/csv";
  return answer;
}

}  // namespace biteline::api
