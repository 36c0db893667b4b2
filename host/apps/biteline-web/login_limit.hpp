// SPDX-License-Identifier: MIT
#pragma once
/// \file How often one may try to log in: guessing passwords must cost time, and hashing them is dear.

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

namespace biteline::web {

/// A bucket of tries for each address, and one for all together.  Thread: one owner.  Memory: at most
/// k_most_addresses entries; the fullest go first.
class LoginLimit {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr double k_tries = 5;          ///< at once, from one address
  static constexpr double k_seconds_a_try = 6;  ///< until one comes back
  static constexpr double k_tries_of_all = 30;  ///< at once
  static constexpr double k_seconds_a_try_of_all = 0.5;
  static constexpr std::size_t k_most_addresses = 1024;

  /// Takes one try; false: none is left.
  [[nodiscard]] bool take(const std::string& address, Clock::time_point now);
  /// A login that went well gives its try back: people who know their password are never held up.
  void give_back(const std::string& address, Clock::time_point now);

 private:
  struct Bucket {
    double tries{0};
    Clock::time_point at{};
  };
  static void fill(Bucket& bucket, Clock::time_point now, double most, double seconds_a_try);
  Bucket& bucket_of(const std::string& address, Clock::time_point now);

  std::map<std::string, Bucket> buckets_;
  Bucket all_{.tries = k_tries_of_all, .at = {}};
};

}  // namespace biteline::web
