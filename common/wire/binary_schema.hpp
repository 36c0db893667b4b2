// SPDX-License-Identifier: MIT
#pragma once
/// \file protocol.fbs in FlatBuffers' binary form: with it any program can take the messages apart.

#include <cstdint>
#include <span>

namespace biteline::wire {

[[nodiscard]] std::span<const std::uint8_t> binary_schema();

}  // namespace biteline::wire
