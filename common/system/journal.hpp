// SPDX-License-Identifier: MIT
#pragma once
/// \file Severity of what a program says, where systemd's journal takes it.

namespace biteline {

/// Where stdout or stderr go into the journal (JOURNAL_STREAM names them), each line gets its priority from
/// now on, as sd-daemon(3) has it: stderr "<3>" (error), stdout "<6>" (info), and "<4>" (warning) a line that
/// begins with "refused".  So `journalctl -p warning` finds what went wrong.  Elsewhere nothing changes.
/// Before threads begin.
void mark_for_journal();

}  // namespace biteline
