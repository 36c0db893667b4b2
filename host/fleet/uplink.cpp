// SPDX-License-Identifier: MIT
#include "host/fleet/uplink.hpp"

#include <algorithm>

namespace biteline::fleet {

void Uplink::use_book(const std::string& book) {
  if (book == book_) return;
  book_ = book;
  committed_.reset();
  in_vain_ = 0;
}

void Uplink::hear(const CommittedMessage& message, Clock::time_point now) {
  if (message.book != book_) return;
  // Lower than before: the database was put back to an older one, which wants all since then again.
  if (!committed_ || message.seq < *committed_) {
    committed_ = sent_ = message.seq;
    on_the_way_ = in_vain_ = 0;
    progress_ = now;
    return;
  }
  // One that takes rows later, and says so, refuses none.
  answered_ = message.held.empty();
  if (message.seq == *committed_) return;
  committed_ = message.seq;
  in_vain_ = 0;
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
    // A centre that is away or without its database says nothing: then nothing is wrong with the row.
    in_vain_ = answered_ ? in_vain_ + 1 : 0;
    answered_ = false;
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
