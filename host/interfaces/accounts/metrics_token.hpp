// SPDX-License-Identifier: MIT
#pragma once
/// \file The token that a Prometheus reads the metrics with, and nothing else: made and dropped by a command,
/// also while a service runs, which heeds it at once.  One at a time; kept hashed.

#include <filesystem>
#include <string>

#include "host/interfaces/accounts/accounts.hpp"

namespace biteline::accounts {

/// The one in `token_file`, so that many cells have the same; without such a file a new one is made and
/// written there, for its owner alone.  The one before ends.  `memory`: the file of the accounts; who can
/// write it can do more than this, so its rights decide here.  Errc::BadFormat: the file holds something
/// else.
[[nodiscard]] Result<void> use_metrics_token(const std::filesystem::path& memory,
                                             const std::filesystem::path& token_file);
/// Errc::FileNotFound: there is none.
[[nodiscard]] Result<void> drop_metrics_token(const std::filesystem::path& memory);

/// With that token, or with the one of somebody who is logged in.
[[nodiscard]] Result<bool> may_read_metrics(const memory::Memory& memory, const Accounts& accounts,
                                            const std::string& token);

}  // namespace biteline::accounts
