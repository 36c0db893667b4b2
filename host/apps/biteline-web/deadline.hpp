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
      : timer_{stream.get_executor(), time}, state_{std::make_shared<State>()} {
    timer_.async_wait([state = state_, &stream](ErrorCode fault) {
      // A timer that ran out just before its end can no longer be cancelled: the stream may be gone.
      if (fault || state->ended) return;
      state->over = true;
      stream.next_layer().cancel(fault);
    });
  }
  ~Deadline() { state_->ended = true; }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;
  [[nodiscard]] bool over() const { return state_->over; }

 private:
  struct State {
    bool over{false};
    bool ended{false};
  };

  net::steady_timer timer_;
  std::shared_ptr<State> state_;
};

}  // namespace biteline::web
