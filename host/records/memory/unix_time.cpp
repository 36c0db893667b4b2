// SPDX-License-Identifier: MIT
// Instants as numbers and as text.
#include <chrono>
#include <cstdio>
#include <ctime>

#include "host/records/memory/memory.hpp"

namespace biteline::memory {

UnixMs now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string to_iso(UnixMs time) {
  const UnixMs ms = ((time % 1000) + 1000) % 1000;
  const auto seconds = static_cast<std::time_t>((time - ms) / 1000);
  std::tm parts{};
  char day[32] = {};
  std::strftime(day, sizeof day, "%Y-%m-%dT%H:%M:%S", gmtime_r(&seconds, &parts));
  char text[48] = {};
  std::snprintf(text, sizeof text, "%s.%03dZ", day, static_cast<int>(ms));
  return text;
}

std::optional<UnixMs> from_iso(const std::string& iso) {
  std::tm parts{};
  int ms = 0;
  int taken = 0;
  const char* const text = iso.c_str();
  const auto length = static_cast<int>(iso.size());
  const bool day_only =
      std::sscanf(text, "%4d-%2d-%2d%n", &parts.tm_year, &parts.tm_mon, &parts.tm_mday, &taken) == 3;
  if (!day_only) return std::nullopt;
  if (taken != length) {
    int more = 0;
    if (std::sscanf(text + taken, "T%2d:%2d:%2d%n", &parts.tm_hour, &parts.tm_min, &parts.tm_sec, &more) != 3)
      return std::nullopt;
    taken += more;
    more = 0;
    if (taken < length && std::sscanf(text + taken, ".%3d%n", &ms, &more) == 1) taken += more;
    if (taken < length && text[taken] == 'Z') ++taken;
    if (taken != length) return std::nullopt;
  }
  const bool possible = parts.tm_year >= 1970 && parts.tm_year <= 9999 && parts.tm_mon >= 1 &&
                        parts.tm_mon <= 12 && parts.tm_mday >= 1 && parts.tm_mday <= 31 &&
                        parts.tm_hour >= 0 && parts.tm_hour < 24 && parts.tm_min >= 0 && parts.tm_min < 60 &&
                        parts.tm_sec >= 0 && parts.tm_sec <= 60 && ms >= 0;
  if (!possible) return std::nullopt;
  parts.tm_year -= 1900;
  parts.tm_mon -= 1;
  return static_cast<UnixMs>(::timegm(&parts)) * 1000 + ms;
}

}  // namespace biteline::memory
