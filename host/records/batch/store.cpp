// SPDX-License-Identifier: MIT
#include "host/records/batch/store.hpp"

#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "common/system/file.hpp"
#include "host/records/batch/json_fields.hpp"
#include "host/records/digest/digest.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::batch {
namespace {

namespace fs = std::filesystem;

/// A folder beside the results, of this process alone.
Result<fs::path> make_beside(const fs::path& folder) {
  BITELINE_TRY(report::prepare_folder(folder));
  std::string pattern = (folder / "part-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) return fail_errno(Errc::WriteFailed, errno, "%s", folder.c_str());
  return fs::path{pattern};
}

}  // namespace

std::string result_key(const std::string& recording_hash, const std::string& build,
                       const std::string& settings) {
  return Digest{}.add_text(recording_hash).add_text(build).add_text(settings).hex();
}

fs::path ResultStore::place(const std::string& key) const {
  return folder_ / key.substr(0, 2) / key;
}

fs::path ResultStore::line_file(const std::string& key) const {
  return place(key) / "line.csv";
}

std::optional<Outcome> ResultStore::find(const std::string& key) const {
  const fs::path file = place(key) / "result.json";
  const Result<nlohmann::ordered_json> json = read_json_object(file);
  if (!json) return std::nullopt;
  Result<Outcome> outcome = outcome_of(*json, file);
  if (!outcome) return std::nullopt;
  return std::move(*outcome);
}

Result<void> ResultStore::put(const std::string& key, const Outcome& outcome, const std::string& line_csv,
                              const Cost& cost) const {
  const fs::path target = place(key);
  BITELINE_ASSIGN(const fs::path beside, make_beside(target.parent_path()));
  const auto write = [&]() -> Result<void> {
    const nlohmann::ordered_json used{
        {"wall_s", cost.wall_s}, {"cpu_s", cost.cpu_s}, {"peak_memory_mb", cost.peak_memory_mb}};
    BITELINE_TRY(report::write_file_atomically(beside / "cost.json", report::to_text(used) + "\n"));
    if (!line_csv.empty()) BITELINE_TRY(report::write_file_atomically(beside / "line.csv", line_csv));
    return report::write_file_atomically(beside / "result.json", report::to_text(to_json(outcome)) + "\n");
  };
  const Result<void> written = write();
  std::error_code error;
  if (written) {
    // Another user of the folder must be able to read it: mkdtemp() lets only this one.
    fs::permissions(beside,
                    fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                        fs::perms::others_read | fs::perms::others_exec,
                    error);
    if (!find(key)) fs::remove_all(target, error);  // what lay there cannot be read
    if (std::rename(beside.c_str(), target.c_str()) == 0) return {};
  }
  const int rename_errno = errno;
  fs::remove_all(beside, error);
  if (!written) return written;
  if (rename_errno == ENOTEMPTY || rename_errno == EEXIST) return {};
  return fail_errno(Errc::WriteFailed, rename_errno, "%s", target.c_str());
}

Result<void> ResultStore::forget(const std::string& key) const {
  std::error_code error;
  fs::remove_all(place(key), error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", place(key).c_str());
  return {};
}

Result<Cost> ResultStore::cost(const std::string& key) const {
  const fs::path file = place(key) / "cost.json";
  BITELINE_ASSIGN(const nlohmann::ordered_json json, read_json_object(file));
  const JsonFields fields{json, file};
  Cost cost;
  BITELINE_ASSIGN(cost.wall_s, fields.number("wall_s"));
  BITELINE_ASSIGN(cost.cpu_s, fields.number("cpu_s"));
  BITELINE_ASSIGN(cost.peak_memory_mb, fields.number("peak_memory_mb"));
  return cost;
}

}  // namespace biteline::batch
