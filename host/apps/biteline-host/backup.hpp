// SPDX-License-Identifier: MIT
#pragma once
/// \file All that a cell was taught and remembers as one file: rows, accounts, settings, models, processes.
///
/// An archive (host/records/archive, kind "backup") with `memory.sqlite`, `models/NAME/...` and
/// `processes/NAME.yaml`. The scans' folders, their clouds and pictures, are not in it; sessions are not
/// either.

#include <filesystem>

#include "common/core/result.hpp"

namespace biteline::service {

struct BackupPlaces {
  std::filesystem::path results;  ///< the service's --out
  std::filesystem::path library;  ///< of models
};

struct BackupCounts {
  std::size_t models{0}, processes{0};
};

/// Also while a service runs.  A damaged model is Errc::BadFormat and so on, by its name: nothing is written.
[[nodiscard]] Result<BackupCounts> write_backup(const BackupPlaces& places,
                                                const std::filesystem::path& file);

/// While no service runs, into results without a memory: Errc::WrongState says what to move away.  A model of
/// the library that has another content is replaced and kept for undo.  A file that is not whole changes
/// nothing.
[[nodiscard]] Result<BackupCounts> restore_backup(const BackupPlaces& places,
                                                  const std::filesystem::path& file);

}  // namespace biteline::service
