// SPDX-License-Identifier: MIT
#include "host/interfaces/line_control/line_state.hpp"

#include <algorithm>
#include <cmath>

#include "host/interfaces/line_control/part_number.hpp"

namespace biteline::line_control {
namespace {

using control::Json;

constexpr std::array k_refusal_words{
    "taken",
    "no job of that number, or its model or process is gone",
    "no job is chosen",
    "a scan is in work",
    "a scan waits for a person",
    "somebody at a page holds control",
    "the cell was stopped; a person starts it again",
    "the sensor is away",
    "biteline-host does not answer",
    "biteline-host runs without --jobs",
    "a whole number in range expected",
};

constexpr std::array<ValueRow, k_values> k_rows{{
    {"map", "version of this table: 1"},
    {"heartbeat", "counts each second while the service answers"},
    {"step", "0 away, 1 ready, 2 scanning, 3 working, 4 deciding, 5 following, 6 stopped, 7 fault"},
    {"ready", "1: a start would be taken, if nobody at a page holds control"},
    {"busy", "1: from a start until its verdict"},
    {"done", "1: the last scan has its verdict; 0 from the next start on"},
    {"taken", "request number of the last start that was taken"},
    {"finished", "request number of the start whose scan is done"},
    {"verdict",
     "0 none, 1 ok, 2 ok with weak stretches, 3 refused, 4 failed, 5 a person must settle the line"},
    {"job", "the job that is chosen; 0: none"},
    {"model", "the job whose model the scan was worked with; 0: no job has it"},
    {"sent", "1: a path was sent to the arm"},
    {"followed", "1: the arm followed it to its end"},
    {"refusal", "of this door's last command; 0: it was taken"},
    {"scan", "number of the last scan's folder"},
    {"starts", "starts since the service began"},
    {"ok", "verdicts since then, also the next three"},
    {"amber", "ok with weak stretches"},
    {"refused", "refused scans"},
    {"failed", "scans that came to nothing"},
    {"length_mm", "length of the line [mm]"},
    {"u95_um", "the line's largest U95 [0.001 mm]; 65535: above, or not known"},
    {"confidence", "of the line, in thousandths"},
    {"review", "lines that a person must settle; since the service began"},
}};

/// A whole number from `least` to `most`, else nothing.
std::optional<std::int64_t> whole(const Json& json, const char* key, std::int64_t least, std::int64_t most) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number_integer()) return std::nullopt;
  const auto number = found->get<std::int64_t>();
  if (number < least || number > most) return std::nullopt;
  return number;
}

std::optional<double> number_of(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

Json or_null(const std::optional<double>& number) {
  return number ? Json(*number) : Json{};
}

std::uint16_t scaled(const std::optional<double>& number, double scale, std::uint16_t unknown) {
  if (!number || !std::isfinite(*number)) return unknown;
  return static_cast<std::uint16_t>(std::clamp(std::round(*number * scale), 0.0, 65535.0));
}

std::uint16_t wrapped(std::int64_t number) {
  return static_cast<std::uint16_t>(number & 0xFFFF);
}

}  // namespace

const char* words_of(Refusal refusal) {
  return k_refusal_words.at(static_cast<std::size_t>(refusal));
}

Json to_json(const LineState& state) {
  return {{"step", static_cast<int>(state.step)},
          {"busy", state.busy},
          {"done", state.done},
          {"job", state.job},
          {"taken", state.taken},
          {"finished", state.finished},
          {"verdict", static_cast<int>(state.verdict)},
          {"model", state.model},
          {"sent", state.sent},
          {"followed", state.followed},
          {"scan", state.scan},
          {"length_mm", or_null(state.length_mm)},
          {"u95_mm", or_null(state.u95_mm)},
          {"confidence", or_null(state.confidence)},
          {"starts", state.counts.starts},
          {"ok", state.counts.ok},
          {"amber", state.counts.amber},
          {"refused", state.counts.refused},
          {"failed", state.counts.failed},
          {"review", state.counts.review},
          {"part", state.part},
          {"next_part", state.next_part}};
}

std::optional<LineState> line_state_of(const Json& json) {
  if (!json.is_object()) return std::nullopt;
  bool sound = true;
  const auto number = [&](const char* key, std::int64_t most) {
    const std::optional<std::int64_t> found = whole(json, key, 0, most);
    sound = sound && found;
    return found.value_or(0);
  };
  const auto truth = [&](const char* key) {
    const auto found = json.find(key);
    const bool is = found != json.end() && found->is_boolean();
    sound = sound && is;
    return is && found->get<bool>();
  };
  constexpr std::int64_t k_request = 65535;
  constexpr std::int64_t k_count = 0xFFFFFFFF;
  LineState state;
  state.step = static_cast<Step>(number("step", 7));
  state.busy = truth("busy");
  state.done = truth("done");
  state.job = static_cast<int>(number("job", k_request));
  state.taken = static_cast<int>(number("taken", k_request));
  state.finished = static_cast<int>(number("finished", k_request));
  state.verdict = static_cast<Verdict>(number("verdict", 5));
  state.model = static_cast<int>(number("model", k_request));
  state.sent = truth("sent");
  state.followed = truth("followed");
  state.scan = static_cast<int>(number("scan", 999'999'999));
  state.length_mm = number_of(json, "length_mm");
  state.u95_mm = number_of(json, "u95_mm");
  state.confidence = number_of(json, "confidence");
  for (const auto& [key, count] :
       {std::pair{"starts", &state.counts.starts}, std::pair{"ok", &state.counts.ok},
        std::pair{"amber", &state.counts.amber}, std::pair{"refused", &state.counts.refused},
        std::pair{"failed", &state.counts.failed}, std::pair{"review", &state.counts.review}}) {
    *count = static_cast<std::uint32_t>(number(key, k_count));
  }
  for (const auto& [key, part] : {std::pair{"part", &state.part}, std::pair{"next_part", &state.next_part}}) {
    const auto found = json.find(key);
    const bool is_text = found != json.end() && found->is_string();
    const std::optional<std::string> read = is_text ? part_number(found->get<std::string>()) : std::nullopt;
    sound = sound && read;
    *part = read.value_or("");
  }
  if (!sound) return std::nullopt;
  return state;
}

std::span<const ValueRow, k_values> value_rows() {
  return k_rows;
}

std::array<std::uint16_t, k_values> values_of(const LineState& state, std::uint16_t heartbeat,
                                              Refusal refusal) {
  const auto bit = [](bool truth) { return std::uint16_t{truth}; };
  return {k_map_version,
          heartbeat,
          wrapped(static_cast<int>(state.step)),
          bit(state.step == Step::Ready),
          bit(state.busy),
          bit(state.done),
          wrapped(state.taken),
          wrapped(state.finished),
          wrapped(static_cast<int>(state.verdict)),
          wrapped(state.job),
          wrapped(state.model),
          bit(state.sent),
          bit(state.followed),
          wrapped(static_cast<int>(refusal)),
          wrapped(state.scan),
          wrapped(state.counts.starts),
          wrapped(state.counts.ok),
          wrapped(state.counts.amber),
          wrapped(state.counts.refused),
          wrapped(state.counts.failed),
          scaled(state.length_mm, 1, 0),
          scaled(state.u95_mm, 1000, 65535),
          scaled(state.confidence, 1000, 0),
          wrapped(state.counts.review)};
}

}  // namespace biteline::line_control
