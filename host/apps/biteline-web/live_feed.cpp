// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/live_feed.hpp"

#include <utility>

namespace biteline::web {
namespace {

constexpr std::size_t index_of(LiveKind kind) {
  return static_cast<std::size_t>(kind);
}

/// Calls `use` with each that lives and forgets the others.
template <class Queue, class Use>
int for_each(std::vector<std::weak_ptr<Queue>>& queues, Use use) {
  std::erase_if(queues, [](const auto& queue) { return queue.expired(); });
  for (const auto& entry : queues) {
    if (const auto queue = entry.lock()) use(*queue);
  }
  return static_cast<int>(queues.size());
}

}  // namespace

void LiveQueue::put(LiveKind kind, LiveBytes bytes) {
  if (kind == LiveKind::Cloud) {
    if (pieces_.size() >= k_most_pieces) {
      pieces_.pop_front();
      ++skipped_;
    }
    pieces_.push_back(std::move(bytes));
  } else {
    LiveBytes& slot = newest_[index_of(kind)];
    if (slot) ++skipped_;
    slot = std::move(bytes);
  }
  wake_();
}

LiveBytes LiveQueue::take() {
  for (std::size_t tried = 0; tried < k_live_kinds; ++tried) {
    turn_ = (turn_ + 1) % k_live_kinds;
    if (turn_ == index_of(LiveKind::Cloud) && !pieces_.empty()) {
      LiveBytes bytes = std::move(pieces_.front());
      pieces_.pop_front();
      return bytes;
    }
    if (newest_[turn_]) return std::exchange(newest_[turn_], nullptr);
  }
  return nullptr;
}

void EventQueue::put(std::shared_ptr<const std::string> text) {
  if (waiting_.size() >= k_most_waiting) waiting_.pop_front();
  waiting_.push_back(std::move(text));
  wake_();
}

std::shared_ptr<const std::string> EventQueue::take() {
  if (waiting_.empty()) return nullptr;
  auto text = std::move(waiting_.front());
  waiting_.pop_front();
  return text;
}

void LiveFeed::add(const std::shared_ptr<LiveQueue>& queue) {
  live_.push_back(queue);
  for (const LiveBytes& piece : cloud_) queue->put(LiveKind::Cloud, piece);
  for (std::size_t kind = 0; kind < k_live_kinds; ++kind) {
    if (newest_[kind]) queue->put(static_cast<LiveKind>(kind), newest_[kind]);
  }
}

void LiveFeed::add(const std::shared_ptr<EventQueue>& queue) {
  events_.push_back(queue);
}

void LiveFeed::publish(LiveKind kind, LiveBytes bytes) {
  ++published_[index_of(kind)];
  for_each(live_, [&](LiveQueue& queue) { queue.put(kind, bytes); });
  if (kind == LiveKind::Cloud) {
    if (cloud_.size() >= LiveQueue::k_most_pieces) cloud_.pop_front();
    cloud_.push_back(std::move(bytes));
  } else if (kind != LiveKind::Sensor) {
    // The sensor's own word, of its laser too, holds for now alone: it comes again by itself or it is lost.
    newest_[index_of(kind)] = std::move(bytes);
  }
}

void LiveFeed::publish_event(std::string text) {
  const auto shared = std::make_shared<const std::string>(std::move(text));
  for_each(events_, [&](EventQueue& queue) { queue.put(shared); });
}

void LiveFeed::forget_scan() {
  cloud_.clear();
  newest_[index_of(LiveKind::Line)] = nullptr;
}

int LiveFeed::watchers() {
  return for_each(live_, [](LiveQueue& /*queue*/) {});
}

int LiveFeed::listeners() {
  return for_each(events_, [](EventQueue& /*queue*/) {});
}

}  // namespace biteline::web
