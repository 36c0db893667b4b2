// SPDX-License-Identifier: MIT
#include "host/interfaces/api/rerun.hpp"

#include "common/core/text_bounds.hpp"
#include "common/system/file.hpp"
#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/report/report.hpp"

namespace biteline::api {
namespace {

namespace fs = std::filesystem;
using control::Answer;

Json read_json(const fs::path& file) {
  const Result<std::string> text = read_regular_file(file, k_most_settings_bytes);
  Json json = text ? Json::parse(*text, nullptr, false) : Json{};
  return json.is_object() ? json : Json::object();
}

/// A field of the outcome, null where it has none.
Json field(const Json& from, const char* name) {
  const auto found = from.find(name);
  return found == from.end() ? Json{} : *found;
}

/// One `Rerun`.
Json rerun_json(const fs::path& scan, int number, bool open) {
  const fs::path folder = scan / rerun_folder(number);
  const Json order = read_json(folder / k_rerun_file);
  Json json{{"rerun", number}};
  for (const char* name : {"time", "who", "why", "settings"}) json[name] = field(order, name);
  std::error_code error;
  const Json report = read_json(folder / "report.json");
  if (open || !report.contains("status")) {
    // Without a report and without anybody at work on it: the service ended meanwhile.
    json["state"] = open ? "working" : "lost";
    return json;
  }
  json["state"] = "done";
  // A line whose path is refused is refused for the path's reason.
  const Json plan = read_json(folder / "path/report.json");
  const bool ok_line = report["status"] == "ok";
  const bool line = ok_line || report["status"] == "review";
  const Json& telling = ok_line && field(plan, "status") == "refused" ? plan : report;
  const Json status = field(telling, "status");
  json["verdict"] = status == "ok" || status == "review" ? status : Json("refused");
  for (const char* name : {"reason_code", "reason", "next_step"}) json[name] = field(telling, name);
  for (const char* name : {"length_mm", "confidence"}) json[name] = field(report, name);
  json["process"] = field(report, "process");
  json["line"] = line ? Json((rerun_folder(number) / "line.csv").string()) : Json{};
  const bool path = fs::exists(folder / "path/path.csv", error);
  json["path"] = path ? Json((rerun_folder(number) / "path/path.csv").string()) : Json{};
  return json;
}

}  // namespace

fs::path rerun_folder(int number) {
  return "rerun-" + std::to_string(number);
}

Json settings_json(const RerunOrder& order) {
  Json settings = Json::object();
  if (!order.model.empty()) settings["model"] = order.model;
  if (!order.method.empty()) settings["method"] = order.method;
  if (!order.process.empty()) settings["process"] = order.process;
  if (order.mirror) settings["mirror"] = true;
  if (order.grade) settings["grade"] = true;
  return settings;
}

Result<int> keep_order(const fs::path& scan, const RerunOrder& order) {
  std::error_code error;
  for (int number = 1; number <= k_most_reruns; ++number) {
    if (!fs::create_directory(scan / rerun_folder(number), error)) {
      if (error)
        return fail_errno(Errc::WriteFailed, error.value(), "%.200s", (scan / rerun_folder(number)).c_str());
      continue;
    }
    const Json kept{{"time", memory::to_iso(memory::now_ms())},
                    {"who", order.who},
                    {"why", or_null(order.why)},
                    {"settings", settings_json(order)}};
    BITELINE_TRY(
        report::write_file_atomically(scan / rerun_folder(number) / k_rerun_file, kept.dump() + "\n"));
    return number;
  }
  return fail(Errc::WrongState, "%s was worked out again %d times already; scan the shoe again",
              order.scan.c_str(), k_most_reruns);
}

Json reruns_json(const fs::path& scan, const std::function<bool(int)>& open) {
  Json list = Json::array();
  std::error_code error;
  for (int number = 1; number <= k_most_reruns; ++number) {
    if (fs::exists(scan / rerun_folder(number) / k_rerun_file, error))
      list.push_back(rerun_json(scan, number, open(number)));
  }
  return list;
}

Answer Api::rerun_scan(const Call& call) {
  const std::string& id = call.names.front();
  Fields fields{call.request.body};
  RerunOrder order{.scan = id,
                   .model = {},
                   .method = {},
                   .process = {},
                   .who = call.person.name,
                   .why = fields.text("why", bounds::k_why),
                   .door = call.request.door};
  const Json given = fields.object("settings");
  Fields settings{given};
  order.model = settings.text("model", bounds::k_name);
  order.method = settings.text("method", 20);
  order.process = settings.text("process", bounds::k_name);
  order.mirror = settings.boolean("mirror").value_or(false);
  order.grade = settings.boolean("grade").value_or(false);
  if (!order.model.empty() && !is_name(order.model)) settings.fault("model", "a model's name expected");
  if (!order.process.empty() && !is_name(order.process))
    settings.fault("process", "a process's name expected");
  if (!order.method.empty() && order.method != "default" && order.method != "published")
    settings.fault("method", "default or published expected");
  if (!order.model.empty() && !order.method.empty())
    settings.fault("method", "either a model's line or a method, not both");
  if ((order.mirror || order.grade) && order.model.empty())
    settings.fault("model", "mirror and grade need one");
  if (order.model.empty() && order.method.empty() && order.process.empty())
    settings.fault("", "a model, a method or a process expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (const std::optional<Answer> faults = settings.faults()) return *faults;
  if (!is_scan_id(id)) return control::refusal(404, "not_found", "no such scan; GET /scans lists them");
  const Result<std::optional<memory::Scan>> row = rooms_.memory.scan(id);
  if (!row) return answer_of(row.error());
  if (!*row) return control::refusal(404, "not_found", id + ": no such scan; GET /scans lists them");
  const Result<Catalogue> catalogue = this->catalogue();
  if (!catalogue) return answer_of(catalogue.error());
  if (!order.process.empty()) {
    if (const auto process = catalogue->processes.find(order.process); !process)
      return answer_of(process.error());
  }
  if (!order.model.empty()) {
    if (const auto model = catalogue->models.info(order.model); !model) return answer_of(model.error());
  }
  const Result<int> number = rooms_.cell.rerun(order);
  if (!number) return answer_of(number.error());
  static_cast<void>(rooms_.memory.log({.id = 0,
                                       .time = memory::now_ms(),
                                       .who = call.person.name,
                                       .door = call.request.door,
                                       .action = "rerun",
                                       .subject = id,
                                       .before = {},
                                       .after = settings_json(order).dump()}));
  const int made = *number;
  return ok(rerun_json(rooms_.results / id, made, rooms_.cell.rerun_open(id, made)), 202);
}

}  // namespace biteline::api
