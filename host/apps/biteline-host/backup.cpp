// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/backup.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/system/file.hpp"
#include "host/apps/biteline-host/service_words.hpp"
#include "host/interfaces/api/process_store.hpp"
#include "host/records/archive/archive.hpp"
#include "host/records/memory/memory.hpp"
#include "host/report/file_lock.hpp"
#include "host/report/report.hpp"
#include "host/transfer/library.hpp"

namespace biteline::service {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_kind = "backup";
constexpr const char* k_models = "models";
constexpr const char* k_processes = "processes";

/// A folder for this user alone, removed with its owner.
class Private {
 public:
  static Result<Private> create(const fs::path& in) {
    std::string pattern = (in / ".biteline-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr)
      return fail_errno(Errc::WriteFailed, errno, "%.200s", in.c_str());
    return Private{pattern};
  }
  Private(Private&& other) noexcept : path_{std::exchange(other.path_, {})} {}
  Private& operator=(Private&&) = delete;
  ~Private() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  explicit Private(fs::path path) : path_{std::move(path)} {}
  fs::path path_;
};

/// Everything but the sessions: whoever restores it is nobody's session.
Result<void> copy_memory(const fs::path& results, const fs::path& target) {
  {
    BITELINE_ASSIGN(const memory::Memory memory,
                    memory::Memory::open_to_read(results / memory::k_memory_file));
    BITELINE_TRY(memory.copy_to(target));
  }
  BITELINE_ASSIGN(memory::Memory copy, memory::Memory::open(target));
  return copy.remove_sessions_before(std::numeric_limits<memory::UnixMs>::max());
}

api::ProcessStore saved_processes(const fs::path& folder) {
  return {fs::path{}, folder};
}

/// Sound models by name; Errc of the first that is not.
Result<std::vector<std::string>> sound_models(const transfer::Library& library) {
  BITELINE_ASSIGN(const std::vector<transfer::ModelInfo> models, library.list());
  std::vector<std::string> names;
  for (const transfer::ModelInfo& model : models) {
    if (model.damage) return tl::unexpected<Error>{*model.damage};
    names.push_back(model.name);
  }
  return names;
}

Result<std::vector<api::StoredProcess>> sound_processes(const fs::path& folder) {
  std::vector<api::StoredProcess> all = saved_processes(folder).list();
  for (const api::StoredProcess& process : all) {
    if (const auto read = path::read_process(process.file); !read) return tl::unexpected<Error>{read.error()};
  }
  return all;
}

bool same_model(const fs::path& one, const fs::path& other) {
  const Result<std::string> a = read_regular_file(one / "model.json", k_most_settings_bytes),
                            b = read_regular_file(other / "model.json", k_most_settings_bytes);
  return a && b && *a == *b;
}

Result<void> restore_models(const transfer::Library& from, const transfer::Library& to,
                            const std::vector<std::string>& names, const fs::path& folder) {
  for (const std::string& name : names) {
    if (to.has(name) && same_model(from.path_of(name), to.path_of(name))) continue;
    const fs::path file = folder / "model.tar";
    BITELINE_TRY(from.export_to(name, file));
    BITELINE_TRY(to.import_from(file, name, true));
  }
  return {};
}

Result<void> restore_processes(const std::vector<api::StoredProcess>& processes, const fs::path& to) {
  if (processes.empty()) return {};
  BITELINE_TRY(report::prepare_folder(to));
  for (const api::StoredProcess& process : processes) {
    BITELINE_ASSIGN(const std::string text, read_regular_file(process.file, k_most_settings_bytes));
    BITELINE_TRY(report::write_file_atomically(to / process.file.filename(), text));
  }
  return {};
}

}  // namespace

Result<BackupCounts> write_backup(const BackupPlaces& places, const fs::path& file) {
  const fs::path beside = fs::absolute(file).parent_path();
  BITELINE_ASSIGN(const Private work, Private::create(beside));
  const fs::path memory = work.path() / memory::k_memory_file;
  BITELINE_TRY(copy_memory(places.results, memory));
  std::vector<archive::Entry> entries{{.name = memory::k_memory_file, .file = memory}};
  const transfer::Library library{places.library};
  BITELINE_ASSIGN(const std::vector<std::string> models, sound_models(library));
  for (const std::string& name : models) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator{library.path_of(name)})
      files.push_back(entry.path());
    std::ranges::sort(files);
    for (const fs::path& one : files)
      entries.push_back(
          {.name = std::string{k_models} + "/" + name + "/" + one.filename().string(), .file = one});
  }
  BITELINE_ASSIGN(const std::vector<api::StoredProcess> processes,
                  sound_processes(places.results / k_processes));
  for (const api::StoredProcess& process : processes)
    entries.push_back(
        {.name = std::string{k_processes} + "/" + process.name + ".yaml", .file = process.file});
  BITELINE_TRY(archive::write(
      file, {.kind = k_kind, .program = BITELINE_VERSION, .time = utc_now(), .more = {}}, entries));
  return BackupCounts{.models = models.size(), .processes = processes.size()};
}

Result<BackupCounts> restore_backup(const BackupPlaces& places, const fs::path& file) {
  BITELINE_TRY(report::prepare_folder(places.results));
  const std::string holder =
      "biteline-host " + std::to_string(::getpid()) + " that restores " + file.string();
  BITELINE_ASSIGN(const report::FileLock lock,
                  report::FileLock::take(places.results / k_results_lock, holder));
  const fs::path target = places.results / memory::k_memory_file;
  std::error_code error;
  if (fs::exists(target, error))
    return fail(Errc::WrongState, "%.150s is there already; move it away, or name another --out",
                target.c_str());
  BITELINE_ASSIGN(const Private work, Private::create(places.results));
  BITELINE_TRY(archive::unpack(file, k_kind, work.path()));
  // All of it is looked at before any of it is put in place.
  const fs::path memory = work.path() / memory::k_memory_file;
  BITELINE_TRY(memory::Memory::open(memory));
  const transfer::Library kept{work.path() / k_models};
  BITELINE_ASSIGN(const std::vector<std::string> models, sound_models(kept));
  BITELINE_ASSIGN(const std::vector<api::StoredProcess> processes,
                  sound_processes(work.path() / k_processes));

  BITELINE_TRY(restore_models(kept, transfer::Library{places.library}, models, work.path()));
  BITELINE_TRY(restore_processes(processes, places.results / k_processes));
  // The memory last: until then another try begins anew.
  fs::rename(memory, target, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", target.c_str());
  return BackupCounts{.models = models.size(), .processes = processes.size()};
}

}  // namespace biteline::service
