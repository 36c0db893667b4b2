// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/told_once.hpp"

#include <algorithm>
#include <chrono>

namespace biteline::service {
namespace {

constexpr Nanoseconds k_first_wait = std::chrono::seconds{2};
constexpr Nanoseconds k_longest_wait = std::chrono::minutes{1};
/// Ten of the longest waits without a word: whatever comes next is new.
constexpr Nanoseconds k_over = 10 * k_longest_wait;

/// One mark for each figure, with its sign and its point.
std::string without_figures(const std::string& words) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::string same;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool point = words[i] == '.' && i + 1 < words.size() && is_digit(words[i + 1]);
    if (!is_digit(words[i]) && !(point && same.ends_with('#'))) {
      same += words[i];
    } else if (!same.ends_with('#')) {
      same += '#';
    }
  }
  return same;
}

}  // namespace

ToldOnce::Heard ToldOnce::hear(const std::string& words, HostClock::time_point now) {
  forget_old(now);
  const auto [at, is_new] = known_.try_emplace(without_figures(words));
  Known& known = at->second;
  known.heard = now;
  Heard heard{.tells = is_new || now - known.told >= known.wait, .untold = known.untold, .wait = {}};
  if (heard.tells) {
    known.told = now;
    known.wait = is_new ? k_first_wait : std::min(2 * known.wait, k_longest_wait);
    known.untold = 0;
  } else {
    ++known.untold;
  }
  heard.wait = known.told + known.wait - now;
  return heard;
}

void ToldOnce::forget_old(HostClock::time_point now) {
  std::erase_if(known_, [now](const auto& entry) { return now - entry.second.heard > k_over; });
}

std::string with_count(const std::string& words, const ToldOnce::Heard& heard) {
  if (heard.untold == 0) return words;
  return words + " (" + std::to_string(heard.untold) + (heard.untold == 1 ? " time" : " times") +
         " more since it was told)";
}

}  // namespace biteline::service
