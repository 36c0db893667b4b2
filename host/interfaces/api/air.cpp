// SPDX-License-Identifier: MIT
#include "host/interfaces/api/air.hpp"

#include <algorithm>

#include "host/interfaces/api/json_file.hpp"

namespace biteline::api {
namespace {

using control::Json;

Json told(const char* state, const Json& reason) {
  Json json{{"state", state}, {"reason_code", nullptr}, {"reason", nullptr}, {"next_step", nullptr}};
  for (const char* key : {"reason_code", "reason", "next_step"}) {
    if (reason.is_object() && reason.contains(key) && reason[key].is_string()) json[key] = reason[key];
  }
  return json;
}

/// The gate's first row that failed.
Json refused_by(const Json& gate) {
  const auto rows = gate.find("rows");
  if (rows == gate.end() || !rows->is_array()) return {};
  const auto failed = std::ranges::find_if(
      *rows, [](const Json& row) { return row.is_object() && row.value("state", "") == "failed"; });
  if (failed == rows->end()) return {};
  return {{"reason_code", failed->value("reason_code", "")},
          {"reason", "not sent: " + failed->value("name", "") + ": " + failed->value("value", "") + " (" +
                         failed->value("limit", "") + ")"},
          {"next_step", failed->value("next_step", "")}};
}

}  // namespace

Json air_json(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return {};
  if (const Json followed = file_json(folder / "followed.json"); followed.is_object()) {
    const auto stopped = followed.find("stopped");
    if (stopped != followed.end() && stopped->is_object()) return told("stopped", *stopped);
    const bool whole = followed.contains("completed") && followed["completed"] == true;
    Json json = told(whole ? "followed" : "stopped", {});
    if (followed.contains("duration_s")) json["duration_s"] = followed["duration_s"];
    return json;
  }
  // It ended before the arm moved: no controller, or a stop.
  if (const Json ended = file_json(folder / "report.json"); ended.is_object() && ended.contains("reason"))
    return told("refused", ended);
  const Json gate = file_json(folder / "gate.json");
  if (gate.is_object() && gate.contains("permitted") && gate["permitted"] == false)
    return told("refused", refused_by(gate));
  const Json report = file_json(folder / "path" / "report.json");
  if (report.is_object() && report.contains("reason")) return told("refused", report);
  // Planned or on its way; or of a service that ended meanwhile.
  return told("begun", {});
}

}  // namespace biteline::api
