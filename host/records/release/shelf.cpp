// SPDX-License-Identifier: MIT
#include "host/records/release/shelf.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "host/records/archive/archive.hpp"
#include "host/records/release/key_lines.hpp"
#include "host/report/report.hpp"

namespace biteline::release {
namespace {

namespace fs = std::filesystem;

/// Names of a folder are on the disk once this returns.
void sync_folder(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

void sync_below(const fs::path& folder) {
  std::error_code error;
  for (fs::recursive_directory_iterator at{folder, error}, end; !error && at != end; at.increment(error)) {
    if (at->is_directory(error)) sync_folder(at->path());
  }
  sync_folder(folder);
}

}  // namespace

Result<std::optional<InForce>> in_force(const fs::path& folder, std::int64_t now_ms) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    return fail(Errc::FileNotFound,
                "%.200s: no folder of releases there; biteline-uplink --releases makes it", folder.c_str());
  BITELINE_ASSIGN(const Plan plan, plan_of(folder));
  const std::string& hash = plan.in_force(now_ms);
  if (hash.empty()) return std::nullopt;
  const fs::path release = folder / hash;
  if (!fs::is_directory(release, error))
    return fail(Errc::FileNotFound, "%.200s: release %.16s is in force, but is not there", folder.c_str(),
                hash.c_str());
  return InForce{.hash = hash, .models = release / k_models, .processes = release / k_processes};
}

fs::path Shelf::part_of(const std::string& hash) const {
  return folder_ / (hash + ".part");
}

bool Shelf::has(const std::string& hash) const {
  std::error_code error;
  return is_sha256(hash) && fs::is_directory(folder_ / hash, error);
}

std::vector<std::string> Shelf::hashes() const {
  std::vector<std::string> hashes;
  std::error_code error;
  for (fs::directory_iterator at{folder_, error}, end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (has(name)) hashes.push_back(name);
  }
  std::ranges::sort(hashes);
  return hashes;
}

Result<void> Shelf::take_in(const Manifest& manifest) const {
  const fs::path part = part_of(manifest.sha256);
  const fs::path beside = folder_ / (manifest.sha256 + ".unpacked");
  std::error_code error;
  const Result<void> taken = [&]() -> Result<void> {
    BITELINE_TRY(check_file(part, manifest));
    fs::remove_all(beside, error);
    BITELINE_TRY(archive::unpack(part, k_archive_kind, beside));
    sync_below(beside);
    fs::rename(beside, folder_ / manifest.sha256, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", beside.c_str());
    sync_folder(folder_);
    return {};
  }();
  fs::remove_all(beside, error);
  fs::remove(part, error);
  return taken;
}

Result<void> Shelf::write(const Plan& plan) const {
  BITELINE_TRY(report::write_file_atomically(folder_ / k_plan_file, to_text(plan)));
  sync_folder(folder_);
  return {};
}

Result<void> Shelf::tidy(const Plan& plan, const std::string& wanted) const {
  std::error_code error;
  std::vector<fs::path> go;
  for (fs::directory_iterator at{folder_, error}, end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    const std::string hash = name.substr(0, 64);
    const bool named = hash == plan.current || hash == plan.before || hash == plan.next || hash == wanted;
    // Left by a predecessor that was killed between the last rename and the end.
    const bool spare = name != hash && has(hash);
    if (is_sha256(hash) && (!named || spare)) go.push_back(at->path());
  }
  for (fs::path path : go) {
    // Half a release must not stand under a whole one's name.
    if (is_sha256(path.filename().string())) {
      const fs::path gone = path.string() + ".gone";
      // Left by a predecessor that was killed: a folder with something in it cannot be renamed over.
      fs::remove_all(gone, error);
      if (!error) fs::rename(path, gone, error);
      path = gone;
    }
    if (!error) fs::remove_all(path, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", path.c_str());
  }
  return {};
}

}  // namespace biteline::release
