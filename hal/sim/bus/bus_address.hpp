// SPDX-License-Identifier: MIT
#pragma once
/// \file A name in the abstract namespace of local sockets.

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>

namespace biteline::sim {

/// Cut to what a socket address holds (107 characters).
class BusAddress {
 public:
  explicit BusAddress(const std::string& name) {
    address_.sun_family = AF_UNIX;
    length_ = std::min(name.size(), sizeof address_.sun_path - 1);
    std::memcpy(address_.sun_path + 1, name.data(), length_);  // a leading 0: abstract
  }
  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address_); }
  [[nodiscard]] socklen_t size() const { return static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length_); }

 private:
  sockaddr_un address_{};
  std::size_t length_{0};
};

}  // namespace biteline::sim
