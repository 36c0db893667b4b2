// SPDX-License-Identifier: MIT
#include "host/fleet/idle_disk.hpp"

#include <sys/syscall.h>
#include <unistd.h>

namespace biteline::fleet {
namespace {

// The C library has no names for these, and newer kernels' <linux/ioprio.h> is no C++.
constexpr int k_who_process = 1, k_class_idle = 3, k_class_shift = 13;

int own_priority() {
  return static_cast<int>(::syscall(SYS_ioprio_get, k_who_process, 0));
}
bool set_own_priority(int priority) {
  return ::syscall(SYS_ioprio_set, k_who_process, 0, priority) == 0;
}

}  // namespace

IdleDisk::IdleDisk() : before_{own_priority()} {
  if (before_ >= 0 && !set_own_priority(k_class_idle << k_class_shift)) before_ = -1;
}

IdleDisk::~IdleDisk() {
  if (before_ >= 0) set_own_priority(before_);
}

}  // namespace biteline::fleet
