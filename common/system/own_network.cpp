// SPDX-License-Identifier: MIT
#include "common/system/own_network.hpp"

#include <fcntl.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

namespace biteline {
namespace {

bool write_once(const char* file, const std::string& text) {
  const int descriptor = open(file, O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool written = write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  return close(descriptor) == 0 && written;
}

/// Whoever may not split the network may where he is master: in a user namespace with himself alone in it.
bool enter_own_users() {
  const std::string user = std::to_string(geteuid()), group = std::to_string(getegid());
  return unshare(CLONE_NEWUSER) == 0 && write_once("/proc/self/setgroups", "deny") &&
         write_once("/proc/self/uid_map", user + " " + user + " 1") &&
         write_once("/proc/self/gid_map", group + " " + group + " 1");
}

Result<void> raise_loopback() {
  ifreq loopback{};
  std::strcpy(loopback.ifr_name, "lo");
  loopback.ifr_flags = IFF_UP | IFF_RUNNING;
  const int any = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool up = any >= 0 && ioctl(any, SIOCSIFFLAGS, &loopback) == 0;
  const int number = errno;
  if (any >= 0) close(any);
  if (!up) return fail_errno(Errc::DeviceError, number, "the loopback of a network of its own");
  return {};
}

}  // namespace

Result<void> enter_own_network() {
  if (unshare(CLONE_NEWNET) != 0 && !(errno == EPERM && enter_own_users() && unshare(CLONE_NEWNET) == 0))
    return fail_errno(Errc::NotSupported, errno, "a network of its own");
  return raise_loopback();
}

}  // namespace biteline
