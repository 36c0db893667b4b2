// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/calibration_check.hpp"

#include <tbb/task_arena.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "common/system/file.hpp"
#include "host/apps/biteline-host/refused.hpp"
#include "host/apps/biteline-host/scan_pipeline.hpp"
#include "host/calibration/drift/watch.hpp"
#include "host/intake/scan_cause.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* k_setting = "calibration_check";

memory::LogRow event(const std::string& who, const std::string& action, const std::string& subject,
                     const std::string& after) {
  return {.id = 0,
          .time = memory::now_ms(),
          .who = who,
          .door = {},
          .action = action,
          .subject = subject,
          .before = {},
          .after = after};
}

/// A calibration by its figures: other figures are another calibration.
std::string identity_of(const geometry::SensorModel& head) {
  const geometry::Camera& c = head.camera;
  const auto& T = head.T_flange_cam.matrix();
  std::string text;
  for (const double value : {c.fu_px,
                             c.fv_px,
                             c.cu_px,
                             c.cv_px,
                             c.k1,
                             c.k2,
                             c.p1,
                             c.p2,
                             c.k3,
                             head.laser_plane.normal_cam.x(),
                             head.laser_plane.normal_cam.y(),
                             head.laser_plane.normal_cam.z(),
                             head.laser_plane.distance_mm,
                             T(0, 0),
                             T(0, 1),
                             T(0, 2),
                             T(1, 0),
                             T(1, 1),
                             T(1, 2),
                             T(0, 3),
                             T(1, 3),
                             T(2, 3),
                             static_cast<double>(head.pose_clock_offset.count())})
    text += FixedText<32>::format("%.9g ", value).view();
  return text;
}

/// The memory's watch of this calibration, or a new one.  Not where the memory cannot be read: a drift that
/// was told would be forgotten.
Result<drift::Watch> watch_of(const memory::Memory& memory, const std::string& head) {
  BITELINE_ASSIGN(const std::optional<std::string> kept, memory.setting(k_setting));
  if (!kept) return drift::Watch{};
  const nlohmann::json json = nlohmann::json::parse(*kept, nullptr, false);
  const auto is_text = [&](const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_string();
  };
  if (!is_text("head") || !is_text("watch") || json["head"].get<std::string>() != head) return drift::Watch{};
  Result<drift::Watch> watch = drift::Watch::from_text(json["watch"].get<std::string>());
  if (watch) return watch;
  log_step("%s", to_line(watch.error()).c_str());
  return drift::Watch{};
}

Json quantities_json(const drift::Watch& watch, const drift::Evidence& evidence, const std::string& model) {
  Json rows = Json::array();
  const drift::Sums seen = watch.seen(evidence, model);
  const drift::Vector alone = seen.alone(), sigma = seen.alone_sigma();
  for (int i = 0; i < drift::k_quantities; ++i) {
    const drift::Quantity& quantity = drift::k_table.at(static_cast<std::size_t>(i));
    const drift::SelfStarting& row = watch.row(i);
    Json json{{"name", quantity.name},
              {"part", drift::k_part_names.at(static_cast<std::size_t>(quantity.part))},
              {"unit", quantity.unit},
              {"fault", quantity.size}};
    if (std::isfinite(sigma[i])) {
      json["alone"] = alone[i] * quantity.size;
      json["sigma"] = sigma[i] * quantity.size;
    }
    if (row.knows()) {
      json["usual"] = row.mean() * quantity.size;
      json["scatter"] = row.sigma() * quantity.size;
      json["cusum"] = row.sum();
    }
    rows.push_back(std::move(json));
  }
  return rows;
}

Json json_of(const drift::Watch& watch, const Result<drift::Evidence>& evidence, OnDrift on_drift,
             const std::string& model) {
  const drift::Verdict& verdict = watch.verdict();
  Json json{{"status", drift::to_string(verdict.status)},
            {"words", verdict.words},
            {"shoes", verdict.shoes},
            {"on_drift", on_drift == OnDrift::Stop ? "stop" : "warn"}};
  if (verdict.named) {
    Json parts = Json::object();
    for (std::size_t p = 0; p < drift::k_parts; ++p)
      parts[std::string(drift::k_part_names.at(p))] = verdict.named->probability.at(p);
    json["parts"] = parts;
    json["for_shoes"] = verdict.for_shoes;
    const report::ToldRefusal told =
        report::told(Refusal{.code = Refused::CalibrationDrifted, .reason = verdict.words});
    json["reason_code"] = told.reason_code;
    json["next_step"] = told.next_step;
  }
  if (!evidence) {
    json["not_seen_because"] = to_line(evidence.error());
    return json;
  }
  const drift::Blind blind = drift::blind_of(*evidence);
  json["places"] = evidence->pairs;
  json["table_profiles"] = evidence->table ? evidence->table->profiles : 0;
  json["apart_mm"] = evidence->before_mm;
  json["apart_after_mm"] = evidence->after_mm;
  json["limit"] = drift::SelfStarting::k_limit;
  json["cannot_see"] = blind.unseen;
  json["cannot_tell_apart"] = blind.mistaken;
  json["quantities"] = quantities_json(watch, *evidence, model);
  return json;
}

}  // namespace

Result<drift::Evidence> look_at_calibration(const intake::ScanOutcome& scan) {
  std::vector<drift::PosedProfile> poses;
  for (const intake::TakenFrom& taken : scan.poses)
    poses.push_back({.profile = taken.profile, .pose = taken.pose});
  // The arm may be followed meanwhile.
  tbb::task_arena one_core{1};
  Result<drift::Evidence> evidence = one_core.execute([&] {
    return drift::look_at({.points_base = scan.cloud.points, .profile = scan.cloud.profile, .poses = poses},
                          scan.sensor.model);
  });
  if (evidence) return evidence;
  const auto cause = intake::scan_cause(scan.counts, scan.sensor_counters, &scan.sensor_devices);
  if (!cause) return evidence;
  return fail(evidence.error().code, "calibration check: %s", cause->reason.c_str());
}

Result<bool> check_calibration(const fs::path& folder, const Result<drift::Evidence>& evidence,
                               const geometry::SensorModel& sensor, memory::Memory& memory, OnDrift on_drift,
                               const std::string& model) {
  const Result<std::string> text = read_regular_file(folder / "report.json", k_most_settings_bytes);
  Json report = text ? Json::parse(*text, nullptr, false) : Json{};
  if (!report.is_object()) return false;
  const std::string head = identity_of(sensor);
  BITELINE_ASSIGN(drift::Watch watch, watch_of(memory, head));
  const std::string name = folder.filename().string();
  if (evidence) {
    watch.take(name, *evidence, model);
  } else {
    watch.pass(name);
  }
  const drift::Verdict& verdict = watch.verdict();
  const bool drifted = verdict.status == drift::Status::Drifted;
  const Result<void> kept = [&]() -> Result<void> {
    // A scan that shows nothing leaves nothing to keep.
    if (evidence) {
      const std::string kept_text = nlohmann::json{{"head", head}, {"watch", watch.to_text()}}.dump();
      BITELINE_TRY(memory.put_setting(
          k_setting, kept_text,
          event("service", "calibration check", name, std::string(drift::to_string(verdict.status)))));
    }
    report["calibration_check"] = json_of(watch, evidence, on_drift, model);
    return report::write_file_atomically(folder / "report.json", report::to_text(report) + "\n");
  }();
  if (drifted) log_step("the calibration has drifted: %s", verdict.words.c_str());
  // What cannot be kept or written makes no drift unknown.
  if (!kept && !drifted) return tl::unexpected<Error>{kept.error()};
  if (!kept) log_step("%s", to_line(kept.error()).c_str());
  return drifted;
}

Result<void> begin_calibration_check_anew(memory::Memory& memory, const std::string& who) {
  return memory.put_setting(k_setting, "{}", event(who, "calibration check", "begun anew", {}));
}

}  // namespace biteline::service
