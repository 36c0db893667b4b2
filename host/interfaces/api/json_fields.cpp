// SPDX-License-Identifier: MIT
#include "host/interfaces/api/json_fields.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>

#include "common/core/text.hpp"
#include "common/core/text_bounds.hpp"
#include "host/records/memory/history.hpp"

namespace biteline::api {
namespace {

Answer bad_request(const std::string& message) {
  return control::refusal(400, "bad_request", message);
}

/// A folder or a name of a file needs room, too: what made it says only that it cannot be written.
bool is_full_disk(const Error& error) {
  const int fault = error.sys_errno;
  return error.code == Errc::DiskFull ||
         (error.code == Errc::WriteFailed && (fault == ENOSPC || fault == EDQUOT || fault == EFBIG));
}

std::optional<std::int64_t> number_of(const std::string& text) {
  std::int64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || at != end) return std::nullopt;
  return number;
}

}  // namespace

Answer ok(Json body, int status) {
  Answer answer;
  answer.status = status;
  answer.body = std::move(body);
  return answer;
}

Answer nothing() {
  return ok({}, 204);
}

Answer answer_of(const Error& error) {
  // Who may not, is told so by its own words: those of the code are of a sensor's threads.
  const std::string line = error.code == Errc::NoRights ? std::string{error.where.view()} : to_line(error);
  if (is_full_disk(error)) return control::refusal(507, "disk_full", line);
  switch (error.code) {
    case Errc::FileNotFound:
      return control::refusal(404, "not_found", line);
    case Errc::WrongState:
      return control::refusal(409, "wrong_state", line);
    case Errc::PeerRefused:
      return control::refusal(409, "refused", line);
    case Errc::NoRights:
      return control::refusal(409, "control_needed", line);
    case Errc::CheckFailed:
      return control::refusal(422, "check_failed", line);
    case Errc::InvalidArgument:
    case Errc::BadFormat:
    case Errc::BadValue:
    case Errc::UnknownKey:
    case Errc::NotSupported:
      return bad_request(line);
    default:
      return control::refusal(500, "internal", line);
  }
}

Answer unlogged(const std::string& done, const Error& error) {
  Answer answer = answer_of(error);
  Json& message = answer.body["error"]["message"];
  message = done + "; that could not be noted: " + message.get<std::string>();
  return answer;
}

// Round brackets: in braces nlohmann makes a list of one.
Fields::Fields(const Json& body) : body_(body.is_null() ? Json::object() : body) {
  if (!body_.is_object()) {
    body_ = Json::object();
    fault("", "a JSON object expected");
  }
}

bool Fields::has(const std::string& name) const {
  return body_.contains(name) && !body_[name].is_null();
}

std::string Fields::text(const std::string& name, std::size_t most_bytes, bool required) {
  known_.push_back(name);
  if (!has(name)) {
    if (required) fault(name, "a text expected");
    return {};
  }
  const Json& value = body_[name];
  if (!value.is_string()) {
    fault(name, "a text expected");
    return {};
  }
  auto text = value.get<std::string>();
  if (!bounds::fits(text, most_bytes)) {
    fault(name, bounds::expected(most_bytes));
    return {};
  }
  if (required && text.empty()) fault(name, "must not be empty");
  return text;
}

std::optional<bool> Fields::boolean(const std::string& name) {
  known_.push_back(name);
  if (!has(name)) return std::nullopt;
  if (!body_[name].is_boolean()) {
    fault(name, "true or false expected");
    return std::nullopt;
  }
  return body_[name].get<bool>();
}

std::optional<double> Fields::number(const std::string& name, double least, double most) {
  known_.push_back(name);
  if (!has(name)) return std::nullopt;
  const Json& value = body_[name];
  if (value.is_number() && value.get<double>() >= least && value.get<double>() <= most)
    return value.get<double>();
  fault(name, "a number from " + Json(least).dump() + " to " + Json(most).dump() + " expected");
  return std::nullopt;
}

Json Fields::list(const std::string& name, std::size_t most) {
  known_.push_back(name);
  if (!has(name)) return Json::array();
  if (body_[name].is_array() && body_[name].size() <= most) return body_[name];
  fault(name, "a list of at most " + std::to_string(most) + " expected");
  return Json::array();
}

Json Fields::object(const std::string& name) {
  known_.push_back(name);
  if (!has(name)) return {};
  if (body_[name].is_object()) return body_[name];
  fault(name, "a JSON object expected");
  return {};
}

void Fields::fault(const std::string& name, const std::string& message) {
  faults_.push_back({{"field", name}, {"message", message}});
}

std::optional<Answer> Fields::faults() {
  for (const auto& [name, value] : body_.items()) {
    if (std::ranges::find(known_, name) == known_.end()) fault(clean_text(name, 60), "unknown field");
  }
  if (faults_.empty()) return std::nullopt;
  const Json& first = faults_.front();
  std::string where = first["field"].get<std::string>();
  Answer answer = bad_request((where.empty() ? "body" : where) + ": " + first["message"].get<std::string>());
  answer.body["error"]["faults"] = faults_;
  return answer;
}

QueryFilter filter_of(const std::map<std::string, std::string>& query, const memory::FactoryDay& day) {
  QueryFilter out;
  const auto fault = [&](const std::string& name, const std::string& expected) {
    if (!out.fault) out.fault = bad_request("query " + name + ": " + expected + " expected");
  };
  for (const auto& [name, value] : query) {
    if (name == "from" || name == "to") {
      const std::optional<memory::UnixMs> time = day.time_of(value);
      if (!time) fault(name, "a day such as 2026-11-20 or a time such as 2026-11-20T21:04:05Z");
      (name == "from" ? out.filter.from : out.filter.to) = time;
    } else if (name == "model") {
      out.filter.model = value;
    } else if (name == "verdict") {
      constexpr std::array k_verdicts{"working", "ok", "amber", "review", "refused", "failed"};
      if (std::ranges::find(k_verdicts, value) == k_verdicts.end())
        fault(name, "working, ok, amber, review, refused or failed");
      out.filter.verdict = value;
    } else if (name == "reason_code") {
      out.filter.reason_code = value;
    } else if (name == "part") {
      out.filter.part = value;
    } else if (name == "limit") {
      const std::optional<std::int64_t> limit = number_of(value);
      if (!limit || *limit < 1 || *limit > memory::k_most_scans) fault(name, "a number from 1 to 1000");
      out.filter.limit = static_cast<int>(limit.value_or(1));
    } else if (name == "cursor") {
      const std::optional<std::int64_t> cursor = number_of(value);
      if (!cursor || *cursor < 1) fault(name, "`next` of the page before");
      out.filter.before_id = cursor.value_or(0);
    } else if (name != "bucket" && name != "separator" && name != "decimal" && name != "byte_mark") {
      fault(name, "from, to, model, verdict, reason_code, part, limit, cursor or bucket");
    }
  }
  return out;
}

bool is_name(const std::string& text) {
  return !text.empty() && text.size() <= bounds::k_name && text.front() != '.' && text.front() != '_' &&
         text.front() != '-' && std::ranges::all_of(text, [](unsigned char c) {
           return c < 128 && (std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-');
         });
}

bool is_scan_id(const std::string& text) {
  constexpr std::string_view k_front = "scan-";
  return text.starts_with(k_front) && text.size() >= k_front.size() + 4 &&
         text.size() <= k_front.size() + 9 &&
         std::all_of(text.begin() + k_front.size(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool is_foot(const std::string& text) {
  return text == "left" || text == "right";
}

Json or_null(const std::string& text) {
  return text.empty() ? Json{} : Json(text);
}

Json or_null(const std::optional<double>& number) {
  return number ? Json(*number) : Json{};
}

Json work_json(const memory::Work& work) {
  if (work.verdict.empty()) return {};
  return {{"verdict", work.verdict}, {"reworked", work.reworked}, {"missing_mm", or_null(work.missing_mm)},
          {"narrow", work.narrow},   {"wide", work.wide},         {"beside", work.beside},
          {"doubled", work.doubled}};
}

Json to_json(const memory::Scan& scan) {
  Json row{{"id", scan.name},
           {"time", memory::to_iso(scan.time)},
           {"verdict", scan.verdict},
           {"decision", scan.decision},
           {"decided_by", or_null(scan.decided_by)},
           {"decided_at", scan.decided_at ? Json(memory::to_iso(*scan.decided_at)) : Json{}},
           {"why", or_null(scan.why)},
           {"model", or_null(scan.model)},
           {"model_probability", or_null(scan.model_probability)},
           {"process", or_null(scan.process)},
           {"part", or_null(scan.part)},
           {"foot", or_null(scan.foot)},
           {"size", or_null(scan.size)},
           {"follows", or_null(scan.follows)},
           {"reason_code", or_null(scan.reason_code)},
           {"reason", or_null(scan.reason)},
           {"next_step", or_null(scan.next_step)},
           {"ended_by", or_null(std::string{report::name_of(memory::ended_by(scan))})},
           {"length_mm", or_null(scan.length_mm)},
           {"confidence", or_null(scan.confidence)},
           {"u95_mm", or_null(scan.u95_mm)},
           {"tip_bound_mm", or_null(scan.tip_bound_mm)},
           {"weak_stretches", scan.weak_stretches},
           {"scan_s", or_null(scan.scan_s)},
           {"line_s", or_null(scan.line_s)},
           {"cycle_s", or_null(scan.cycle_s)},
           {"sent", scan.sent},
           {"followed", scan.followed ? Json(*scan.followed) : Json{}},
           {"work", work_json(scan.work)},
           {"operator", or_null(scan.operator_name)},
           {"line_version", scan.line_version},
           {"kept", scan.marked}};
  if (const std::optional<Json> versions = control::parse_bounded(scan.versions);
      versions && versions->is_object())
    row["version"] = versions->value("program", "");
  return row;
}

Json to_json(const memory::LogRow& row) {
  return {{"seq", row.id},
          {"time", memory::to_iso(row.time)},
          {"who", row.who},
          {"door", row.door},
          {"what", row.action},
          {"subject", or_null(row.subject)},
          {"before", or_null(row.before)},
          {"after", or_null(row.after)}};
}

Json to_json(const memory::User& user) {
  return {{"name", user.name},
          {"role", user.role},
          {"enabled", user.enabled},
          {"made", memory::to_iso(user.created)},
          {"last_login", user.last_login ? Json(memory::to_iso(*user.last_login)) : Json{}}};
}

}  // namespace biteline::api
