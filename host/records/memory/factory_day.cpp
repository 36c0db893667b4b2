// SPDX-License-Identifier: MIT
#include "host/records/memory/factory_day.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>

namespace biteline::memory {
namespace {

constexpr int k_minutes_a_day = 24 * 60;
constexpr UnixMs k_hour_ms = 3'600'000;

std::tm local(UnixMs time) {
  const auto seconds = static_cast<std::time_t>(time >= 0 ? time / 1000 : (time - 999) / 1000);
  std::tm parts{};
  ::localtime_r(&seconds, &parts);
  return parts;
}

/// An instant of local time.  Twice a year it is none or two: the later one of a gap, the earlier one of two;
/// mktime() alone would take whichever it met last.
UnixMs instant_of(const std::tm& wanted) {
  std::optional<std::time_t> first;
  std::time_t any = 0;
  for (const int summer : {1, 0}) {
    std::tm parts = wanted;
    parts.tm_isdst = summer;
    const std::time_t seconds = ::mktime(&parts);
    any = seconds;  // of standard time, the last
    const std::tm back = local(static_cast<UnixMs>(seconds) * 1000);
    const int wanted_min = (wanted.tm_hour * 60 + wanted.tm_min) % k_minutes_a_day;
    if (back.tm_hour * 60 + back.tm_min != wanted_min) continue;
    if (!first || seconds < *first) first = seconds;
  }
  return static_cast<UnixMs>(first.value_or(any)) * 1000;
}

const char* zone_folder() {
  const char* const told = std::getenv("TZDIR");
  return told != nullptr && *told != '\0' ? told : "/usr/share/zoneinfo";
}

bool is_zone_name(const std::string& zone) {
  const bool plain = !zone.empty() && zone.front() != '/' && zone.find("..") == std::string::npos &&
                     std::ranges::all_of(zone, [](unsigned char c) {
                       return std::isalnum(c) != 0 || c == '/' || c == '_' || c == '-' || c == '+';
                     });
  struct stat status {};
  return plain && ::stat((std::string{zone_folder()} + "/" + zone).c_str(), &status) == 0 &&
         S_ISREG(status.st_mode);
}

/// "CST-8" or "CET-1CEST,M3.5.0,M10.5.0/3": letters, an offset, maybe rules.  What is none would count as UTC
/// without a word.
bool is_zone_rule(const std::string& zone) {
  std::size_t at = 0;
  while (at < zone.size() && std::isalpha(static_cast<unsigned char>(zone[at])) != 0) ++at;
  if (at < 3 || at == zone.size()) return false;
  if (zone[at] == '+' || zone[at] == '-') ++at;
  if (at == zone.size() || std::isdigit(static_cast<unsigned char>(zone[at])) == 0) return false;
  return std::ranges::all_of(zone, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '+' || c == '-' || c == ':' || c == ',' || c == '.' || c == '/';
  });
}

/// "+08:00" at the end of `text`, in ms, which it loses.
std::optional<UnixMs> take_offset(std::string& text) {
  int hours = 0, minutes = 0, taken = 0;
  if (text.size() < 6) return std::nullopt;
  const std::string end = text.substr(text.size() - 6);
  if ((end[0] != '+' && end[0] != '-') ||
      std::sscanf(end.c_str() + 1, "%2d:%2d%n", &hours, &minutes, &taken) != 2 || taken != 5 || hours > 23 ||
      minutes > 59)
    return std::nullopt;
  text.resize(text.size() - 6);
  return (end[0] == '-' ? -1 : 1) * (hours * k_hour_ms + minutes * 60'000);
}

}  // namespace

Result<void> use_time_zone(const std::string& zone) {
  if (zone.empty()) return {};
  if (!is_zone_name(zone) && !is_zone_rule(zone))
    return fail(Errc::InvalidArgument,
                "time zone '%.60s': a name such as Asia/Shanghai (see %s) or a rule such as CST-8 expected",
                zone.c_str(), zone_folder());
  ::setenv("TZ", zone.c_str(), 1);
  ::tzset();
  return {};
}

std::string time_zone() {
  if (const char* const told = std::getenv("TZ"); told != nullptr && *told != '\0')
    return *told == ':' ? told + 1 : told;
  std::array<char, 200> link{};
  const ssize_t size = ::readlink("/etc/localtime", link.data(), link.size() - 1);
  const std::string target{link.data(), size > 0 ? static_cast<std::size_t>(size) : 0};
  constexpr std::string_view k_folder = "zoneinfo/";
  const std::size_t at = target.find(k_folder);
  if (at != std::string::npos) return target.substr(at + k_folder.size());
  struct stat status {};
  if (::stat("/etc/localtime", &status) != 0) return "UTC";
  // A copy of a zone's file: its name may stand beside it.
  std::string name;
  std::ifstream{"/etc/timezone"} >> name;
  return is_zone_name(name) ? name : std::string{};
}

std::string local_time(UnixMs time) {
  const std::tm parts = local(time);
  char text[32] = {};
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts);
  return text;
}

std::optional<FactoryDay> FactoryDay::from(const std::string& begin) {
  const auto digit = [&begin](std::size_t at) { return begin[at] >= '0' && begin[at] <= '9'; };
  if (begin.size() != 5 || begin[2] != ':' || !digit(0) || !digit(1) || !digit(3) || !digit(4))
    return std::nullopt;
  const int hours = (begin[0] - '0') * 10 + begin[1] - '0', minutes = (begin[3] - '0') * 10 + begin[4] - '0';
  if (hours > 23 || minutes > 59) return std::nullopt;
  return FactoryDay{hours * 60 + minutes};
}

FactoryDay FactoryDay::of(const Memory& memory) {
  if (const auto zone = memory.setting(k_zone_key); zone && *zone) static_cast<void>(use_time_zone(**zone));
  const auto begin = memory.setting(k_day_begin_key);
  return begin && *begin ? from(**begin).value_or(FactoryDay{}) : FactoryDay{};
}

std::string FactoryDay::begin() const {
  char text[16];
  std::snprintf(text, sizeof text, "%02d:%02d", begin_min_ / 60, begin_min_ % 60);
  return text;
}

UnixMs FactoryDay::begin_of(int year, int month, int day) const {
  // Noon of that day first: a day outside its month, in the calendar's own order.
  std::tm noon{};
  noon.tm_year = year - 1900;
  noon.tm_mon = month - 1;
  noon.tm_mday = day;
  noon.tm_hour = 12;
  const std::time_t seconds = ::timegm(&noon);
  std::tm wanted{};
  ::gmtime_r(&seconds, &wanted);
  wanted.tm_hour = begin_min_ / 60;
  wanted.tm_min = begin_min_ % 60;
  wanted.tm_sec = 0;
  return instant_of(wanted);
}

FactoryDay::Date FactoryDay::date_of(UnixMs time) const {
  const std::tm parts = local(time);
  const int year = parts.tm_year + 1900, month = parts.tm_mon + 1;
  int day = parts.tm_mday;
  int weekday = (parts.tm_wday + 6) % 7;
  // A night shift belongs to the day that it began on.
  if (begin_of(year, month, day) > time) {
    --day;
    weekday = (weekday + 6) % 7;
  }
  return {.year = year, .month = month, .day = day, .weekday = weekday};
}

Interval FactoryDay::around(UnixMs time, Span span) const {
  if (span == Span::Hour) {
    const UnixMs shift = static_cast<UnixMs>(local(time).tm_gmtoff) * 1000;
    const UnixMs into = (((time + shift) % k_hour_ms) + k_hour_ms) % k_hour_ms;
    return {.begin = time - into, .end = time - into + k_hour_ms};
  }
  const Date date = date_of(time);
  const int first = span == Span::Week ? date.day - date.weekday : date.day;
  const int days = span == Span::Week ? 7 : 1;
  return {.begin = begin_of(date.year, date.month, first),
          .end = begin_of(date.year, date.month, first + days)};
}

std::optional<UnixMs> FactoryDay::time_of(const std::string& text) const {
  constexpr std::size_t k_day_letters = 10;
  if (text.ends_with('Z')) return from_iso(text);
  std::string rest = text;
  const std::optional<UnixMs> offset = rest.size() > k_day_letters ? take_offset(rest) : std::nullopt;
  constexpr std::size_t k_minute_letters = 16;
  if (rest.size() == k_minute_letters) rest += ":00";
  // The same text in UTC: is it one, and what are its numbers?
  const std::optional<UnixMs> plain = from_iso(rest);
  if (!plain) return std::nullopt;
  if (offset) return *plain - *offset;
  const auto seconds = static_cast<std::time_t>(*plain / 1000);
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  if (rest.size() == k_day_letters) return begin_of(parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday);
  return instant_of(parts) + *plain % 1000;
}

std::string FactoryDay::name_of(UnixMs time) const {
  // Its own noon, so that a day that begins late has the date that it began on.
  const Date date = date_of(time);
  std::tm parts{};
  parts.tm_year = date.year - 1900;
  parts.tm_mon = date.month - 1;
  parts.tm_mday = date.day;
  parts.tm_hour = 12;
  const std::time_t seconds = ::timegm(&parts);
  char name[16] = {};
  std::strftime(name, sizeof name, "%Y-%m-%d", ::gmtime_r(&seconds, &parts));
  return name;
}

}  // namespace biteline::memory
