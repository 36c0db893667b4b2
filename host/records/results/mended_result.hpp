// SPDX-License-Identifier: MIT
#pragma once
/// \file A scan's line mended by a person: the new version, and the result as it stands with it.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/bite_line/edit/edit.hpp"
#include "host/bite_line/edit/versions.hpp"
#include "host/report/report.hpp"

namespace biteline::results {

struct MendOrder {
  std::vector<edit::Step> steps;  ///< a Through without a stretch is led over the stretch about its points
  std::string who, why;           ///< told with the version
  std::optional<int>
      line_version{};  ///< what is mended; nothing: the newest.  Another one is Errc::WrongState
  edit::By by{edit::By::Person};
};

/// What came of it.
struct MendedScan {
  ExitStatus status{ExitStatus::Refused};
  int version{0};
  cloud::ClosedLine line;
  double confidence{0};
  cloud::PointCloud cloud;
  std::vector<edit::Snap> snaps;  ///< of the points that this mend has set
  std::string words;              ///< one line for a person
};

/// Mends the newest line of a finished scan's folder.  Keeps what was found, adds lines/line-N.csv, then
/// writes line.csv, report.json and the page anew; what was planned along the line before is removed.  The
/// line is judged as a found one is: with more than a tenth flagged it is for review.  One that fails the
/// checks of `path::check_line`, or whose scan was refused for what no hand can mend, is kept as a version,
/// and its report is refused.  Steps that cannot be done are a edit::Refusal; nothing is written then.
[[nodiscard]] Result<edit::OrRefusal<MendedScan>> mend_scan(const std::filesystem::path& scan,
                                                            const MendOrder& order, report::Report& report);

}  // namespace biteline::results
