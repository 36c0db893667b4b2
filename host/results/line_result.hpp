// SPDX-License-Identifier: MIT
#pragma once
/// \file What every command that looks for a line does with the outcome.

#include <filesystem>

#include "common/core/result.hpp"
#include "host/bite_line/extract.hpp"
#include "host/intake/live_line.hpp"
#include "host/report/report.hpp"

namespace biteline::results {

/// Removes what an earlier run left in `folder` that a refusal must not leave there (line.csv), and makes the
/// folder.
[[nodiscard]] Result<void> prepare_result_folder(const std::filesystem::path& folder);

/// Without what only pictures need: write_line_result() computes that once the clock has stopped.
inline const bite_line::ExtractConfig k_line_only{.keep_products = false};

/// Looks for the line, timed as the stage "extract", without what only pictures need.
[[nodiscard]] bite_line::Extraction find_line(const cloud::PointCloud& cloud, bite_line::Method method,
                                              report::Report& report);

/// The line of a scan that is in; its time from the last profile on is the stage "last profile to line".
[[nodiscard]] bite_line::Extraction finish_line(intake::LiveLine& line, report::Report& report);

/// Writes cloud.ply, line.csv (unless refused), stages/ and report.json; fills the report's fields.  Done or
/// Refused. What the pictures show is computed here when the extraction does not carry it, after the clock
/// was stopped: nobody waits for pictures.
[[nodiscard]] Result<ExitStatus> write_line_result(const std::filesystem::path& folder,
                                                   const cloud::PointCloud& cloud,
                                                   const bite_line::Extraction& extraction,
                                                   bite_line::Method method, report::Report& report);

/// One line for a person: what was found or why not.
[[nodiscard]] std::string summary(const bite_line::Extraction& extraction);

}  // namespace biteline::results
