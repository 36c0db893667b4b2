// SPDX-License-Identifier: MIT
#pragma once
/// \file A host asks for a scan that waits, or for the one that ends next.

#include <filesystem>
#include <future>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "firmware/runtime/realtime.hpp"

namespace biteline::record {

/// What a sensor records, as its command line says.
struct KeepPolicy {
  std::optional<std::filesystem::path> series{};  ///< none: nothing is recorded
  bool asked{false};                              ///< scans wait until somebody asks for them
  runtime::RealtimeDemand realtime{runtime::RealtimeDemand::Required};
};

enum class KeepWhich { Last, Next };

/// The scan that ended last, as far as this program wrote it.
struct LastScan {
  bool being_written{false};
  std::string fault{};  ///< what ended its recording before the scan; empty: nothing did
};

/// Renames on a thread of its own: a disk that is busy holds nobody up.
///
/// Thread: one owner.  Its end waits for what is under way.
class KeepRequest {
 public:
  explicit KeepRequest(KeepPolicy policy) : policy_{std::move(policy)} {}

  /// Errc::NotSupported: nothing is recorded, or nothing waits to be asked for.  Errc::WrongState: the last
  /// scan is still being written, or a request is under way.
  [[nodiscard]] Result<void> begin(KeepWhich which, const LastScan& last);
  /// Once: what was kept, in words.  Errc::FileNotFound: no scan waits.  Errc::DiskFull, Errc::WriteFailed.
  [[nodiscard]] std::optional<Result<std::string>> take();

 private:
  KeepPolicy policy_;
  std::future<Result<std::string>> under_way_;
};

}  // namespace biteline::record
