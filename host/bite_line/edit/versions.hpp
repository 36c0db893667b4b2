// SPDX-License-Identifier: MIT
#pragma once
/// \file The versions of a scan's line: lines/ in the scan's folder.
///
/// `lines/line-0.csv` is the line as it was found (missing where the scan was refused), `lines/found.json`
/// its report; each mend adds `lines/line-N.csv`.  No file of a version is ever written again.
/// `lines/versions.json` lists who, when and why.

#include <filesystem>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/bite_line/edit/steps.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::edit {

struct Version {
  int version{0};    ///< 0: as found
  std::string time;  ///< UTC, ISO 8601
  std::string who;
  std::string why;
  int mended{0};            ///< the version that it was made of
  std::vector<Step> steps;  ///< none for 0
  std::string sha256{};     ///< of its file; empty: an older program wrote it
};

/// The line of a version within the scan's folder.
[[nodiscard]] std::filesystem::path line_file(int version);
/// The report of the result as it was found, within the scan's folder.
[[nodiscard]] std::filesystem::path found_report();

/// Oldest first; one version, as found and without a time, where nobody has mended.
[[nodiscard]] Result<std::vector<Version>> read_versions(const std::filesystem::path& scan);

/// The line of a version; Errc::BadValue where its file was changed since, Errc::FileNotFound where it is not
/// kept or the scan was refused.
[[nodiscard]] Result<cloud::ClosedLine> read_version(const std::filesystem::path& scan, int version);

/// Adds a version with the next number and gives that.  Keeps what was found, first.  line.csv is not
/// touched.  Errc::WrongState when another one came between: `made.mended` is no more the newest.
[[nodiscard]] Result<int> save_version(const std::filesystem::path& scan, const Version& made,
                                       const cloud::ClosedLine& line);

/// "candidate 2", "through 2 points from 10.0 to 42.5 mm", ...
[[nodiscard]] std::string words_of(const Step& step);

}  // namespace biteline::edit
