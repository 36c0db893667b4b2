// SPDX-License-Identifier: MIT
#include "host/bite_line/edit/versions.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/core/fixed_text.hpp"
#include "common/core/text.hpp"
#include "common/system/file.hpp"
#include "host/records/digest/digest.hpp"
#include "host/report/file_lock.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::edit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* k_folder = "lines";
constexpr const char* k_list = "versions.json";
constexpr std::size_t k_longest_text = 500;
constexpr std::array k_kinds{"candidate", "through", "cut", "back_to"};

Json to_json(const Step& step) {
  Json json{{"step", k_kinds.at(static_cast<std::size_t>(step.kind))}};
  if (step.kind == Step::Kind::Candidate) json["candidate"] = step.candidate;
  if (step.kind == Step::Kind::BackTo) json["line_version"] = step.line_version;
  const bool part = step.stretch.from_mm != 0 || step.stretch.to_mm != 0;
  if (step.kind == Step::Kind::Through || step.kind == Step::Kind::Cut ||
      (step.kind == Step::Kind::Candidate && part)) {
    json["from_mm"] = step.stretch.from_mm;
    json["to_mm"] = step.stretch.to_mm;
  }
  for (const Vec3& point : step.points) json["points"].push_back({point.x(), point.y(), point.z()});
  return json;
}

Json to_json(const Version& version) {
  Json json{{"version", version.version}, {"time", version.time}, {"who", version.who}, {"why", version.why}};
  if (version.version > 0) {
    json["mended"] = version.mended;
    json["steps"] = Json::array();
    for (const Step& step : version.steps) json["steps"].push_back(to_json(step));
  }
  json["file"] = line_file(version.version).string();
  if (!version.sha256.empty()) json["sha256"] = version.sha256;
  return json;
}

Step step_of(const Json& json) {
  Step step;
  const std::string kind = json.at("step").get<std::string>();
  for (std::size_t i = 0; i < k_kinds.size(); ++i) {
    if (kind == k_kinds.at(i)) step.kind = static_cast<Step::Kind>(i);
  }
  step.candidate = json.value("candidate", 0);
  step.line_version = json.value("line_version", 0);
  step.stretch = {.from_mm = json.value("from_mm", 0.0), .to_mm = json.value("to_mm", 0.0)};
  for (const Json& point : json.value("points", Json::array()))
    step.points.emplace_back(point.at(0).get<double>(), point.at(1).get<double>(), point.at(2).get<double>());
  return step;
}

Version version_of(const Json& json) {
  Version version{.version = json.at("version").get<int>(),
                  .time = clean_text(json.at("time").get<std::string>(), 40),
                  .who = clean_text(json.at("who").get<std::string>(), 100),
                  .why = clean_text(json.value("why", ""), k_longest_text),
                  .mended = json.value("mended", 0),
                  .steps = {},
                  .sha256 = clean_text(json.value("sha256", ""), 64)};
  for (const Json& step : json.value("steps", Json::array())) version.steps.push_back(step_of(step));
  return version;
}

/// As it was found, once and for ever.
Result<void> keep_found(const fs::path& scan) {
  for (const auto& [from, to] :
       {std::pair{fs::path{"line.csv"}, line_file(0)}, std::pair{fs::path{"report.json"}, found_report()}}) {
    std::error_code error;
    if (!fs::exists(scan / from, error)) continue;
    BITELINE_ASSIGN(const std::string text, read_regular_file(scan / from, k_most_settings_bytes));
    BITELINE_TRY(report::write_file_atomically(scan / to, text));
  }
  return {};
}

}  // namespace

fs::path line_file(int version) {
  return fs::path{k_folder} / ("line-" + std::to_string(version) + ".csv");
}

fs::path found_report() {
  return fs::path{k_folder} / "found.json";
}

Result<std::vector<Version>> read_versions(const fs::path& scan) {
  const fs::path file = scan / k_folder / k_list;
  std::error_code error;
  if (!fs::exists(file, error))
    return std::vector{Version{.version = 0, .time = {}, .who = "found", .why = {}, .steps = {}}};
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_settings_bytes));
  // nlohmann reports by exceptions: caught here, at the one call.
  try {
    const Json json = Json::parse(text);
    std::vector<Version> versions;
    for (const Json& row : json.at("versions")) versions.push_back(version_of(row));
    for (std::size_t i = 0; i < versions.size(); ++i) {
      if (versions[i].version != static_cast<int>(i))
        return fail(Errc::BadValue, "%.180s: version %zu expected, found %d", file.c_str(), i,
                    versions[i].version);
    }
    if (versions.empty()) return fail(Errc::BadFormat, "%.180s: no version", file.c_str());
    return versions;
  } catch (const Json::exception& fault) {
    return fail(Errc::BadFormat, "%.180s: %.120s", file.c_str(), fault.what());
  }
}

Result<cloud::ClosedLine> read_version(const fs::path& scan, int version) {
  std::error_code error;
  // Nobody has mended yet.
  if (version == 0 && !fs::exists(scan / k_folder / k_list, error))
    return cloud::read_line(scan / "line.csv");
  BITELINE_ASSIGN(const std::vector<Version> versions, read_versions(scan));
  const fs::path file = scan / line_file(version);
  if (version >= 0 && static_cast<std::size_t>(version) < versions.size()) {
    const std::string& written = versions[static_cast<std::size_t>(version)].sha256;
    if (!written.empty() && fs::exists(file, error)) {
      BITELINE_ASSIGN(const std::string now, digest_of_file(file));
      if (now != written)
        return fail(Errc::BadValue, "%.180s: it was changed since it was written; scan the shoe again",
                    file.c_str());
    }
  }
  return cloud::read_line(file);
}

Result<int> save_version(const fs::path& scan, const Version& made, const cloud::ClosedLine& line) {
  BITELINE_TRY(report::prepare_folder(scan / k_folder));
  BITELINE_ASSIGN(const report::FileLock lock,
                  report::FileLock::take(scan / k_folder / ".lock", "a mend of " + scan.filename().string()));
  BITELINE_ASSIGN(std::vector<Version> versions, read_versions(scan));
  if (versions.size() == 1 && versions.front().time.empty()) {
    BITELINE_TRY(keep_found(scan));
    versions.front().time = made.time;
    if (const Result<std::string> sha256 = digest_of_file(scan / line_file(0)))
      versions.front().sha256 = *sha256;
  }
  if (made.mended != versions.back().version) {
    return fail(Errc::WrongState, "version %d was mended, and the newest is %d: look at that one first",
                made.mended, versions.back().version);
  }
  Version next = made;
  next.version = versions.back().version + 1;
  BITELINE_TRY(cloud::write_line(scan / line_file(next.version), line));
  BITELINE_ASSIGN(next.sha256, digest_of_file(scan / line_file(next.version)));
  versions.push_back(next);
  Json list = Json::array();
  for (const Version& version : versions) list.push_back(to_json(version));
  BITELINE_TRY(report::write_file_atomically(scan / k_folder / k_list,
                                             report::to_text(Json{{"versions", list}}) + "\n"));
  return next.version;
}

std::string words_of(const Step& step) {
  using Text = FixedText<120>;
  switch (step.kind) {
    case Step::Kind::Candidate:
      if (step.stretch.from_mm == 0 && step.stretch.to_mm == 0)
        return Text::format("candidate %d", step.candidate).c_str();
      return Text::format("candidate %d from %.1f to %.1f mm", step.candidate, step.stretch.from_mm,
                          step.stretch.to_mm)
          .c_str();
    case Step::Kind::Through:
      return Text::format("through %zu points from %.1f to %.1f mm", step.points.size(), step.stretch.from_mm,
                          step.stretch.to_mm)
          .c_str();
    case Step::Kind::Cut:
      return Text::format("cut from %.1f to %.1f mm", step.stretch.from_mm, step.stretch.to_mm).c_str();
    case Step::Kind::BackTo:
      return Text::format("back to version %d", step.line_version).c_str();
  }
  return {};
}

}  // namespace biteline::edit
