// SPDX-License-Identifier: MIT
#pragma once
/// \file What a controller tells, unasked, to who connects to its primary or secondary interface.

#include <chrono>
#include <optional>
#include <span>
#include <vector>

#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {

/// By a connection of its own; nothing is sent.  `find` looks through what has come so far; `what`: for the
/// Errc::Timeout where it was not among it within `patience`.
template <class Told>
[[nodiscard]] Result<Told> hear_primary(const Endpoint& at, Nanoseconds patience, const char* what,
                                        Result<std::optional<Told>> (*find)(std::span<const std::uint8_t>)) {
  constexpr std::size_t k_most_heard = 1U << 20U;  // some seconds of states
  const auto until = std::chrono::steady_clock::now() + patience;
  BITELINE_ASSIGN(TcpStream stream, TcpStream::connect(at, patience));
  std::vector<std::uint8_t> heard, some;
  for (;;) {
    const Nanoseconds left{until - std::chrono::steady_clock::now()};
    if (left <= Nanoseconds{0} || heard.size() > k_most_heard) {
      return fail(Errc::Timeout, "%.60s:%u: the controller does not tell %s", at.host.c_str(),
                  static_cast<unsigned>(at.port), what);
    }
    BITELINE_TRY(stream.read_some(some, left));
    heard.insert(heard.end(), some.begin(), some.end());
    BITELINE_ASSIGN(std::optional<Told> told, find(heard));
    if (told) return *told;
  }
}

}  // namespace biteline::robot::ur
