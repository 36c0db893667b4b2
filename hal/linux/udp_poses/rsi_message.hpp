// SPDX-License-Identifier: MIT
#pragma once
/// \file KUKA RSI: the actual pose in one message of the controller (an XML text), and the answer to it.
///
/// `<Rob Type="KUKA"><RIst X=".." Y=".." Z=".." A=".." B=".." C=".."/>...<IPOC>123</IPOC></Rob>`.  Read are
/// RIst and IPOC, whatever else the controller is set up to send; attributes in any order.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "common/core/result.hpp"
#include "hal/linux/udp_poses/told_pose.hpp"

namespace biteline::hal {

/// The flange in base where the program runs with tool $NULLFRAME and base $WORLD or $ROBROOT: mm, and
/// degrees about Z, then Y', then X'' (A, B, C).  IPOC is both stamp (ms) and what an answer repeats.
/// Errc::ProtocolError: no such text; Errc::BadFormat: it has no RIst or no IPOC; Errc::BadValue: numbers
/// that are no pose.  Memory: none.
[[nodiscard]] Result<ToldPose> read_rsi(std::span<const std::uint8_t> message);

/// The shortest answer, without any correction: its IPOC is that of the message, its type that of the maker's
/// own example (SENTYPE ImFree).
class RsiAnswer {
 public:
  explicit RsiAnswer(RobotClock::time_point stamp);
  [[nodiscard]] std::string_view text() const { return {text_.data(), size_}; }

 private:
  std::array<char, 96> text_{};
  std::size_t size_{0};
};

}  // namespace biteline::hal
