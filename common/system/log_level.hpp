// SPDX-License-Identifier: MIT
#pragma once
/// \file How urgent a line of a program's output is, for systemd's journal.

namespace biteline {

/// syslog's numbers.
enum class LogLevel { Error = 3, Warning = 4, Info = 6 };

/// "<4>" before a line where `fd` leads to the journal, so that `journalctl -p warning` finds it; empty
/// where a person or a file reads it.  systemd tells by JOURNAL_STREAM which stream is its own (sd-daemon(3),
/// systemd.exec(5)).
[[nodiscard]] const char* level_prefix(int fd, LogLevel level);

}  // namespace biteline
