// SPDX-License-Identifier: MIT
#pragma once
/// \file Real-time set-up of the process and of each thread (Linux).

#include <sched.h>

#include <optional>
#include <utility>

#include "common/core/result.hpp"
#include "firmware/runtime/thread_table.hpp"

namespace biteline::runtime {

enum class RealtimeDemand {
  Required,  ///< no rights: refuse to run
  Ignored,   ///< run as any other program does
};

/// Before any thread starts: memory locked and never given back to the system, stack touched.  Errc::NoRights
/// names the limit to raise.
[[nodiscard]] Result<void> prepare_process(RealtimeDemand demand);

/// On the thread itself, first thing: name, scheduling policy, processor; then reads back what the kernel
/// really set. A processor that this machine lacks is left to the kernel (the table is for the target).
[[nodiscard]] Result<void> enter_thread(const ThreadSpec& spec, RealtimeDemand demand);

/// For a library that makes its own threads and does not ask: those that the calling thread makes while it
/// lends have its priority.
class LentPriority {
 public:
  [[nodiscard]] static Result<LentPriority> lend(const ThreadSpec& spec, RealtimeDemand demand);
  LentPriority(LentPriority&& other) noexcept : before_{std::exchange(other.before_, std::nullopt)} {}
  LentPriority& operator=(LentPriority&&) = delete;
  ~LentPriority();  ///< the calling thread is what it was

 private:
  struct Before {
    int policy{SCHED_OTHER};
    sched_param parameters{};
  };
  explicit LentPriority(const std::optional<Before>& before) : before_{before} {}
  std::optional<Before> before_;  ///< nothing: not lent
};

}  // namespace biteline::runtime
