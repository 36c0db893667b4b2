// SPDX-License-Identifier: MIT
#include "host/fleet/idle_disk.hpp"

#include <CppUTest/TestHarness.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace biteline::fleet {
namespace {

constexpr int k_who_process = 1, k_class_idle = 3, k_class_shift = 13;

long own_priority() {
  return ::syscall(SYS_ioprio_get, k_who_process, 0);
}

}  // namespace

TEST_GROUP(IdleDisk){};

TEST(IdleDisk, IsIdleOnlyWhileItLives) {
  const long before = own_priority();
  {
    const IdleDisk idle;
    LONGS_EQUAL(k_class_idle, own_priority() >> k_class_shift);
  }
  LONGS_EQUAL(before, own_priority());
}

}  // namespace biteline::fleet
