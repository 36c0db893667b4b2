// SPDX-License-Identifier: MIT
#pragma once
/// \file What the line's control reads of a cell: the same numbers in the same order for every door.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "host/interfaces/control/messages.hpp"

namespace biteline::line_control {

/// In the folder of results, for the service's user alone: which program is a door of the line's control.
inline constexpr const char* k_token_file = ".line.token";

/// What the cell is about.  Numbers are the doors'; they stay as they are once released, here and below.
enum class Step {
  Away = 0,  ///< the service does not answer
  Ready = 1,
  Scanning = 2,  ///< from the start that was taken to the scan's end
  Working = 3,
  Deciding = 4,  ///< a person must accept or reject the scan
  Following = 5,
  Stopped = 6,  ///< by a person; a person starts again
  Fault = 7,    ///< sensor or robot are not ready; the page says why
};

/// Of the last scan that is done.
enum class Verdict { None = 0, Ok = 1, Amber = 2, Refused = 3, Failed = 4, Review = 5 };

/// Why a command was not taken.
enum class Refusal {
  None = 0,         ///< it was
  UnknownJob = 1,   ///< no job of that number, or its model or process is gone
  NoJob = 2,        ///< choose one first
  Busy = 3,         ///< a scan is in work
  Deciding = 4,     ///< a scan waits for a person
  ControlHeld = 5,  ///< somebody at a page holds control
  Stopped = 6,      ///< a person stopped the cell and starts it again
  NotReady = 7,     ///< the sensor is away
  HostAway = 8,     ///< the service does not answer
  NotOpen = 9,      ///< the service runs without --jobs
  BadRequest = 10,  ///< a number out of range, or words that are none
};

/// Its one line for logs and pages.
[[nodiscard]] const char* words_of(Refusal refusal);

/// Since the service began; they wrap at 65536.
struct Counts {
  std::uint32_t starts{0}, ok{0}, amber{0}, refused{0}, failed{0}, review{0};
};

struct LineState {
  Step step{Step::Away};
  bool busy{false};
  bool done{false};  ///< the scan of request `finished` has its verdict, and no new one was started
  int job{0};        ///< chosen; 0: none
  int taken{0};      ///< number of the last start of the line's control; 0: none
  int finished{0};   ///< number of the start whose scan is done; 0: a page's, or nobody's
  Verdict verdict{Verdict::None};
  int model{0};  ///< the first job with the scan's model, foot and size; 0: none has them
  bool sent{false}, followed{false};
  int scan{0};  ///< 7 of scan-0007
  std::optional<double> length_mm{}, u95_mm{}, confidence{};
  Counts counts{};
  std::string part{};       ///< of the last scan that is done
  std::string next_part{};  ///< of the scan in work, else of the one that is started next
};

[[nodiscard]] control::Json to_json(const LineState& state);
/// Nothing: not a state of this program's.
[[nodiscard]] std::optional<LineState> line_state_of(const control::Json& json);

/// Input register i of Modbus, value i of the text protocol.
inline constexpr std::size_t k_values = 24;
inline constexpr int k_map_version = 1;
struct ValueRow {
  const char* name;
  const char* words;
};
[[nodiscard]] std::span<const ValueRow, k_values> value_rows();
/// `heartbeat` and `refusal` (of the last command) are the door's own.  What does not fit into 16 bits wraps.
[[nodiscard]] std::array<std::uint16_t, k_values> values_of(const LineState& state, std::uint16_t heartbeat,
                                                            Refusal refusal);

}  // namespace biteline::line_control
