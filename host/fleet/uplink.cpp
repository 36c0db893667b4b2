// SPDX-License-Identifier: MIT
#include "host/fleet/uplink.hpp"

#include <algorithm>

namespace biteline::fleet {

void Uplink::use_book(const std::string& book) {
  if (book == book_) return;
  book_ = book;
  committed_.reset();
}

void Uplink::hear(const CommittedMessage& message, Clock::time_point now) {
  if (message.book != book_) return;
  // Lower than before: the database was put back to an older one, which wants all since then again.
  if (!committed_ || message.seq < *committed_) {
    committed_ = sent_ = message.seq;
    on_the_way_ = 0;
    progress_ = now;
    return;
  }
  if (message.seq == *committed_) return;
  committed_ = message.seq;
  progress_ = now;
  // Numbers have gaps, so this counts too many rather than too few as still on the way, until all have come.
  on_the_way_ = static_cast<int>(std::clamp<std::int64_t>(sent_ - *committed_, 0, on_the_way_));
  sent_ = std::max(sent_, *committed_);
}

std::optional<std::int64_t> Uplink::next(Clock::time_point now) {
  if (!committed_) return std::nullopt;
  if (sent_ > *committed_ && now - progress_ > k_patience) {
    sent_ = *committed_;
    on_the_way_ = 0;
    progress_ = now;
  }
  if (room() <= 0) return std::nullopt;
  return sent_;
}

void Uplink::sent(std::int64_t seq, Clock::time_point now) {
  // The wait for the first of them begins; later ones do not put it off.
  if (on_the_way_ == 0) progress_ = now;
  sent_ = seq;
  ++on_the_way_;
}

}  // namespace biteline::fleet
