// SPDX-License-Identifier: MIT
#pragma once
/// \file What of a scan was looked at is what is sent: its files against what the service wrote
/// (memory::Evidence).

#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::evidence {

/// Of the files as they lie there now; one that is not there is empty.
[[nodiscard]] Result<memory::Evidence> of_folder(const std::filesystem::path& scan);

/// The first file that is not as it was written, and what to do; nothing: all are.  What is not known counts
/// as unchanged.
[[nodiscard]] std::optional<std::string> change(const memory::Evidence& written, const memory::Evidence& now);

/// line.csv is a version newer than `known` that somebody made with `biteline line edit`, as it works in the
/// folder while no service does: who and which, in words.  A line that another program wrote is none.
[[nodiscard]] std::optional<std::string> mended_since(const std::filesystem::path& scan,
                                                      const memory::Evidence& written,
                                                      const memory::Evidence& now, int known);

}  // namespace biteline::evidence
