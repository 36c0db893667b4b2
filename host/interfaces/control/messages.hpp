// SPDX-License-Identifier: MIT
#pragma once
/// \file What goes over the service's control end: requests, answers and events, one JSON text each.

#include <chrono>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "common/core/result.hpp"
#include "common/wire/messages.hpp"

namespace biteline::control {

using Json = nlohmann::ordered_json;

/// Nobody's hand-made message is longer; files go by name, never through here.
inline constexpr std::size_t k_most_message_bytes = wire::k_max_message_bytes;
inline constexpr const char* k_stop_path = "/api/v1/commands/stop";
inline constexpr const char* k_laser_off_path = "/api/v1/commands/laser-off";
inline constexpr const char* k_line_stop_path = "/api/v1/line/stop";
/// Objects and lists within each other.
inline constexpr int k_most_depth = 24;

/// What a door (page, PLC, tool) asks for somebody.
struct Request {
  std::uint64_t id{0};  ///< the door's own; comes back with the answer
  std::string token;    ///< of the person's session; empty: nobody is logged in
  bool local{false};    ///< asked on the cell's own machine, as the door sees it
  std::string door;     ///< "web", "modbus", "text", ...
  std::string method;   ///< GET, POST, PUT, PATCH, DELETE
  std::string path;     ///< "/api/v1/scans/scan-0003/accept"
  std::map<std::string, std::string> query;
  Json body;  ///< null: none
  /// When the service heard it: what is answered much later is told by this.  Not sent.
  std::chrono::steady_clock::time_point heard{std::chrono::steady_clock::now()};
  /// How many stops the service had counted then: what waited past a stop is over.  Not sent.
  std::uint64_t stops{0};
};

/// Stop, Laser off and the stop of the line's control: what never waits behind anything, at no end.
[[nodiscard]] bool is_stop(const Request& request);

struct Answer {
  std::uint64_t id{0};
  int status{200};  ///< of HTTP (RFC 9110)
  Json body;        ///< null: none (204); a text where `type` is no JSON's
  std::string type{"application/json"};
  /// Below the results folder: the file that is the answer.  The door reads it at once; it stays for a while.
  std::string file{};
};

/// Something has happened.  `seq` counts every event of the service: a gap means that some were dropped for
/// this door, which then reads the state again.
struct Event {
  std::string name;  ///< hello, state, scan, log, control, model, health
  Json data;
  std::uint64_t seq{0};
  std::string time;  ///< UTC, ISO 8601
};

/// A door's word that it lives, each second; the first one brings a `hello` event.
struct Hello {
  std::string door;
};

/// An answer whose body says what, where and what next: {"error": {"code": ..., "message": ...}}.
[[nodiscard]] Answer refusal(int status, const std::string& code, const std::string& message);

[[nodiscard]] std::string to_text(const Request& request);
[[nodiscard]] std::string to_text(const Answer& answer);
[[nodiscard]] std::string to_text(const Event& event);
[[nodiscard]] std::string to_text(const Hello& hello);

/// What a door may send.  Errc::ProtocolError, naming the field, for anything else: too long, too deep, no
/// JSON, another type, control characters in a name.
[[nodiscard]] Result<std::variant<Request, Hello>> read_from_door(std::string_view text);
/// The id of a request that read_from_door() refuses, so that its door hears of it; 0 where it does not begin
/// as to_text() writes it.
[[nodiscard]] std::uint64_t id_of_refused(std::string_view text);
/// What the service may send.
[[nodiscard]] Result<std::variant<Answer, Event>> read_from_service(std::string_view text);

/// Strict JSON within the two bounds above; null when it is not.  `text` itself may be empty (null, too).
[[nodiscard]] std::optional<Json> parse_bounded(std::string_view text);

/// Now, UTC: "2026-11-20T21:04:05.123Z".
[[nodiscard]] std::string utc_now();

}  // namespace biteline::control
