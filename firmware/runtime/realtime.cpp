// SPDX-License-Identifier: MIT
#include "firmware/runtime/realtime.hpp"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

namespace biteline::runtime {
namespace {

/// Deepest stack of our threads, twice: a page first touched in the hot path costs a fault there.
constexpr std::size_t k_prefault_bytes = 256 * 1024;

void prefault_stack() {
  volatile std::byte stack[k_prefault_bytes];
  for (std::size_t i = 0; i < sizeof stack; i += 1024) stack[i] = std::byte{0};
}

Result<void> pin(const ThreadSpec& spec) {
  if (spec.cpu < 0 || spec.cpu >= sysconf(_SC_NPROCESSORS_ONLN)) return {};
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(spec.cpu), &set);
  const int error = pthread_setaffinity_np(pthread_self(), sizeof set, &set);
  if (error != 0) return fail_errno(Errc::NoRights, error, "thread %s: processor %d", spec.name, spec.cpu);
  return {};
}

/// Threads that a library starts from this one inherit it.  They have short turns, and a killed process lets
/// go of its lines only when its last thread is gone: an ordinary one would wait for every program beside
/// first.
Result<void> schedule(const ThreadSpec& spec) {
  constexpr int policy = SCHED_FIFO;
  sched_param wanted{};
  wanted.sched_priority = spec.priority;
  const int error = pthread_setschedparam(pthread_self(), policy, &wanted);
  if (error != 0) {
    return fail_errno(Errc::NoRights, error, "thread %s: SCHED_FIFO %d (LimitRTPRIO, or --rt=ignore)",
                      spec.name, spec.priority);
  }
  int got_policy = -1;
  sched_param got{};
  pthread_getschedparam(pthread_self(), &got_policy, &got);
  if (got_policy != policy || got.sched_priority != spec.priority) {
    return fail(Errc::NoRights, "thread %s: the kernel set priority %d instead of %d", spec.name,
                got.sched_priority, spec.priority);
  }
  return {};
}

}  // namespace

Result<void> prepare_process(RealtimeDemand demand) {
  if (demand == RealtimeDemand::Ignored) return {};
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    return fail_errno(Errc::NoRights, errno, "mlockall (LimitMEMLOCK, or --rt=ignore)");
  }
  prefault_stack();
  return {};
}

Result<void> enter_thread(const ThreadSpec& spec, RealtimeDemand demand) {
  pthread_setname_np(pthread_self(), spec.name);
  if (demand == RealtimeDemand::Ignored) return {};
  BITELINE_TRY(pin(spec));
  BITELINE_TRY(schedule(spec));
  prefault_stack();
  return {};
}

Result<LentPriority> LentPriority::lend(const ThreadSpec& spec, RealtimeDemand demand) {
  if (demand == RealtimeDemand::Ignored) return LentPriority{std::nullopt};
  Before before;
  pthread_getschedparam(pthread_self(), &before.policy, &before.parameters);
  BITELINE_TRY(schedule(spec));
  return LentPriority{before};
}

LentPriority::~LentPriority() {
  if (before_) pthread_setschedparam(pthread_self(), before_->policy, &before_->parameters);
}

}  // namespace biteline::runtime
