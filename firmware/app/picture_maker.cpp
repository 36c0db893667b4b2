// SPDX-License-Identifier: MIT
#include "firmware/app/picture_maker.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "firmware/app/picture.hpp"

namespace biteline::sensor {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Between two looks at the tap while somebody watches, and while nobody does.
constexpr milliseconds k_look = milliseconds{4};
constexpr milliseconds k_idle_look = milliseconds{20};
/// Sleeps so many times as long as it worked.
constexpr int k_rest = 3;

Clock::duration period_of(const wire::PictureWish& wish) {
  const double rate_hz = std::min(wish.rate_hz, wire::k_max_picture_rate_hz);
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{1 / rate_hz});
}

}  // namespace

PictureMaker::~PictureMaker() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

void PictureMaker::start() {
  thread_ = std::thread{[this] {
    // Without the rights no thread of this program runs: whoever needs them says so.
    if (runtime::enter_thread(runtime::threads::k_picture, realtime_)) run();
  }};
}

bool PictureMaker::try_order(const Order& order) {
  const std::unique_lock lock{mutex_, std::try_to_lock};
  if (!lock) return false;
  order_ = order;
  order_changed_ = true;
  done_.clear();
  return true;
}

std::vector<stream::MadePicture> PictureMaker::try_take() {
  const std::unique_lock lock{mutex_, std::try_to_lock};
  if (!lock) return {};
  return std::exchange(done_, {});
}

void PictureMaker::run() {
  std::vector<Due> due;
  Order order;
  while (!stopping_) {
    follow_order(due, order);
    const Clock::time_point begin = Clock::now();
    const bool worked = order.tap != nullptr && !due.empty() && make_due(due, order);
    const Clock::duration took = Clock::now() - begin;
    const Clock::duration look = order.tap == nullptr || due.empty() ? k_idle_look : k_look;
    std::this_thread::sleep_for(worked ? std::max(look, k_rest * took) : look);
  }
}

void PictureMaker::follow_order(std::vector<Due>& due, Order& order) {
  const std::lock_guard lock{mutex_};
  if (!order_changed_) return;
  order_changed_ = false;
  order = order_;
  if (order.tap != nullptr) (void)order.tap->rt_take();  // of whoever watched before
  std::vector<Due> fresh;
  for (const wire::PictureWish& wish : order.wishes) {
    const auto known = std::ranges::find(due, wish, &Due::wish);
    fresh.push_back(known != due.end() ? *known : Due{.wish = wish, .next = Clock::now()});
  }
  due = std::move(fresh);
}

bool PictureMaker::make_due(std::vector<Due>& due, const Order& order) {
  const Clock::time_point now = Clock::now();
  if (std::ranges::none_of(due, [&](const Due& one) { return one.next <= now; })) return false;
  const pipeline::TappedPicture* tapped = order.tap->rt_take();
  if (tapped == nullptr) {
    order.tap->rt_want();
    return false;
  }
  for (Due& one : due) {
    if (one.next > now) continue;
    // A little lateness is made good, a pause is not caught up with.
    one.next = std::max(one.next + period_of(one.wish), now);
    Result<wire::Picture> picture = make_picture(*tapped, order.tap->region(), one.wish);
    if (!picture) continue;  // a region that the camera does not show now
    stream::MadePicture made{.wish = one.wish, .scan_id = order.scan_id, .packet = {}};
    wire::encode({.scan_id = order.scan_id, .body = std::move(*picture)}, made.packet);
    hand_out(std::move(made));
  }
  return true;
}

void PictureMaker::hand_out(stream::MadePicture made) {
  const std::lock_guard lock{mutex_};
  if (order_changed_) return;  // of an older order
  made_.fetch_add(1, std::memory_order_relaxed);
  const auto older = std::ranges::find(done_, made.wish, &stream::MadePicture::wish);
  if (older != done_.end()) {
    *older = std::move(made);
  } else {
    done_.push_back(std::move(made));
  }
}

}  // namespace biteline::sensor
