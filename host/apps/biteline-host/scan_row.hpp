// SPDX-License-Identifier: MIT
#pragma once
/// \file The memory's row of a scan, read from its folder: what stands on disk is what is remembered.

#include <filesystem>
#include <optional>

#include "host/records/memory/memory.hpp"
#include "host/report/refusal.hpp"

namespace biteline::service {

/// The decision on a shoe that was worked without a person's yes; it stands at the head of the gate's words
/// for it.
inline constexpr const char* k_automatic = "automatic";

/// Nothing where there is no report.json (yet).  Of report.json, line.csv, path/report.json, gate.json and
/// followed.json: verdict, reason, figures, sent, followed, and whose yes it was sent by; of work/work.json
/// what a look after the work told.  The time is report.json's.
[[nodiscard]] std::optional<memory::Scan> row_of(const std::filesystem::path& folder);

/// Of a folder that a path was to be sent from: what the gate said no to, or what stopped the arm; nothing:
/// neither, or nobody knows.
[[nodiscard]] std::optional<report::ToldRefusal> why_not_followed(const std::filesystem::path& folder);

/// Rows for finished scans that the memory does not know: of before it was there, or of when the disk was
/// full.
[[nodiscard]] Result<int> take_up_rows(memory::Memory& memory, const std::filesystem::path& results);

}  // namespace biteline::service
