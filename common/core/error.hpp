// SPDX-License-Identifier: MIT
#pragma once
/// \file The one error type of the tree, and the table that turns a code into words for an operator.

#include <cstdint>
#include <span>
#include <string>

#include "common/core/fixed_text.hpp"

namespace biteline {

/// Exit status of every program (see README, "Exit status").
enum class ExitStatus : int { Done = 0, BadInput = 2, Refused = 3, Connection = 4, Review = 5 };

/// Ranges: 1xx use, 2xx files and their contents, 3xx readable input without a trustworthy result,
/// 4xx devices and connections, 5xx real time and safety.  `error_table()` has a row for each.
enum class Errc : std::uint16_t {
  InvalidArgument = 100,
  WrongState = 101,
  NotSupported = 102,

  FileNotFound = 200,
  FileUnreadable = 201,
  BadFormat = 202,
  BadValue = 203,
  UnknownKey = 204,
  Truncated = 205,
  SizeMismatch = 206,
  WriteFailed = 207,
  DiskFull = 208,

  Refused = 300,
  NotConverged = 301,
  Degenerate = 302,
  OutOfReach = 303,
  CheckFailed = 304,

  DeviceNotFound = 400,
  DeviceLost = 401,
  DeviceError = 402,
  Timeout = 403,
  ConnectFailed = 404,
  ConnectionLost = 405,
  ProtocolError = 406,
  AuthenticationFailed = 407,
  PeerRefused = 408,
  ProcessDied = 409,

  NoRights = 500,
  Overrun = 501,
  PoseStale = 502,
  InterlockOpen = 503,
  ContractBroken = 504,
};

/// A failure that the world caused: what, and where.  Trivially copyable; building one allocates nothing.
struct Error {
  Errc code{Errc::InvalidArgument};
  int sys_errno{0};      ///< errno of the failing call, 0 when there was none
  int more_faults{0};    ///< further faults of the same input beyond the one told
  FixedText<256> where;  ///< file, row, field, what was expected; or device and call
};

struct ErrorRow {
  Errc code;
  const char* message;
  const char* action;  ///< the one step an operator can take
  ExitStatus exit_status;
};

/// One row for every Errc.
[[nodiscard]] std::span<const ErrorRow> error_table();

/// The row of `code`.  Pre: the code is in the table (a test walks it).
[[nodiscard]] const ErrorRow& error_row(Errc code);

/// One line: "<where>: <message> (errno text) (and N more faults)".
[[nodiscard]] std::string to_line(const Error& error);

}  // namespace biteline
