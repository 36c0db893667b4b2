// SPDX-License-Identifier: MIT
#pragma once
/// \file The shoes that wait at the centre: each cell has places and a pace of its own, so that none takes
/// another's.

#include <chrono>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "host/fleet/centre.hpp"

namespace biteline::fleet {

/// What one cell may send on the whole.  A cell makes some shoes a minute; one that was away for a week
/// catches up at this pace.
inline constexpr double k_rows_a_minute = 600;
inline constexpr double k_rows_at_once = 3000;
/// Of one cell; an uplink has at most 100 on the way.
inline constexpr std::size_t k_most_waiting_of_one = 200;
/// Cells come by their certificates; more than that is no factory.
inline constexpr std::size_t k_most_cells_heard = 10'000;

/// Thread: one owner.
class Intake {
 public:
  using Clock = std::chrono::steady_clock;

  /// What finds no place is dropped: its cell sends it again, and is told why by held_words().
  void put(FromCell shoe, Clock::time_point now);
  /// At most so many, of each cell in turn, each cell's in its order.
  [[nodiscard]] std::vector<FromCell> take(std::size_t most);
  [[nodiscard]] bool empty() const { return waiting_ == 0; }
  /// Why this cell's rows come later; empty: they do not.
  [[nodiscard]] std::string held_words(const std::string& cell, Clock::time_point now) const;
  /// Forgets what waits, not who was too quick.
  void clear();

 private:
  struct OfCell {
    std::deque<FromCell> shoes{};
    double may{k_rows_at_once};  ///< rows
    Clock::time_point filled{};
    Clock::time_point held_at{};  ///< when a row found no place
    bool held{false};
  };
  std::map<std::string, OfCell> cells_;
  std::string turn_;  ///< the cell that was served last
  std::size_t waiting_{0};
};

}  // namespace biteline::fleet
