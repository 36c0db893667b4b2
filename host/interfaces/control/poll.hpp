// SPDX-License-Identifier: MIT
#pragma once
/// \file Waiting for sockets and for a word of another thread at once.

#include <initializer_list>

#include "common/wire/socket.hpp"

namespace biteline::control {

/// Another thread's "there is something for you".  Move-only.
class Wake {
 public:
  [[nodiscard]] static Result<Wake> create();
  Wake(Wake&& other) noexcept;
  Wake& operator=(Wake&&) = delete;
  ~Wake();

  void ring() const;     ///< from any thread
  void silence() const;  ///< by the one that was woken, before it looks

  [[nodiscard]] int handle() const { return fd_; }

 private:
  explicit Wake(int fd) : fd_{fd} {}
  int fd_;
};

/// Returns when one of the sockets can be read, the wake was rung, or after `timeout`.
void wait_for(std::initializer_list<const wire::Socket*> sockets, const Wake& wake, Nanoseconds timeout);

}  // namespace biteline::control
