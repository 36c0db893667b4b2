// SPDX-License-Identifier: MIT
#include "host/records/batch/recording.hpp"

#include <glob.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "common/system/file.hpp"
#include "host/records/digest/digest.hpp"

namespace biteline::batch {
namespace {

namespace fs = std::filesystem;

struct KindName {
  RecordingKind kind;
  const char* name;
};
constexpr std::array k_kinds{
    KindName{RecordingKind::Session, "session"}, KindName{RecordingKind::Cloud, "cloud"},
    KindName{RecordingKind::MadeSession, "made_session"}, KindName{RecordingKind::MadeCloud, "made_cloud"}};

/// What a folder is searched for.  Texts (.csv, .txt) may be anything: they are named, or found by a pattern.
constexpr std::array<std::string_view, 5> k_searched_endings{".ply", ".pcd", ".xyz", ".stl", ".obj"};

/// A session as one file.
constexpr std::string_view k_session_ending = ".mcap";

bool is_session(const fs::path& place) {
  std::error_code ignored;
  return place.extension() == k_session_ending || fs::exists(place / "cam0" / "data.csv", ignored);
}

/// One manifest's search: a name for each place.
class Search {
 public:
  explicit Search(fs::path root) : root_{std::move(root)} {}

  Result<void> add(const fs::path& place) {
    std::error_code error;
    const fs::path real = fs::canonical(place, error);
    if (error) return fail_errno(Errc::FileNotFound, error.value(), "%s", place.c_str());
    if (is_session(real)) {
      put(RecordingKind::Session, real);
    } else if (fs::is_directory(real)) {
      return add_folder(real);
    } else {
      put(RecordingKind::Cloud, real);
    }
    return {};
  }

  [[nodiscard]] std::size_t count() const { return found_.size(); }
  [[nodiscard]] std::vector<Recording> take() {
    std::vector<Recording> all;
    all.reserve(found_.size());
    for (auto& [name, recording] : found_) all.push_back(std::move(recording));
    return all;
  }

 private:
  Result<void> add_folder(const fs::path& folder) {
    std::error_code error;
    for (fs::directory_iterator entry{folder, error}, end; !error && entry != end; entry.increment(error)) {
      const fs::path& place = entry->path();
      if (entry->is_directory()) {
        if (place.filename() == "truth" || place.filename() == "stages") continue;
        if (is_session(place)) {
          put(RecordingKind::Session, place);
        } else {
          BITELINE_TRY(add_folder(place));
        }
      } else if (is_session(place)) {
        put(RecordingKind::Session, place);
      } else if (std::ranges::find(k_searched_endings, place.extension().string()) !=
                 k_searched_endings.end()) {
        put(RecordingKind::Cloud, place);
      }
    }
    if (error) return fail_errno(Errc::FileUnreadable, error.value(), "%s", folder.c_str());
    return {};
  }

  void put(RecordingKind kind, const fs::path& place) {
    const fs::path relative = place.lexically_relative(root_);
    const bool inside = !relative.empty() && *relative.begin() != "..";
    const std::string name = relative == "." ? place.filename().string()
                             : inside        ? relative.generic_string()
                                             : place.generic_string();
    found_[name] = {.name = name, .kind = kind, .path = place, .recipe = {}, .hash = {}, .bytes = 0};
  }

  fs::path root_;
  std::map<std::string, Recording> found_;
};

Result<void> add_pattern(Search& search, const fs::path& pattern) {
  glob_t matches{};
  const int code = ::glob(pattern.c_str(), 0, nullptr, &matches);
  Result<void> done;
  if (code == 0) {
    for (std::size_t i = 0; done && i < matches.gl_pathc; ++i) done = search.add(matches.gl_pathv[i]);
  }
  ::globfree(&matches);
  return done;
}

std::string trimmed(const std::string& line) {
  const std::string text = line.substr(0, line.find('#'));
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

Result<void> read_manifest(Search& search, const fs::path& manifest) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(manifest, k_most_table_bytes));
  std::istringstream lines{text};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string entry = trimmed(line);
    if (entry.empty()) continue;
    const fs::path place = manifest.parent_path() / entry;
    const std::size_t before = search.count();
    std::error_code ignored;
    const bool pattern = entry.find_first_of("*?[") != std::string::npos && !fs::exists(place, ignored);
    if (const Result<void> added = pattern ? add_pattern(search, place) : search.add(place); !added)
      return added;
    if (pattern && search.count() == before) {
      return fail(Errc::FileNotFound, "%.100s line %d: '%.100s' finds no further session or cloud",
                  manifest.c_str(), number, entry.c_str());
    }
  }
  return {};
}

/// The files of a session that decide its result, by their names in it.
Result<std::vector<fs::path>> files_of_session(const fs::path& session) {
  std::error_code ignored;
  if (fs::is_regular_file(session, ignored)) return std::vector{session};
  std::vector<fs::path> files;
  for (const char* part : {"cam0", "pose0"}) {
    std::error_code error;
    for (fs::recursive_directory_iterator entry{session / part, error}, end; !error && entry != end;
         entry.increment(error)) {
      if (entry->is_regular_file()) files.push_back(entry->path());
    }
    if (error) return fail_errno(Errc::FileUnreadable, error.value(), "%s/%s", session.c_str(), part);
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

const char* name_of(RecordingKind kind) {
  return std::ranges::find(k_kinds, kind, &KindName::kind)->name;
}

Result<RecordingKind> recording_kind(const std::string& name) {
  for (const KindName& row : k_kinds) {
    if (name == row.name) return row.kind;
  }
  return fail(Errc::BadValue, "kind '%.40s': session, cloud, made_session or made_cloud expected",
              name.c_str());
}

fs::path truth_of(RecordingKind kind, const fs::path& path) {
  const bool session = kind == RecordingKind::Session || kind == RecordingKind::MadeSession;
  const fs::path truth = (session ? path : path.parent_path()) / "truth" / "groove.csv";
  std::error_code ignored;
  return fs::exists(truth, ignored) ? truth : fs::path{};
}

Result<Fingerprint> fingerprint(RecordingKind kind, const fs::path& path) {
  std::vector<fs::path> files{path};
  if (kind == RecordingKind::Session) {
    BITELINE_ASSIGN(files, files_of_session(path));
  }
  const fs::path from = kind == RecordingKind::Session ? path : path.parent_path();
  if (const fs::path truth = truth_of(kind, path); !truth.empty()) files.push_back(truth);
  Fingerprint print;
  Digest digest;
  digest.add_text(name_of(kind));
  for (const fs::path& file : files) {
    BITELINE_ASSIGN(const std::string hash, digest_of_file(file));
    // A file's own name says nothing beyond its ending, which decides how it is read.
    const bool is_it = file == path;
    digest.add_text(is_it ? path.extension().string() : file.lexically_relative(from).generic_string());
    digest.add_text(hash);
    std::error_code ignored;
    print.bytes += fs::file_size(file, ignored);
  }
  print.hash = digest.hex();
  return print;
}

Result<std::vector<Recording>> find_recordings(const fs::path& manifest) {
  std::error_code error;
  const fs::path real = fs::canonical(manifest, error);
  if (error) return fail_errno(Errc::FileNotFound, error.value(), "%s", manifest.c_str());
  const bool folder = fs::is_directory(real);
  Search search{folder && !is_session(real) ? real : real.parent_path()};
  const bool recording =
      is_session(real) ||
      std::ranges::find(k_searched_endings, real.extension().string()) != k_searched_endings.end();
  BITELINE_TRY(folder || recording ? search.add(real) : read_manifest(search, real));
  if (search.count() == 0) return fail(Errc::FileNotFound, "%s: no session or cloud", manifest.c_str());
  return search.take();
}

}  // namespace biteline::batch
