// SPDX-License-Identifier: MIT
#include "host/interfaces/control/messages.hpp"

#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <ctime>

#include "common/core/text.hpp"

namespace biteline::control {
namespace {

constexpr std::size_t k_most_name_bytes = 64;
constexpr std::size_t k_most_token_bytes = 128;
constexpr std::size_t k_most_path_bytes = 512;
constexpr std::size_t k_most_query_entries = 32;

/// JSON's own nesting, looked at before anything is built of it.
bool too_deep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (in_string) {
      if (letter == '\\') ++i;
      if (letter == '"') in_string = false;
      continue;
    }
    if (letter == '"') in_string = true;
    if (letter == '{' || letter == '[') ++depth;
    if (letter == '}' || letter == ']') --depth;
    if (depth > k_most_depth) return true;
  }
  return false;
}

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

tl::unexpected<Error> wrong(const char* field, const char* expected) {
  return fail(Errc::ProtocolError, "control message: %s: %s expected", field, expected);
}

/// A short text without anything that a terminal or a page would act on.
Result<std::string> short_text(const Json& json, const char* field, std::size_t most_bytes) {
  const auto found = json.find(field);
  if (found == json.end() || found->is_null()) return std::string{};
  if (!found->is_string()) return wrong(field, "a text");
  auto text = found->get<std::string>();
  if (text.size() > most_bytes || text != clean_text(text)) return wrong(field, "a short printable text");
  return text;
}

Result<std::uint64_t> number(const Json& json, const char* field) {
  const auto found = json.find(field);
  if (found == json.end() || !found->is_number_unsigned()) return wrong(field, "a number from 0");
  return found->get<std::uint64_t>();
}

Result<std::map<std::string, std::string>> query_of(const Json& json) {
  std::map<std::string, std::string> query;
  const auto found = json.find("query");
  if (found == json.end() || found->is_null()) return query;
  if (!found->is_object() || found->size() > k_most_query_entries)
    return wrong("query", "an object of at most 32 texts");
  for (const auto& [name, value] : found->items()) {
    if (!value.is_string() || name.size() > k_most_name_bytes) return wrong("query", "an object of texts");
    auto text = value.get<std::string>();
    if (text.size() > k_most_path_bytes || text != clean_text(text))
      return wrong("query", "short printable texts");
    query.emplace(name, std::move(text));
  }
  return query;
}

Result<Request> request_of(Json& json) {
  Request request;
  BITELINE_ASSIGN(request.id, number(json, "id"));
  BITELINE_ASSIGN(request.token, short_text(json, "token", k_most_token_bytes));
  BITELINE_ASSIGN(request.door, short_text(json, "door", k_most_name_bytes));
  BITELINE_ASSIGN(request.method, short_text(json, "method", k_most_name_bytes));
  BITELINE_ASSIGN(request.path, short_text(json, "path", k_most_path_bytes));
  if (request.method.empty()) return wrong("method", "GET, POST, PUT, PATCH or DELETE");
  if (!request.path.starts_with('/')) return wrong("path", "a path from /");
  BITELINE_ASSIGN(request.query, query_of(json));
  if (const auto local = json.find("local"); local != json.end()) {
    if (!local->is_boolean()) return wrong("local", "true or false");
    request.local = local->get<bool>();
  }
  if (const auto body = json.find("body"); body != json.end()) request.body = std::move(*body);
  return request;
}

Result<Answer> answer_of(Json& json) {
  Answer answer;
  BITELINE_ASSIGN(answer.id, number(json, "id"));
  BITELINE_ASSIGN(const std::uint64_t status, number(json, "status"));
  if (status < 100 || status > 599) return wrong("status", "a status of HTTP");
  answer.status = static_cast<int>(status);
  BITELINE_ASSIGN(std::string type, short_text(json, "type", k_most_name_bytes));
  if (!type.empty()) answer.type = std::move(type);
  BITELINE_ASSIGN(answer.file, short_text(json, "file", k_most_path_bytes));
  if (const auto body = json.find("body"); body != json.end()) answer.body = std::move(*body);
  return answer;
}

Result<Event> event_of(Json& json) {
  Event event;
  BITELINE_ASSIGN(event.name, short_text(json, "event", k_most_name_bytes));
  BITELINE_ASSIGN(event.seq, number(json, "seq"));
  BITELINE_ASSIGN(event.time, short_text(json, "time", k_most_name_bytes));
  if (const auto data = json.find("data"); data != json.end()) event.data = std::move(*data);
  return event;
}

Result<Json> message_of(std::string_view text) {
  if (text.size() > k_most_message_bytes)
    return fail(Errc::ProtocolError, "control message of %zu bytes: at most %zu expected", text.size(),
                k_most_message_bytes);
  std::optional<Json> json = parse_bounded(text);
  if (!json || !json->is_object())
    return fail(Errc::ProtocolError, "control message: a JSON object expected");
  return std::move(*json);
}

}  // namespace

std::optional<Json> parse_bounded(std::string_view text) {
  if (text.empty()) return Json{};
  if (text.size() > k_most_message_bytes || too_deep(text)) return std::nullopt;
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

Answer refusal(int status, const std::string& code, const std::string& message) {
  return {.id = 0,
          .status = status,
          .body = {{"error", {{"code", code}, {"message", message}}}},
          .type = Answer{}.type,
          .file = {}};
}

std::string to_text(const Request& request) {
  Json json{{"id", request.id},        {"token", request.token},   {"local", request.local},
            {"door", request.door},    {"method", request.method}, {"path", request.path},
            {"query", Json::object()}, {"body", request.body}};
  for (const auto& [name, value] : request.query) json["query"][name] = value;
  return dump(json);
}

std::string to_text(const Answer& answer) {
  Json json{{"id", answer.id}, {"status", answer.status}, {"body", answer.body}};
  if (answer.type != Answer{}.type) json["type"] = answer.type;
  if (!answer.file.empty()) json["file"] = answer.file;
  return dump(json);
}

std::string to_text(const Event& event) {
  return dump({{"event", event.name}, {"data", event.data}, {"seq", event.seq}, {"time", event.time}});
}

std::string to_text(const Hello& hello) {
  return dump({{"hello", hello.door}});
}

Result<std::variant<Request, Hello>> read_from_door(std::string_view text) {
  BITELINE_ASSIGN(Json json, message_of(text));
  if (json.contains("hello")) {
    BITELINE_ASSIGN(std::string door, short_text(json, "hello", k_most_name_bytes));
    return Hello{.door = std::move(door)};
  }
  return request_of(json);
}

std::uint64_t id_of_refused(std::string_view text) {
  // What is too long or too deep is not parsed for it.
  constexpr std::string_view k_begin = R"({"id":)";
  if (!text.starts_with(k_begin)) return 0;
  std::uint64_t id = 0;
  const char* const end = text.data() + text.size();
  const auto [at, fault] = std::from_chars(text.data() + k_begin.size(), end, id);
  return fault == std::errc{} && at != end && *at == ',' ? id : 0;
}

Result<std::variant<Answer, Event>> read_from_service(std::string_view text) {
  // What the service says may be longer than what it is told: a table of scans.
  std::optional<Json> json;
  if (Json parsed = Json::parse(text, nullptr, false); parsed.is_object()) json = std::move(parsed);
  if (!json) return fail(Errc::ProtocolError, "control message: a JSON object expected");
  // Not straight through: tl::expected 1.0 converts by building over a default value, whose text is lost.
  if (json->contains("event")) {
    BITELINE_ASSIGN(Event event, event_of(*json));
    return std::variant<Answer, Event>{std::move(event)};
  }
  BITELINE_ASSIGN(Answer answer, answer_of(*json));
  return std::variant<Answer, Event>{std::move(answer)};
}

std::string utc_now() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  const auto whole_s = std::chrono::floor<std::chrono::seconds>(since);
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(since - whole_s).count();
  const auto seconds = static_cast<std::time_t>(whole_s.count());
  std::tm parts{};
  std::array<char, 32> day{};
  std::strftime(day.data(), day.size(), "%Y-%m-%dT%H:%M:%S", gmtime_r(&seconds, &parts));
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%s.%03dZ", day.data(), static_cast<int>(ms));
  return text.data();
}

bool is_stop(const Request& request) {
  return request.method == "POST" && (request.path == k_stop_path || request.path == k_laser_off_path ||
                                      request.path == k_line_stop_path);
}

}  // namespace biteline::control
