// SPDX-License-Identifier: MIT
#pragma once
/// \file The contract handler (contracts.hpp) for other ways to die.

namespace biteline {

/// Calls the handler, at most once in the life of the process.
void make_safe(const char* condition, const char* file, int line) noexcept;

}  // namespace biteline
