// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/login_limit.hpp"

#include <algorithm>

namespace biteline::web {

void LoginLimit::fill(Bucket& bucket, Clock::time_point now, double most, double seconds_a_try) {
  const double passed_s = std::chrono::duration<double>(now - bucket.at).count();
  bucket.tries = std::min(most, bucket.tries + std::max(0.0, passed_s) / seconds_a_try);
  bucket.at = now;
}

LoginLimit::Bucket& LoginLimit::bucket_of(const std::string& address, Clock::time_point now) {
  if (!buckets_.contains(address) && buckets_.size() >= k_most_addresses) {
    for (auto& [name, bucket] : buckets_) fill(bucket, now, k_tries, k_seconds_a_try);
    buckets_.erase(
        std::ranges::max_element(buckets_, {}, [](const auto& entry) { return entry.second.tries; }));
  }
  Bucket& bucket = buckets_.try_emplace(address, Bucket{.tries = k_tries, .at = now}).first->second;
  fill(bucket, now, k_tries, k_seconds_a_try);
  fill(all_, now, k_tries_of_all, k_seconds_a_try_of_all);
  return bucket;
}

bool LoginLimit::take(const std::string& address, Clock::time_point now) {
  Bucket& bucket = bucket_of(address, now);
  if (bucket.tries < 1 || all_.tries < 1) return false;
  bucket.tries -= 1;
  all_.tries -= 1;
  return true;
}

void LoginLimit::give_back(const std::string& address, Clock::time_point now) {
  Bucket& bucket = bucket_of(address, now);
  bucket.tries = std::min(k_tries, bucket.tries + 1);
  all_.tries = std::min(k_tries_of_all, all_.tries + 1);
}

}  // namespace biteline::web
