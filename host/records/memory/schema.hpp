// SPDX-License-Identifier: MIT
#pragma once
/// \file The tables of the memory, and how an older file becomes one of this program's.

#include "host/records/memory/database.hpp"

namespace biteline::memory {

/// Of this program's schema (`PRAGMA user_version`).
[[nodiscard]] int schema_version();

/// Runs the steps that the file lacks, each in a transaction with its version; Errc::NotSupported for a file
/// of a newer program.
[[nodiscard]] Result<void> raise_schema(Database& database);
/// The same check without changing anything.
[[nodiscard]] Result<void> check_schema(Database& database);

}  // namespace biteline::memory
