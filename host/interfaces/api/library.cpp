// SPDX-License-Identifier: MIT
// Models and processes.
#include <algorithm>

#include "common/core/text_bounds.hpp"
#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/interfaces/api/process_schema.hpp"
#include "host/records/digest/digest.hpp"

namespace biteline::api {

using control::Answer;

namespace {

namespace fs = std::filesystem;

Json model_json(const transfer::ModelInfo& model) {
  Json json{{"name", model.name},
            {"scan", or_null(model.made.scan)},
            {"process", or_null(model.made.process)},
            {"size", or_null(model.made.size)},
            {"foot", or_null(model.made.foot)},
            {"of", or_null(model.made.of)},
            {"version", model.made.version},
            {"length_mm", model.damage ? Json{} : Json(model.line_length_mm)}};
  if (!model.made.time.empty()) json["time"] = model.made.time;
  if (model.damage) json["damage"] = to_line(*model.damage);
  return json;
}

memory::LogRow event(const Call& call, const std::string& action, const std::string& subject,
                     const std::string& before, const std::string& after) {
  return {.id = 0,
          .time = memory::now_ms(),
          .who = call.person.name,
          .door = call.request.door,
          .action = action,
          .subject = subject,
          .before = before,
          .after = after};
}

Answer process_answer(const ProcessStore& processes, const std::string& name) {
  const Result<StoredProcess> stored = processes.find(name);
  if (!stored) return answer_of(stored.error());
  const Result<Json> process = processes.read(stored->name);
  if (!process) return answer_of(process.error());
  return ok({{"name", stored->name}, {"shipped", stored->shipped}, {"process", *process}});
}

/// A process's fault with the field that has it.
Answer fault_answer(const Error& error) {
  Answer answer = answer_of(error);
  // The reader names the key between the first comma and the colon behind it.
  if (answer.status == 422) {
    const std::string line = to_line(error);
    const std::size_t comma = line.find(", ");
    const std::size_t colon = comma == std::string::npos ? comma : line.find(": ", comma);
    const std::string field = colon == std::string::npos ? "" : line.substr(comma + 2, colon - comma - 2);
    answer.body["error"]["faults"] = Json::array({{{"field", field}, {"message", line}}});
  }
  return answer;
}

}  // namespace

Result<Catalogue> Api::catalogue() const {
  if (rooms_.catalogue) return rooms_.catalogue();
  return Catalogue{.release = {}, .models = rooms_.models, .processes = rooms_.processes};
}

Answer Api::list_models(const Call&) {
  rooms_.exchange.forget_idle();
  const Result<Catalogue> catalogue = this->catalogue();
  if (!catalogue) return answer_of(catalogue.error());
  const Result<std::vector<transfer::ModelInfo>> models = catalogue->models.list();
  if (!models) return answer_of(models.error());
  Json list = Json::array();
  for (const transfer::ModelInfo& model : *models) list.push_back(model_json(model));
  return ok({{"models", std::move(list)}, {"release", or_null(catalogue->release)}});
}

Answer Api::read_model(const Call& call) {
  const Result<Catalogue> catalogue = this->catalogue();
  if (!catalogue) return answer_of(catalogue.error());
  const Result<transfer::ModelInfo> model = catalogue->models.info(call.names.front());
  return model ? ok(model_json(*model)) : answer_of(model.error());
}

std::optional<Answer> Api::choose_process_of_model(const std::string& scan, const std::string& process,
                                                   bool other, transfer::SaveOptions& options) {
  const Result<std::optional<memory::Scan>> row = rooms_.memory.scan(scan);
  if (!row) return answer_of(row.error());
  const std::string planned = *row ? (*row)->process : std::string{};
  const fs::path kept = rooms_.results / scan / transfer::k_process_file;
  std::error_code error;
  const bool is_kept = fs::exists(kept, error);
  // Of an older program no process stands beside the scan: its name has to do.
  const std::string name = process.empty() && !is_kept ? planned : process;
  options.made.process = name.empty() ? planned : name;
  if (is_kept) options.process_file = kept;
  if (name.empty()) return std::nullopt;
  const auto another = [&] {
    return control::refusal(
        409, "wrong_state",
        scan + " was planned with " + planned +
            (name == planned ? ", which is another one by now" : ", and not with " + name) +
            ": name no process to save its own, or say other_process");
  };
  const Result<Catalogue> catalogue = this->catalogue();
  if (!catalogue) return answer_of(catalogue.error());
  const Result<StoredProcess> stored = catalogue->processes.find(name);
  if (!stored) return process.empty() ? another() : answer_of(stored.error());
  if (!other && is_kept) {
    const Result<std::string> now = digest_of_file(stored->file), then = digest_of_file(kept);
    if (!now || !then) return answer_of(now ? then.error() : now.error());
    if (*now != *then) return another();
  } else if (!other && !planned.empty()) {
    const Result<path::Process> read = path::read_process(stored->file);
    if (!read) return answer_of(read.error());
    if (read->name != planned) return another();
  }
  if (other || !is_kept) options.process_file = stored->file;
  return std::nullopt;
}

Result<std::string> Api::not_run_in_air(const std::string& scan, const transfer::SaveOptions& options) {
  // A scan without a process of its own was planned with none.
  const Result<std::string> process = options.process_file.empty() ? Result<std::string>{std::string{}}
                                                                   : digest_of_file(options.process_file);
  if (!process) return tl::unexpected<Error>{process.error()};
  return teach_.not_run(scan, *process);
}

Answer Api::save_model(const Call& call) {
  Fields fields{call.request.body};
  const std::string name = fields.text("name", bounds::k_name, true);
  const std::string scan = fields.text("scan", 14, true);
  const std::string process = fields.text("process", bounds::k_name);
  transfer::ModelMade made;
  made.size = fields.text("size", bounds::k_size);
  made.foot = fields.text("foot", bounds::k_choice);
  made.of = fields.text("of", bounds::k_name);
  const bool replace = fields.boolean("replace").value_or(false);
  const bool other_process = fields.boolean("other_process").value_or(false);
  const bool not_run_said = fields.boolean("not_run").value_or(false);
  if (!is_name(name)) fields.fault("name", "letters, digits, '.', '_', '-', at most 64, expected");
  if (!is_scan_id(scan)) fields.fault("scan", "scan-0001 expected");
  if (!made.of.empty() && !is_name(made.of)) fields.fault("of", "a model's name expected");
  if (!made.foot.empty() && !is_foot(made.foot)) fields.fault("foot", "left or right expected");
  if (other_process && process.empty()) fields.fault("process", "the other process expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  transfer::SaveOptions options{.process_file = {}, .replace = replace, .made = made};
  if (const std::optional<Answer> refused = choose_process_of_model(scan, process, other_process, options))
    return *refused;
  options.made.scan = scan;
  options.made.time = memory::to_iso(memory::now_ms());
  options.made.program = rooms_.version;
  if (!replace && rooms_.models.has(name))
    return control::refusal(409, "exists", "model " + name + " exists; say replace, or choose another name");
  if (!fs::is_directory(rooms_.results / scan))
    return control::refusal(404, "not_found", scan + ": no such scan");
  const Result<std::string> not_run = not_run_in_air(scan, options);
  if (!not_run) return answer_of(not_run.error());
  if (!not_run->empty() && !not_run_said)
    return control::refusal(409, "wrong_state",
                            *not_run + ": run it (POST /scans/" + scan + "/air), or say not_run");
  const Result<transfer::ModelInfo> model = rooms_.models.save(name, rooms_.results / scan, options);
  if (!model) return answer_of(model.error());
  if (const Result<std::string> sha256 =
          digest_of_file(rooms_.models.path_of(name) / transfer::k_process_file))
    rooms_.cell.model_saved(*sha256, call.person.name);
  teach_.saved(scan, name, call.person.name);
  return tell_of_model(call, *model, replace ? "replace model" : "save model",
                       not_run->empty() ? scan : scan + ", not run: " + *not_run);
}

Answer Api::tell_of_model(const Call& call, const transfer::ModelInfo& model, const std::string& action,
                          const std::string& after) {
  if (rooms_.publish) rooms_.publish("model", model_json(model));
  if (const auto logged = rooms_.memory.log(event(call, action, model.name, "", after)); !logged)
    return unlogged("model " + model.name + " is saved", logged.error());
  return ok(model_json(model), 201);
}

Answer Api::remove_model(const Call& call) {
  const std::string& name = call.names.front();
  if (const Result<void> done = rooms_.models.remove(name); !done) return answer_of(done.error());
  if (const auto logged = rooms_.memory.log(event(call, "remove model", name, name, "")); !logged)
    return unlogged("model " + name + " is removed", logged.error());
  return nothing();
}

Answer Api::list_processes(const Call&) {
  const Result<Catalogue> catalogue = this->catalogue();
  if (!catalogue) return answer_of(catalogue.error());
  Json list = Json::array();
  for (const StoredProcess& process : catalogue->processes.list())
    list.push_back({{"name", process.name}, {"shipped", process.shipped}});
  return ok({{"processes", std::move(list)}, {"release", or_null(catalogue->release)}});
}

Answer Api::read_process_schema(const Call&) {
  return ok(process_schema());
}

Answer Api::read_process(const Call& call) {
  const Result<Catalogue> catalogue = this->catalogue();
  return catalogue ? process_answer(catalogue->processes, call.names.front()) : answer_of(catalogue.error());
}

Answer Api::write_process(const Call& call) {
  const std::string& name = call.names.front();
  if (!is_name(name))
    return control::refusal(400, "bad_request", "name: letters, digits, '.', '_', '-' expected");
  if (!call.request.body.is_object())
    return control::refusal(400, "bad_request", "body: a JSON object expected");
  const Result<Json> before = rooms_.processes.read(name);
  if (const Result<void> saved = rooms_.processes.save(name, call.request.body); !saved) {
    return fault_answer(saved.error());
  }
  if (const auto logged =
          rooms_.memory.log(event(call, "save process", name, before ? before->dump() : "",
                                  call.request.body.dump(-1, ' ', false, Json::error_handler_t::replace)));
      !logged)
    return unlogged("process " + name + " is saved", logged.error());
  return process_answer(rooms_.processes, name);
}

Result<std::string> Api::newest_with_line() const {
  constexpr int k_looked_at = 100;
  memory::ScanFilter newest;
  newest.limit = k_looked_at;
  BITELINE_ASSIGN(const memory::ScanPage page, rooms_.memory.scans(newest));
  for (const memory::Scan& scan : page.scans) {
    std::error_code error;
    const fs::path folder = rooms_.results / scan.name;
    const bool has_line = scan.verdict == "ok" || scan.verdict == "amber";
    if (has_line && fs::exists(folder / "line.csv", error) && fs::exists(folder / "cloud.ply", error))
      return scan.name;
  }
  return std::string{};
}

Answer Api::check_process(const Call& call) {
  Fields fields{call.request.body};
  const Json given = fields.object("process");
  const std::string wanted = fields.text("scan", 14);
  if (given.is_null()) fields.fault("process", "a JSON object expected");
  if (!wanted.empty() && !is_scan_id(wanted)) fields.fault("scan", "scan-0001 expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Result<path::Process> process = ProcessStore::check("as typed", given);
  if (!process) return fault_answer(process.error());
  Result<std::string> scan = wanted.empty() ? newest_with_line() : Result<std::string>{wanted};
  if (!scan) return answer_of(scan.error());
  Json json{{"scan", or_null(*scan)}, {"fits", nullptr},   {"duration_s", nullptr},
            {"reason_code", nullptr}, {"reason", nullptr}, {"next_step", nullptr}};
  if (scan->empty()) return ok(std::move(json));
  const Result<TriedPath> tried = rooms_.cell.try_process(*scan, *process);
  if (!tried) return answer_of(tried.error());
  json["fits"] = !tried->refused;
  if (!tried->refused) {
    json["duration_s"] = tried->duration_s;
  } else {
    json["reason_code"] = tried->refused->reason_code;
    json["reason"] = tried->refused->reason;
    json["next_step"] = tried->refused->next_step;
  }
  return ok(std::move(json));
}

}  // namespace biteline::api
