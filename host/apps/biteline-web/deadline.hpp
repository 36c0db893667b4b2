// SPDX-License-Identifier: MIT
#pragma once
/// \file A time limit for what a stream waits for.

#include <chrono>
#include <memory>

#include "host/apps/biteline-web/web_stream.hpp"

namespace biteline::web {

/// Cancels what the stream waits for when the time is over.
class Deadline {
 public:
  Deadline(WebStream& stream, std::chrono::milliseconds time)
      : timer_{stream.get_executor(), time}, over_{std::make_shared<bool>(false)} {
    timer_.async_wait([over = over_, &stream](ErrorCode fault) {
      if (fault) return;  // cancelled: the stream may be gone
      *over = true;
      stream.next_layer().cancel(fault);
    });
  }
  [[nodiscard]] bool over() const { return *over_; }

 private:
  net::steady_timer timer_;
  std::shared_ptr<bool> over_;
};

}  // namespace biteline::web
