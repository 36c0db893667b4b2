// SPDX-License-Identifier: MIT
#pragma once
/// \file Contracts: a broken one is a bug in this code, never the world's fault.  Always on, in every build.

namespace biteline {

/// Called once on a broken contract, before the process aborts.  Must neither allocate nor lock: the
/// firmware installs one that turns the laser off.
using ContractHandler = void (*)(const char* condition, const char* file, int line) noexcept;

void set_contract_handler(ContractHandler handler) noexcept;

[[noreturn]] void contract_broken(const char* condition, const char* file, int line) noexcept;

}  // namespace biteline

#define BITELINE_EXPECTS(condition) \
  ((condition) ? static_cast<void>(0) : ::biteline::contract_broken(#condition, __FILE__, __LINE__))
