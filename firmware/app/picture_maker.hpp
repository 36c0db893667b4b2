// SPDX-License-Identifier: MIT
#pragma once
/// \file The picture thread: takes frames from the tap at the pace that observers ask for, and packs them.

#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "firmware/pipeline/picture_tap.hpp"
#include "firmware/runtime/realtime.hpp"
#include "firmware/stream/observers.hpp"

namespace biteline::sensor {

/// Neither the acquisition thread nor the stream thread ever waits for it: the first sees a flag in the tap,
/// the second only tries the lock.  It sleeps three times as long as it worked, so that many wishes cost
/// pictures and not processor time.
class PictureMaker {
 public:
  /// What is wanted now, and of which scan.
  struct Order {
    std::shared_ptr<pipeline::PictureTap> tap;  ///< null: no scan is on
    std::uint64_t scan_id{0};
    std::vector<wire::PictureWish> wishes;
  };

  explicit PictureMaker(runtime::RealtimeDemand realtime) : realtime_{realtime} {}
  ~PictureMaker();
  PictureMaker(const PictureMaker&) = delete;
  PictureMaker& operator=(const PictureMaker&) = delete;

  void start();

  /// False: the maker is at its list just now; try again later.
  [[nodiscard]] bool try_order(const Order& order);
  /// What was made since the last call; at most one for each wish, the newest.
  [[nodiscard]] std::vector<stream::MadePicture> try_take();

  [[nodiscard]] std::uint64_t made() const { return made_.load(std::memory_order_relaxed); }

 private:
  struct Due {
    wire::PictureWish wish;
    std::chrono::steady_clock::time_point next;
  };
  void run();
  void follow_order(std::vector<Due>& due, Order& order);
  /// The work of one turn; false: nothing was there to be done.
  bool make_due(std::vector<Due>& due, const Order& order);
  void hand_out(stream::MadePicture made);

  runtime::RealtimeDemand realtime_;
  std::thread thread_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::uint64_t> made_{0};
  std::mutex mutex_;  ///< of the two below
  Order order_;
  bool order_changed_{false};
  std::vector<stream::MadePicture> done_;
};

}  // namespace biteline::sensor
