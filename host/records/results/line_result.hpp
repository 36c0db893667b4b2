// SPDX-License-Identifier: MIT
#pragma once
/// \file What every command that looks for a line does with the outcome.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/core/result.hpp"
#include "host/bite_line/extraction.hpp"
#include "host/bite_line/line_stages.hpp"
#include "host/report/report.hpp"

namespace biteline::results {

/// Removes what an earlier run left in `folder` that a refusal must not leave there (line.csv), and makes the
/// folder.
[[nodiscard]] Result<void> prepare_result_folder(const std::filesystem::path& folder);

/// What stages/ shows; asked for once, after the clock was stopped: nobody waits for pictures.
using StageSource = std::function<bite_line::LineStages()>;

/// The stages of what a way to the line kept (`line_stages()` of its workings); none when it kept nothing.
template <class Workings>
[[nodiscard]] StageSource stages_of(std::optional<Workings> workings) {
  // A std::function is copied; what it holds need not be.
  return [kept = std::make_shared<const std::optional<Workings>>(std::move(workings))] {
    return *kept ? line_stages(**kept) : bite_line::LineStages{};
  };
}

/// Writes cloud.ply, line.csv (unless refused) and report.json; fills the report's fields.  Done, Review or
/// Refused.
[[nodiscard]] Result<ExitStatus> write_line_files(const std::filesystem::path& folder,
                                                  const cloud::PointCloud& cloud,
                                                  const bite_line::Extraction& extraction,
                                                  report::Report& report);
/// report.json as it was written before, with what the report has got since: what others have added to the
/// file stays.
[[nodiscard]] Result<void> write_report_again(const std::filesystem::path& folder, report::Report& report);
/// After it: stages/, view and index.html, and report.json again.  Nobody needs to wait for them.
[[nodiscard]] Result<void> write_line_pages(const std::filesystem::path& folder,
                                            const cloud::PointCloud& cloud,
                                            const bite_line::Extraction& extraction,
                                            const StageSource& stages, report::Report& report);
/// Both.
[[nodiscard]] Result<ExitStatus> write_line_result(const std::filesystem::path& folder,
                                                   const cloud::PointCloud& cloud,
                                                   const bite_line::Extraction& extraction,
                                                   const StageSource& stages, report::Report& report);

/// `seam_step_mm` and `moved_mm` of report.json; neither where the scan does not show them.
void fill_seam(const std::optional<bite_line::SeamStep>& seam, report::Report& report);

/// One line for a person: what was found or why not.
[[nodiscard]] std::string summary(const bite_line::Extraction& extraction);

}  // namespace biteline::results
