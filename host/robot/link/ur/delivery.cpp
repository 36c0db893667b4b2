// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/delivery.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

namespace biteline::robot::ur {
namespace {

// A door that refuses is asked again so soon.
constexpr Nanoseconds k_again{10'000'000};

}  // namespace

void Delivery::push() {
  if (gone_) return;
  if (!std::exchange(looked_, true)) static_cast<void>(stream_.lives());
  if (!stream_.is_open()) {
    Result<TcpStream> begun = TcpStream::begin(at_);
    if (!begun) {
      error_ = begun.error();
      return;
    }
    stream_ = std::move(*begun);
    fresh_ = true;
    sent_ = 0;
  }
  const Result<std::size_t> sent = stream_.write_now(std::string_view{text_}.substr(sent_));
  if (sent) sent_ += *sent;
  gone_ = sent_ == text_.size();
  if (gone_) return;
  if (!sent) error_ = sent.error();
  if (sent && fresh_) return;
  // A kept connection that is full stays full for as long as its peer does not read.
  stream_.close();
  if (!fresh_) push();
}

Result<void> deliver(std::span<Delivery> words, Nanoseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  const auto all_gone = [&] { return std::ranges::all_of(words, &Delivery::gone); };
  while (true) {
    for (Delivery& word : words) word.push();
    const Nanoseconds left = deadline - std::chrono::steady_clock::now();
    if (all_gone() || left <= Nanoseconds{0}) break;
    std::vector<int> waiting;
    bool refused = false;
    for (const Delivery& word : words) {
      if (word.gone()) continue;
      if (word.socket() < 0)
        refused = true;
      else
        waiting.push_back(word.socket());
    }
    // Where one was refused, or closed just now, the next turn connects anew.
    if (refused) {
      std::this_thread::sleep_for(std::min(left, k_again));
    } else {
      wait_for_room(waiting, left);
    }
  }
  for (const Delivery& word : words) {
    if (word.gone()) continue;
    if (word.error()) return tl::unexpected<Error>{*word.error()};
    return fail(Errc::Timeout, "robot: a word that stops the arm does not leave");
  }
  return {};
}

}  // namespace biteline::robot::ur
