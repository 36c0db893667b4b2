// SPDX-License-Identifier: MIT
#include "host/transfer/library.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "common/core/text.hpp"
#include "common/system/file.hpp"
#include "common/wire/checksum.hpp"
#include "host/cloud/ply.hpp"
#include "host/records/archive/archive.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"

namespace biteline::transfer {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_manifest_file = "model.json";
constexpr int k_format = 1;
constexpr const char* k_picture_file = "picture.png";
constexpr const char* k_picture_source = "stages/6_sequence.png";
constexpr const char* k_undo_folder = ".undo";
constexpr const char* k_archive_kind = "model";

bool good_name(const std::string& name) {
  constexpr std::size_t k_longest = 64;
  return !name.empty() && name.size() <= k_longest && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-';
         });
}

Result<void> check_name(const std::string& name) {
  if (good_name(name)) return {};
  return fail(Errc::InvalidArgument,
              "model name '%s': expected letters, digits, '.', '_', '-', at most 64, no '.' in front",
              name.c_str());
}

/// A manifest names what save() put there and nothing else: no other folder's file, no device.
bool is_model_file(const std::string& name) {
  return name == k_cloud_file || name == k_line_file || name == k_process_file || name == k_picture_file;
}

std::string checksum_of(const std::string& bytes) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x",
                wire::crc32c({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
  return text;
}

/// model.json as read.
struct Manifest {
  struct File {
    std::string name, checksum;
    std::uint64_t bytes{0};
  };
  std::size_t points{0};
  double line_length_mm{0};
  ModelMade made;
  std::vector<File> files;
};

/// The optional texts of a manifest.
template <class Made>
auto texts_of(Made& made) {
  return std::array{
      std::pair{"time", &made.time}, std::pair{"scan", &made.scan}, std::pair{"process", &made.process},
      std::pair{"size", &made.size}, std::pair{"foot", &made.foot}, std::pair{"program", &made.program},
      std::pair{"of", &made.of}};
}

std::string manifest_text(const std::string& name, const Manifest& manifest) {
  nlohmann::ordered_json json{{"format", k_format},
                              {"name", name},
                              {"points", manifest.points},
                              {"line_length_mm", manifest.line_length_mm},
                              {"version", manifest.made.version}};
  for (const auto& [key, text] : texts_of(manifest.made)) {
    if (!text->empty()) json[key] = *text;
  }
  for (const Manifest::File& file : manifest.files) {
    json["files"].push_back({{"name", file.name}, {"bytes", file.bytes}, {"crc32c", file.checksum}});
  }
  return report::to_text(json) + "\n";
}

Result<Manifest> read_manifest(const std::string& name, const fs::path& folder) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(folder / k_manifest_file, k_most_settings_bytes));
  // nlohmann reports by exceptions: caught here, at the one call.
  try {
    const nlohmann::json json = nlohmann::json::parse(text);
    if (json.at("format").get<int>() != k_format) {
      return fail(Errc::NotSupported, "model %s: format %d, expected %d", name.c_str(),
                  json.at("format").get<int>(), k_format);
    }
    Manifest manifest{.points = json.at("points").get<std::size_t>(),
                      .line_length_mm = json.at("line_length_mm").get<double>(),
                      .made = {},
                      .files = {}};
    manifest.made.version = json.value("version", 1);
    // Shown to people: bounded, and without what a terminal or page would act on.
    for (const auto& [key, words] : texts_of(manifest.made)) *words = clean_text(json.value(key, ""), 100);
    for (const nlohmann::json& file : json.at("files")) {
      manifest.files.push_back({.name = file.at("name").get<std::string>(),
                                .checksum = file.at("crc32c").get<std::string>(),
                                .bytes = file.at("bytes").get<std::uint64_t>()});
    }
    return manifest;
  } catch (const nlohmann::json::exception& error) {
    return fail(Errc::BadFormat, "model %s is damaged: %s: %s", name.c_str(), k_manifest_file, error.what());
  }
}

/// Every file of the manifest is there, whole and unchanged, and the two that make a sample are among them.
Result<Manifest> check(const std::string& name, const fs::path& folder) {
  BITELINE_ASSIGN(const Manifest manifest, read_manifest(name, folder));
  for (const char* needed : {k_cloud_file, k_line_file}) {
    const bool there = std::any_of(manifest.files.begin(), manifest.files.end(),
                                   [&](const Manifest::File& file) { return file.name == needed; });
    if (!there)
      return fail(Errc::BadFormat, "model %s is damaged: %s does not name %s", name.c_str(), k_manifest_file,
                  needed);
  }
  for (const Manifest::File& file : manifest.files) {
    if (!is_model_file(file.name)) {
      return fail(Errc::BadFormat, "model %s is damaged: %s names %s, which is no file of a model",
                  name.c_str(), k_manifest_file, file.name.c_str());
    }
    const Result<std::string> bytes = read_regular_file(folder / file.name, k_most_cloud_bytes);
    if (!bytes)
      return fail(Errc::FileNotFound, "model %s is damaged: %s is missing", name.c_str(), file.name.c_str());
    if (bytes->size() != file.bytes) {
      return fail(Errc::SizeMismatch, "model %s is damaged: %s has %zu bytes, expected %zu", name.c_str(),
                  file.name.c_str(), bytes->size(), static_cast<std::size_t>(file.bytes));
    }
    if (checksum_of(*bytes) != file.checksum) {
      return fail(Errc::BadValue, "model %s is damaged: %s does not match its checksum", name.c_str(),
                  file.name.c_str());
    }
  }
  return manifest;
}

Result<void> sync_folder(const fs::path& folder) {
  const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return fail_errno(Errc::WriteFailed, errno, "%s", folder.c_str());
  const bool synced = ::fsync(handle) == 0;
  const int sync_errno = errno;
  ::close(handle);
  if (!synced) return fail_errno(Errc::WriteFailed, sync_errno, "%s", folder.c_str());
  return {};
}

/// Puts `beside` in the place of `target` in one step; what stood there ends up at `beside`.
Result<void> put_in_place(const fs::path& beside, const fs::path& target) {
  if (::rename(beside.c_str(), target.c_str()) == 0) return {};
  // A folder with something in it cannot be renamed over: swap the two names.
  if (errno == ENOTEMPTY || errno == EEXIST) {
    if (::renameat2(AT_FDCWD, beside.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return {};
  }
  return fail_errno(Errc::WriteFailed, errno, "%s", target.c_str());
}

/// A folder of its own beside the models, removed with its owner.
class Beside {
 public:
  static Result<Beside> create(const fs::path& library) {
    std::string pattern = (library / ".saving-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr)
      return fail_errno(Errc::WriteFailed, errno, "%s", library.c_str());
    ::chmod(pattern.c_str(), 0755);  // mkdtemp makes it private; other users may read the library
    return Beside{pattern};
  }
  Beside(Beside&& other) noexcept : path_{std::exchange(other.path_, {})} {}
  Beside& operator=(Beside&&) = delete;
  ~Beside() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  explicit Beside(fs::path path) : path_{std::move(path)} {}
  fs::path path_;
};

ModelInfo info_of(const std::string& name, const fs::path& folder, const Manifest& manifest) {
  ModelInfo info{.name = name};
  info.points = manifest.points;
  info.line_length_mm = manifest.line_length_mm;
  info.made = manifest.made;
  std::error_code error;
  info.has_process = fs::exists(folder / k_process_file, error);
  return info;
}

/// Moves `folder` to where undo() finds it; what was kept there before goes.
Result<void> keep_for_undo(const fs::path& library, const std::string& name, const fs::path& folder) {
  BITELINE_TRY(report::prepare_folder(library / k_undo_folder));
  BITELINE_ASSIGN(const Beside older, Beside::create(library));
  const fs::path kept = library / k_undo_folder / name;
  std::error_code error;
  if (fs::is_directory(kept, error)) BITELINE_TRY(put_in_place(kept, older.path() / name));
  return put_in_place(folder, kept);
}

/// A finished folder becomes the model; what it replaces is kept for undo().
Result<void> put_beside(const fs::path& library, const std::string& name, const fs::path& beside,
                        bool replaces) {
  BITELINE_TRY(sync_folder(beside));
  BITELINE_TRY(put_in_place(beside, library / name));
  if (replaces) BITELINE_TRY(keep_for_undo(library, name, beside));
  return sync_folder(library);
}

}  // namespace

fs::path Library::default_folder() {
  const char* data = std::getenv("XDG_DATA_HOME");
  if (data != nullptr && *data == '/') return fs::path{data} / "biteline" / "models";
  const char* home = std::getenv("HOME");
  return fs::path{home != nullptr ? home : "."} / ".local" / "share" / "biteline" / "models";
}

Result<ModelInfo> Library::save(const std::string& name, const fs::path& sample_folder,
                                const SaveOptions& options) const {
  BITELINE_TRY(check_name(name));
  if (!options.made.of.empty()) BITELINE_TRY(check_name(options.made.of));
  if (const std::string& foot = options.made.foot; !foot.empty() && foot != "left" && foot != "right")
    return fail(Errc::InvalidArgument, "model %s: foot '%.40s': left or right expected", name.c_str(),
                foot.c_str());
  const bool replaces = has(name);
  if (replaces && !options.replace) {
    return fail(Errc::InvalidArgument, "model %s exists in %.120s; say --replace, or choose another name",
                name.c_str(), folder_.c_str());
  }
  BITELINE_ASSIGN(const SampleFiles sample, read_sample(sample_folder));
  BITELINE_TRY(report::prepare_folder(folder_));
  BITELINE_ASSIGN(const Beside beside, Beside::create(folder_));

  std::vector<std::pair<const char*, fs::path>> sources{{k_cloud_file, sample_folder / k_cloud_file},
                                                        {k_line_file, sample_folder / k_line_file}};
  const fs::path process =
      options.process_file.empty() ? sample_folder / k_process_file : options.process_file;
  if (!options.process_file.empty() || fs::exists(process)) sources.emplace_back(k_process_file, process);
  if (fs::exists(sample_folder / k_picture_source))
    sources.emplace_back(k_picture_file, sample_folder / k_picture_source);

  Manifest manifest{.points = sample.cloud.size(),
                    .line_length_mm = cloud::length_mm(sample.line),
                    .made = options.made,
                    .files = {}};
  // A damaged one tells no version; it is replaced all the same.
  if (const Result<Manifest> before = read_manifest(name, path_of(name)); replaces && before)
    manifest.made.version = before->made.version + 1;
  for (const auto& [file, source] : sources) {
    BITELINE_ASSIGN(const std::string bytes, read_regular_file(source, k_most_cloud_bytes));
    BITELINE_TRY(report::write_file_atomically(beside.path() / file, bytes));
    manifest.files.push_back({.name = file, .checksum = checksum_of(bytes), .bytes = bytes.size()});
  }
  BITELINE_TRY(report::write_file_atomically(beside.path() / k_manifest_file, manifest_text(name, manifest)));
  BITELINE_TRY(put_beside(folder_, name, beside.path(), replaces));
  return info_of(name, path_of(name), manifest);
}

bool Library::has(const std::string& name) const {
  std::error_code error;
  return good_name(name) && fs::is_directory(path_of(name), error);
}

Result<ModelInfo> Library::info(const std::string& name) const {
  BITELINE_TRY(check_name(name));
  if (!has(name)) return fail(Errc::FileNotFound, "no model %s in %s", name.c_str(), folder_.c_str());
  const Result<Manifest> manifest = check(name, path_of(name));
  if (manifest) return info_of(name, path_of(name), *manifest);
  ModelInfo damaged{.name = name};
  damaged.damage = manifest.error();
  return damaged;
}

Result<ModelMade> Library::made(const std::string& name) const {
  BITELINE_TRY(check_name(name));
  if (!has(name)) return fail(Errc::FileNotFound, "no model %s in %s", name.c_str(), folder_.c_str());
  BITELINE_ASSIGN(const Manifest manifest, read_manifest(name, path_of(name)));
  return manifest.made;
}

Result<ModelInfo> Library::undo(const std::string& name) const {
  BITELINE_TRY(check_name(name));
  const fs::path kept = folder_ / k_undo_folder / name;
  std::error_code error;
  if (!fs::is_directory(kept, error))
    return fail(Errc::FileNotFound, "nothing to undo for model %s in %.120s", name.c_str(), folder_.c_str());
  BITELINE_TRY(check(name, kept));
  BITELINE_TRY(put_in_place(kept, path_of(name)));
  BITELINE_TRY(sync_folder(folder_));
  return info(name);
}

Result<std::vector<std::string>> Library::names() const {
  std::vector<std::string> names;
  std::error_code error;
  if (!fs::exists(folder_, error)) return names;
  for (fs::directory_iterator at{folder_, error}; !error && at != fs::directory_iterator{};
       at.increment(error)) {
    std::string name = at->path().filename().string();
    if (at->is_directory() && good_name(name)) names.push_back(std::move(name));
  }
  if (error) return fail_errno(Errc::FileUnreadable, error.value(), "%s", folder_.c_str());
  std::sort(names.begin(), names.end());
  return names;
}

Result<std::vector<ModelInfo>> Library::list() const {
  BITELINE_ASSIGN(const std::vector<std::string> all, names());
  std::vector<ModelInfo> models;
  for (const std::string& name : all) {
    BITELINE_ASSIGN(ModelInfo model, info(name));
    models.push_back(std::move(model));
  }
  return models;
}

Result<SampleFiles> Library::load(const std::string& name) const {
  BITELINE_TRY(check_name(name));
  if (!fs::is_directory(path_of(name))) {
    return fail(Errc::FileNotFound, "no model %s in %s", name.c_str(), folder_.c_str());
  }
  BITELINE_TRY(check(name, path_of(name)));
  return read_sample(path_of(name));
}

Result<void> Library::remove(const std::string& name) const {
  BITELINE_TRY(check_name(name));
  if (!fs::is_directory(path_of(name))) {
    return fail(Errc::FileNotFound, "no model %s in %s", name.c_str(), folder_.c_str());
  }
  // Out of sight in one step; undo() brings it back.
  return keep_for_undo(folder_, name, path_of(name));
}

Result<ModelInfo> Library::rename(const std::string& name, const std::string& new_name) const {
  BITELINE_TRY(check_name(name));
  BITELINE_TRY(check_name(new_name));
  if (!has(name)) return fail(Errc::FileNotFound, "no model %s in %s", name.c_str(), folder_.c_str());
  BITELINE_ASSIGN(const Manifest manifest, check(name, path_of(name)));
  if (::renameat2(AT_FDCWD, path_of(name).c_str(), AT_FDCWD, path_of(new_name).c_str(), RENAME_NOREPLACE) !=
      0) {
    if (errno == EEXIST)
      return fail(Errc::InvalidArgument, "model %s exists in %.120s; choose another name", new_name.c_str(),
                  folder_.c_str());
    return fail_errno(Errc::WriteFailed, errno, "%s", path_of(new_name).c_str());
  }
  // The folder's name counts; this one is for people.
  BITELINE_TRY(
      report::write_file_atomically(path_of(new_name) / k_manifest_file, manifest_text(new_name, manifest)));
  BITELINE_TRY(sync_folder(folder_));
  return info_of(new_name, path_of(new_name), manifest);
}

Result<void> Library::export_to(const std::string& name, const fs::path& target) const {
  BITELINE_TRY(check_name(name));
  if (!has(name)) return fail(Errc::FileNotFound, "no model %s in %s", name.c_str(), folder_.c_str());
  BITELINE_ASSIGN(const Manifest manifest, check(name, path_of(name)));
  std::vector<archive::Entry> entries{{.name = k_manifest_file, .file = path_of(name) / k_manifest_file}};
  for (const Manifest::File& file : manifest.files)
    entries.push_back({.name = file.name, .file = path_of(name) / file.name});
  return archive::write(target,
                        {.kind = k_archive_kind,
                         .program = manifest.made.program,
                         .time = manifest.made.time,
                         .more = {{"name", name}}},
                        entries);
}

Result<ModelInfo> Library::import_from(const fs::path& file, const std::string& name, bool replace) const {
  BITELINE_TRY(report::prepare_folder(folder_));
  BITELINE_ASSIGN(const Beside beside, Beside::create(folder_));
  BITELINE_ASSIGN(archive::About about, archive::unpack(file, k_archive_kind, beside.path()));
  const std::string as = name.empty() ? about.more["name"] : name;
  if (name.empty() && !good_name(as))
    return fail(Errc::BadFormat, "%.200s names its model '%.80s'; give it another name", file.c_str(),
                as.c_str());
  BITELINE_TRY(check_name(as));
  const bool replaces = has(as);
  if (replaces && !replace) {
    return fail(Errc::InvalidArgument, "model %s exists in %.120s; say --replace, or choose another name",
                as.c_str(), folder_.c_str());
  }
  BITELINE_ASSIGN(Manifest manifest, check(as, beside.path()));
  std::size_t files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator{beside.path()})
    files += entry.path().filename() != k_manifest_file ? 1 : 0;
  if (files != manifest.files.size())
    return fail(Errc::BadFormat, "%.200s holds files that are no model's", file.c_str());
  BITELINE_TRY(read_sample(beside.path()));
  if (const Result<Manifest> before = read_manifest(as, path_of(as)); replaces && before)
    manifest.made.version = before->made.version + 1;
  BITELINE_TRY(report::write_file_atomically(beside.path() / k_manifest_file, manifest_text(as, manifest)));
  BITELINE_TRY(put_beside(folder_, as, beside.path(), replaces));
  return info_of(as, path_of(as), manifest);
}

Result<SampleFiles> find_sample(const std::string& sample, const Library& library) {
  if (fs::is_directory(sample)) return read_sample(sample);
  if (sample.find('/') != std::string::npos) {
    return fail(Errc::FileNotFound, "%s: expected the folder of a finished sample", sample.c_str());
  }
  return library.load(sample);
}

}  // namespace biteline::transfer
