// SPDX-License-Identifier: MIT
#include "host/records/batch/plan.hpp"

#include <utility>

#include "host/records/batch/json_fields.hpp"
#include "host/records/batch/parallel.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::batch {
namespace {

using nlohmann::ordered_json;

// A start and its files; then about what two busy cores gave a whole shoe's cloud (30 MB) and a session.
constexpr double k_start_s = 0.5, k_cloud_s_per_mb = 0.05, k_session_s_per_mb = 0.1, k_made_cloud_s = 3,
                 k_made_session_s = 120;

std::vector<std::vector<std::size_t>> cut(const std::vector<Recording>& recordings, double shard_s) {
  std::vector<std::vector<std::size_t>> shards;
  double filled_s = shard_s;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    if (filled_s >= shard_s) {
      shards.emplace_back();
      filled_s = 0;
    }
    shards.back().push_back(i);
    filled_s += estimated_s(recordings[i]);
  }
  return shards;
}

Result<Recording> recording_of(const ordered_json& json, const std::filesystem::path& file) {
  const JsonFields fields{json, file};
  Recording recording;
  BITELINE_ASSIGN(recording.name, fields.text("name"));
  BITELINE_ASSIGN(const std::string kind, fields.text("kind"));
  BITELINE_ASSIGN(recording.kind, recording_kind(kind));
  BITELINE_ASSIGN(recording.hash, fields.text("hash"));
  BITELINE_ASSIGN(const double bytes, fields.number("bytes"));
  recording.bytes = bytes > 0 ? static_cast<std::uint64_t>(bytes) : 0;
  if (!is_made(recording.kind)) {
    BITELINE_ASSIGN(const std::string path, fields.text("path"));
    recording.path = path;
    return recording;
  }
  BITELINE_ASSIGN(const ordered_json* const words, fields.array("recipe"));
  for (const ordered_json& word : *words) {
    if (!word.is_string())
      return fail(Errc::BadFormat, "%.180s key recipe: a list of texts expected", file.c_str());
    recording.recipe.push_back(word.get<std::string>());
  }
  return recording;
}

/// Every recording in exactly one shard.
Result<void> check_shards(const BatchPlan& plan, const std::filesystem::path& file) {
  std::vector<int> seen(plan.recordings.size(), 0);
  for (const auto& shard : plan.shards) {
    for (const std::size_t index : shard) {
      if (index >= seen.size() || seen[index]++ != 0)
        return fail(Errc::BadValue, "%.180s key shards: recording %zu twice or unknown", file.c_str(), index);
    }
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i] == 0)
      return fail(Errc::BadValue, "%.180s key shards: recording %zu is in none", file.c_str(), i);
  }
  return {};
}

}  // namespace

double estimated_s(const Recording& recording) {
  const double mb = 1e-6 * static_cast<double>(recording.bytes);
  switch (recording.kind) {
    case RecordingKind::Session:
      return k_start_s + k_session_s_per_mb * mb;
    case RecordingKind::Cloud:
      return k_start_s + k_cloud_s_per_mb * mb;
    case RecordingKind::MadeSession:
      return k_made_session_s;
    case RecordingKind::MadeCloud:
      return k_made_cloud_s;
  }
  return k_start_s;
}

Result<BatchPlan> make_plan(PlanRequest request) {
  BITELINE_TRY(for_each_index(request.recordings.size(), request.jobs, [&](std::size_t i) -> Result<void> {
    Recording& recording = request.recordings[i];
    if (!recording.hash.empty()) return {};
    BITELINE_ASSIGN(const Fingerprint print, fingerprint(recording.kind, recording.path));
    recording.hash = print.hash;
    recording.bytes = print.bytes;
    return {};
  }));
  BatchPlan plan{
      .settings = std::move(request.settings), .recordings = std::move(request.recordings), .shards = {}};
  plan.shards = cut(plan.recordings, request.shard_s);
  return plan;
}

Result<void> write_plan(const std::filesystem::path& folder, const BatchPlan& plan) {
  BITELINE_TRY(report::prepare_folder(folder));
  ordered_json recordings = ordered_json::array();
  for (const Recording& recording : plan.recordings) {
    ordered_json row{{"name", recording.name}, {"kind", name_of(recording.kind)}};
    if (is_made(recording.kind)) {
      row["recipe"] = recording.recipe;
    } else {
      row["path"] = recording.path.string();
    }
    row["hash"] = recording.hash;
    row["bytes"] = recording.bytes;
    recordings.push_back(std::move(row));
  }
  const ordered_json json{{"schema_version", 1},
                          {"settings", {{"method", plan.settings.method}, {"unit", plan.settings.unit}}},
                          {"shards", plan.shards},
                          {"recordings", std::move(recordings)}};
  return write_shared_file(folder / k_plan_file, report::to_text(json, 1) + "\n");
}

Result<BatchPlan> read_plan(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / k_plan_file;
  BITELINE_ASSIGN(const ordered_json json, read_json_object(file));
  const JsonFields fields{json, file};
  BatchPlan plan;
  BITELINE_ASSIGN(const ordered_json* const settings, fields.object("settings"));
  const JsonFields setting{*settings, file};
  BITELINE_ASSIGN(plan.settings.method, setting.text("method"));
  BITELINE_ASSIGN(plan.settings.unit, setting.text("unit"));
  BITELINE_ASSIGN(const ordered_json* const recordings, fields.array("recordings"));
  for (const ordered_json& row : *recordings) {
    BITELINE_ASSIGN(Recording recording, recording_of(row, file));
    plan.recordings.push_back(std::move(recording));
  }
  BITELINE_ASSIGN(const ordered_json* const shards, fields.array("shards"));
  for (const ordered_json& shard : *shards) {
    auto& indices = plan.shards.emplace_back();
    for (const ordered_json& index : shard) {
      if (!index.is_number_unsigned())
        return fail(Errc::BadFormat, "%.180s key shards: lists of indices expected", file.c_str());
      indices.push_back(index.get<std::size_t>());
    }
  }
  BITELINE_TRY(check_shards(plan, file));
  return plan;
}

std::string settings_text(const BatchSettings& settings) {
  return "method=" + settings.method + " unit=" + (settings.unit.empty() ? "file" : settings.unit);
}

}  // namespace biteline::batch
