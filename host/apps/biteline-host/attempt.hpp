// SPDX-License-Identifier: MIT
#pragma once
/// \file What ended the service once must not end it again: a mark on disk while a scan is worked on.
///
/// The mark lies beside the recording from before the first step until the scan's report is written.  A
/// successor of this process that finds one knows that its predecessor died of this scan, sets it aside by
/// name, and goes on with the next.

#include <filesystem>
#include <string>

#include "common/core/result.hpp"

namespace biteline::service {

/// On disk when this returns, whatever the process does next.
[[nodiscard]] Result<void> mark_attempt(const std::filesystem::path& folder);
void clear_attempt(const std::filesystem::path& folder);
[[nodiscard]] bool was_attempted(const std::filesystem::path& folder);

/// A person ended the scan on its way: on disk, as a successor would take it for one that came to its end.
[[nodiscard]] Result<void> mark_stopped(const std::filesystem::path& folder, const std::string& who);
/// Who; empty: nobody.
[[nodiscard]] std::string stopped_by(const std::filesystem::path& folder);
[[nodiscard]] Error stopped_on_its_way(const std::string& who);

/// The scan stays where it is, with its recording and a report.json that says why; one line on stdout.  It is
/// not looked at again unless a person asks for it by name.
[[nodiscard]] Result<void> set_aside(const std::filesystem::path& folder, const std::string& why);

}  // namespace biteline::service
