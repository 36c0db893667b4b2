// SPDX-License-Identifier: MIT
#include "host/records/look/rework_files.hpp"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/records/batch/json_fields.hpp"
#include "host/records/digest/digest.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::look {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using second_look::Fault;
using second_look::FaultKind;

constexpr const char* k_record = "rework.json";

/// Numbers and words of one object of a file; the first fault counts.
class Fields {
 public:
  Fields(const ordered_json& json, const fs::path& file) : json_{json}, file_{file} {}

  double number(const char* key) {
    const auto at = json_.find(key);
    if (at != json_.end() && at->is_number() && std::isfinite(at->get<double>())) return at->get<double>();
    miss(key);
    return 0;
  }
  std::string text(const char* key) {
    const auto at = json_.find(key);
    if (at != json_.end() && at->is_string()) return at->get<std::string>();
    miss(key);
    return {};
  }
  [[nodiscard]] Result<void> finish() const {
    if (missing_.empty()) return {};
    return fail(Errc::BadFormat, "%s: '%s' expected, as 'biteline inspect' writes it", file_.c_str(),
                missing_.c_str());
  }

 private:
  void miss(const char* key) {
    if (missing_.empty()) missing_ = key;
  }
  const ordered_json& json_;
  const fs::path& file_;
  std::string missing_;
};

Result<FaultKind> kind_of(const std::string& name, const fs::path& file) {
  for (const FaultKind kind :
       {FaultKind::Missing, FaultKind::Narrow, FaultKind::Wide, FaultKind::Beside, FaultKind::Doubled})
    if (name == second_look::name_of(kind)) return kind;
  return fail(Errc::BadValue, "%s: no kind of a fault: %s", file.c_str(), name.c_str());
}

Result<Fault> fault_of(const ordered_json& json, const fs::path& file) {
  Fields fields{json, file};
  Fault fault{.along = {.from_mm = fields.number("from_mm"), .to_mm = fields.number("to_mm")},
              .within = {.from_mm = fields.number("within_from_mm"), .to_mm = fields.number("within_to_mm")},
              .low_mm = fields.number("low_mm"),
              .high_mm = fields.number("high_mm")};
  const std::string kind = fields.text("kind");
  BITELINE_TRY(fields.finish());
  BITELINE_ASSIGN(fault.kind, kind_of(kind, file));
  return fault;
}

Result<ordered_json> read_record(const fs::path& file) {
  BITELINE_ASSIGN(ordered_json record, batch::read_json_object(file));
  if (!record.contains("reworks") || !record["reworks"].is_array())
    return fail(Errc::BadFormat, "%s: 'reworks' expected", file.c_str());
  return record;
}

/// Fails where the file is there.
Result<void> create(const fs::path& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> made{std::fopen(file.c_str(), "wx"), &std::fclose};
  if (made) return {};
  return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
}

}  // namespace

Result<LookRead> read_look(const fs::path& folder) {
  const fs::path file = folder / "report.json";
  BITELINE_ASSIGN(const ordered_json report, batch::read_json_object(file));
  LookRead look;
  BITELINE_ASSIGN(look.sha256, digest_of_file(file));
  Fields fields{report, file};
  look.refused = fields.text("status") == "refused";
  look.line_sha256 = fields.text("line_sha256");
  look.process_sha256 = fields.text("process_sha256");
  look.foot = fields.text("foot");
  BITELINE_TRY(fields.finish());
  const ordered_json work = report.value("work", ordered_json::object());
  Fields planned{work, file};
  look.plan.low_mm = planned.number("planned_low_mm");
  look.plan.high_mm = planned.number("planned_high_mm");
  look.line_mm = planned.number("line_mm");
  BITELINE_TRY(planned.finish());
  for (const ordered_json& json : work.value("faults", ordered_json::array())) {
    BITELINE_ASSIGN(Fault fault, fault_of(json, file));
    look.faults.push_back(fault);
  }
  return look;
}

Result<std::size_t> reworks_of(const fs::path& first) {
  const fs::path file = first / k_record;
  if (!fs::exists(file)) return 0;
  BITELINE_ASSIGN(const ordered_json record, read_record(file));
  return record["reworks"].size();
}

Result<void> record_rework(const fs::path& first, const ReworkRecord& rework) {
  const fs::path file = first / k_record;
  ordered_json record{{"reworks", ordered_json::array()}};
  if (fs::exists(file) && !rework.decided_by.empty()) {
    BITELINE_ASSIGN(record, read_record(file));
  } else {
    BITELINE_TRY(create(file));
  }
  record["reworks"].push_back(
      {{"look_sha256", rework.look_sha256}, {"pieces", rework.pieces}, {"decided_by", rework.decided_by}});
  return report::write_file_atomically(file, report::to_text(record));
}

}  // namespace biteline::look
