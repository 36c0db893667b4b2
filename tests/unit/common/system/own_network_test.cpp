// SPDX-License-Identifier: MIT
#include "common/system/own_network.hpp"

#include <CppUTest/TestHarness.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "tests/support/errors.hpp"

namespace biteline {
namespace {

/// A UDP socket on the loopback; 0: any port.  -1 where another holds it, or the loopback is down.
int bound_to(std::uint16_t port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return descriptor;
  close(descriptor);
  return -1;
}

std::uint16_t port_of(int descriptor) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

bool hears_itself(int descriptor) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
  char letter = 'x';
  return sendto(descriptor, &letter, 1, 0, reinterpret_cast<const sockaddr*>(&address), size) == 1 &&
         recv(descriptor, &letter, 1, MSG_DONTWAIT) == 1;
}

enum : int { Good = 0, NotPermitted = 1, Busy = 2, Deaf = 3, OtherUser = 4 };

/// In a process of its own: nobody comes back from another network.
int in_child(std::uint16_t port) {
  const uid_t user = geteuid();
  if (const Result<void> own = enter_own_network(); !own) return NotPermitted;
  if (geteuid() != user) return OtherUser;
  const int descriptor = bound_to(port);
  if (descriptor < 0) return Busy;
  return hears_itself(descriptor) ? Good : Deaf;
}

}  // namespace

TEST_GROUP(OwnNetwork){};

TEST(OwnNetwork, FreesAPortThatAnotherHoldsAndHasALoopback) {
  const int held = bound_to(0);
  CHECK(held >= 0);
  CHECK(bound_to(port_of(held)) < 0);
  for (const bool as_root : {true, false}) {
    if (as_root && geteuid() != 0) continue;
    const pid_t child = fork();
    if (child == 0) {
      constexpr uid_t k_nobody = 65534;
      // Who has changed his user may not read his own /proc until he says so.
      if (!as_root && geteuid() == 0 &&
          (setgid(k_nobody) != 0 || setuid(k_nobody) != 0 || prctl(PR_SET_DUMPABLE, 1) != 0))
        _exit(OtherUser);
      _exit(in_child(port_of(held)));
    }
    int status = 0;
    LONGS_EQUAL(child, waitpid(child, &status, 0));
    CHECK(WIFEXITED(status));
    if (WEXITSTATUS(status) == NotPermitted) {
      std::printf("skipped: the kernel gives %s no network of its own\n",
                  as_root ? "root" : "an ordinary user");
      continue;
    }
    LONGS_EQUAL(Good, WEXITSTATUS(status));
  }
  close(held);
}

}  // namespace biteline
