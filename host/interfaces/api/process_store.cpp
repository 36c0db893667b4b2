// SPDX-License-Identifier: MIT
#include "host/interfaces/api/process_store.hpp"

#include <algorithm>
#include <map>

#include "common/system/file.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/interfaces/api/process_schema.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::api {
namespace {

namespace fs = std::filesystem;

void add_folder(const fs::path& folder, bool shipped, std::map<std::string, StoredProcess>& all) {
  std::error_code error;
  for (fs::directory_iterator at{folder, error}, end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().stem().string();
    if (at->path().extension() == ".yaml" && is_name(name))
      all[name] = {.name = name, .file = at->path(), .shipped = shipped};
  }
}

}  // namespace

std::vector<StoredProcess> ProcessStore::list() const {
  std::map<std::string, StoredProcess> all;
  add_folder(shipped_, true, all);
  add_folder(saved_, false, all);
  std::vector<StoredProcess> list;
  for (auto& [name, process] : all) list.push_back(std::move(process));
  return list;
}

Result<StoredProcess> ProcessStore::find(const std::string& name) const {
  std::vector<StoredProcess> all = list();
  const auto found = std::ranges::find(all, name, &StoredProcess::name);
  if (found == all.end()) return fail(Errc::FileNotFound, "process '%.64s'", name.c_str());
  return *found;
}

Result<control::Json> ProcessStore::read(const std::string& name) const {
  BITELINE_ASSIGN(const StoredProcess stored, find(name));
  BITELINE_ASSIGN(const std::string text, read_regular_file(stored.file, k_most_settings_bytes));
  BITELINE_ASSIGN(const path::ProcessText process, path::parse_process(text, stored.file.string()));
  return process_json(process.keys);
}

Result<path::Process> ProcessStore::check(const std::string& name, const control::Json& process) {
  // YAML takes JSON as it is.
  Result<path::ProcessText> parsed = path::parse_process(report::to_text(process) + "\n", "process " + name);
  if (parsed) return std::move(parsed->process);
  Error error = parsed.error();
  error.code = Errc::CheckFailed;
  return tl::unexpected<Error>{error};
}

Result<void> ProcessStore::save(const std::string& name, const control::Json& process) const {
  if (!is_name(name)) return fail(Errc::InvalidArgument, "process name '%.64s'", name.c_str());
  BITELINE_TRY(check(name, process));
  BITELINE_TRY(report::prepare_folder(saved_));
  return report::write_file_atomically(saved_ / (name + ".yaml"), report::to_text(process) + "\n");
}

}  // namespace biteline::api
