// SPDX-License-Identifier: MIT
#pragma once
/// \file How a program ends that has no memory or no threads left: one line and exit status 4, no core dump.

namespace biteline {

/// To be called first in main(); `program` must live as long as the process.  Exceptions that nobody catches,
/// in whatever thread, then end the process by one line on stderr, after the contract handler (contracts.hpp)
/// has made the machine safe.  Lines for systemd's journal get their priority (journal.hpp).  So does abort()
/// in a library; a broken contract still ends by its signal.
void install_last_words(const char* program) noexcept;

}  // namespace biteline
