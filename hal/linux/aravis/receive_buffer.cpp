// SPDX-License-Identifier: MIT
#include "hal/linux/aravis/receive_buffer.hpp"

#include <dirent.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdlib>
#include <memory>

namespace biteline::hal {
namespace {

bool is_udp_at(int descriptor, std::uint16_t port) {
  int type = 0;
  socklen_t type_size = sizeof type;
  if (getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &type_size) != 0 || type != SOCK_DGRAM) return false;
  sockaddr_in local{};
  socklen_t local_size = sizeof local;
  return getsockname(descriptor, reinterpret_cast<sockaddr*>(&local), &local_size) == 0 &&
         local.sin_family == AF_INET && ntohs(local.sin_port) == port;
}

}  // namespace

Result<int> enlarge_receive_buffer(std::uint16_t port, int bytes) {
  const std::unique_ptr<DIR, int (*)(DIR*)> open_files{opendir("/proc/self/fd"), closedir};
  while (const dirent* entry = open_files ? readdir(open_files.get()) : nullptr) {
    const int descriptor = std::atoi(entry->d_name);  // "." and "..": 0, which is looked at anyway
    if (!is_udp_at(descriptor, port)) continue;
    if (setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0)
      (void)setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    int room_bytes = 0;
    socklen_t room_size = sizeof room_bytes;
    if (getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &room_bytes, &room_size) == 0) return room_bytes;
  }
  return fail(Errc::DeviceError, "receive buffer: this program has no UDP socket at port %d", int{port});
}

}  // namespace biteline::hal
