// SPDX-License-Identifier: MIT
// The factory's day: another zone, a shift's begin, and the days on which the clock is changed.
#include "host/records/memory/factory_day.hpp"

#include <CppUTest/TestHarness.h>

#include <cstdlib>
#include <ctime>

#include "host/records/memory/history.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::memory {
namespace {

constexpr UnixMs k_hour_ms = 3'600'000;

UnixMs at(const char* iso) {
  return from_iso(iso).value_or(-1);
}

}  // namespace

TEST_GROUP(FactoryDay) {
  std::string before;
  bool had{false};

  void setup() override {
    const char* const zone = std::getenv("TZ");
    had = zone != nullptr;
    if (had) before = zone;
  }
  void teardown() override {
    if (had) {
      ::setenv("TZ", before.c_str(), 1);
    } else {
      ::unsetenv("TZ");
    }
    ::tzset();
  }
  static void use(const char* zone) {
    SUCCEEDS(use_time_zone(zone));
  }
  static FactoryDay from(const char* begin) {
    const auto day = FactoryDay::from(begin);
    CHECK(day.has_value());
    return *day;
  }
  static double hours(const FactoryDay& day, const char* iso, Span span = Span::Day) {
    const Interval one = day.around(at(iso), span);
    CHECK(one.begin <= at(iso) && at(iso) < one.end);
    return static_cast<double>(one.end - one.begin) / static_cast<double>(k_hour_ms);
  }
  static Scan scan(const char* name, UnixMs time) {
    Scan row;
    row.name = name;
    row.time = time;
    row.verdict = "ok";
    row.length_mm = 801.25;
    row.reason = "a;b,c";
    return row;
  }
  static LogRow event() {
    return {.id = 0,
            .time = 1,
            .who = "service",
            .door = {},
            .action = "result",
            .subject = {},
            .before = {},
            .after = {}};
  }
};

TEST(FactoryDay, TwoShoesOfOneMorningAreOfOneDay) {
  use("Asia/Shanghai");
  const FactoryDay day;
  // 07:30 and 08:30 in Shanghai.
  STRCMP_EQUAL("2026-11-27", day.name_of(at("2026-11-26T23:30:00Z")).c_str());
  STRCMP_EQUAL("2026-11-27", day.name_of(at("2026-11-27T00:30:00Z")).c_str());
  CHECK(day.time_of("2026-11-27") == at("2026-11-26T16:00:00Z"));
  STRCMP_EQUAL("2026-11-27 07:30:00", local_time(at("2026-11-26T23:30:00Z")).c_str());
  STRCMP_EQUAL("Asia/Shanghai", time_zone().c_str());
}

TEST(FactoryDay, ANightShiftIsOfTheDayOnWhichItBegan) {
  for (const char* zone :
       {"Asia/Shanghai", "Asia/Kolkata", "Europe/Berlin", "UTC", "Pacific/Chatham", "America/Lima"}) {
    use(zone);
    const FactoryDay day = from("06:00");
    const UnixMs begin = *day.time_of("2026-11-27");
    STRCMP_EQUAL("2026-11-27 06:00:00", local_time(begin).c_str());
    for (const UnixMs into : {UnixMs{0}, k_hour_ms, 18 * k_hour_ms, 24 * k_hour_ms - 1})
      STRCMP_EQUAL_TEXT("2026-11-27", day.name_of(begin + into).c_str(), zone);
    STRCMP_EQUAL("2026-11-26", day.name_of(begin - 1).c_str());
    STRCMP_EQUAL("2026-11-28", day.name_of(begin + 24 * k_hour_ms).c_str());
  }
}

TEST(FactoryDay, ADayHas23Or25HoursWhereTheClockIsChanged) {
  use("Europe/Berlin");
  const FactoryDay day;
  DOUBLES_EQUAL(23, hours(day, "2026-03-29T10:00:00Z"), 0);
  DOUBLES_EQUAL(25, hours(day, "2026-10-25T10:00:00Z"), 0);
  DOUBLES_EQUAL(24, hours(day, "2026-10-26T10:00:00Z"), 0);
  DOUBLES_EQUAL(7 * 24 + 1, hours(day, "2026-10-22T10:00:00Z", Span::Week), 0);
  // A shift that begins at 06:00 has the change in the night before.
  DOUBLES_EQUAL(25, hours(from("06:00"), "2026-10-25T00:30:00Z"), 0);
  DOUBLES_EQUAL(24, hours(from("06:00"), "2026-10-25T10:00:00Z"), 0);
  // A begin that one night does not have, and another has twice.
  DOUBLES_EQUAL(24, hours(from("02:30"), "2026-03-28T10:00:00Z"), 1);
  DOUBLES_EQUAL(24, hours(from("02:30"), "2026-10-25T10:00:00Z"), 1);
}

TEST(FactoryDay, EveryInstantHasOneDayAndNeighboursTouch) {
  for (const char* zone :
       {"Europe/Berlin", "America/Sao_Paulo", "Australia/Lord_Howe", "Asia/Shanghai", "Africa/Casablanca"}) {
    use(zone);
    for (const char* begin : {"00:00", "02:30", "06:00", "22:15"}) {
      const FactoryDay day = from(begin);
      for (const Span span : {Span::Day, Span::Week}) {
        UnixMs time = at("2017-12-30T00:00:00Z");
        Interval last = day.around(time, span);
        for (int i = 0; i < 400; ++i) {
          const Interval next = day.around(last.end, span);
          CHECK_TEXT(next.begin == last.end && next.end > next.begin, zone);
          CHECK_TEXT(day.around(next.end - 1, span).begin == next.begin, zone);
          last = next;
        }
      }
    }
  }
}

TEST(FactoryDay, AnHourIsTheFactorysAlsoWhereZonesAreHalfAnHourOff) {
  use("Asia/Kolkata");
  const Interval hour = FactoryDay{}.around(at("2026-11-27T02:45:00Z"), Span::Hour);  // 08:15 there
  CHECK(hour.begin == at("2026-11-27T02:30:00Z"));
  CHECK(hour.end == at("2026-11-27T03:30:00Z"));
}

TEST(FactoryDay, AWeekBeginsOnMonday) {
  use("Asia/Shanghai");
  const Interval week = from("06:00").around(at("2026-11-27T02:00:00Z"), Span::Week);
  STRCMP_EQUAL("2026-11-23 06:00:00", local_time(week.begin).c_str());
  STRCMP_EQUAL("2026-11-30 06:00:00", local_time(week.end).c_str());
}

TEST(FactoryDay, TimesAreLocalUnlessTheySayOtherwise) {
  use("Asia/Shanghai");
  const FactoryDay day = from("06:00");
  for (const char* text : {"2026-11-27T07:30", "2026-11-27T07:30:00", "2026-11-26T23:30:00Z",
                           "2026-11-27T07:30+08:00", "2026-11-27T00:30:00+01:00", "2026-11-26T18:30-05:00"})
    CHECK_TEXT(day.time_of(text) == at("2026-11-26T23:30:00Z"), text);
  CHECK(day.time_of("2026-11-27") == at("2026-11-26T22:00:00Z"));
  for (const char* text : {"", "today", "2026-13-01", "2026-11-27T25:00", "2026-11-27T07:30+25:00",
                           "2026-11-27+08:00x", "27.11.2026", "2026-11-27T07"})
    CHECK_TEXT(!day.time_of(text), text);
}

TEST(FactoryDay, AnUnknownZoneIsRefusedAndNotTakenForUtc) {
  for (const char* zone : {"Asia/Nowhere", "Shanghai", "../../etc/passwd", "/etc/passwd", "GMT", "CST-8",
                           "CET-1CEST,M3.5.0,M10.5.0/3"}) {
    const std::string text{zone};
    const bool good = text == "GMT" || text.starts_with("CST-8") || text.starts_with("CET-1");
    CHECK_TEXT(use_time_zone(zone).has_value() == good, zone);
  }
  for (const char* begin : {"", "6:00", "24:00", "06:60", "06:00:00", "ab:cd"})
    CHECK_TEXT(!FactoryDay::from(begin), begin);
  STRCMP_EQUAL("06:05", from("06:05").begin().c_str());
}

TEST(FactoryDay, TrendsAndTablesGoByIt) {
  const test::TemporaryFolder folder;
  auto memory = Memory::open(folder.path() / k_memory_file);
  SUCCEEDS(memory);
  SUCCEEDS(memory->put_scan(scan("scan-0001", at("2026-11-26T23:30:00Z")), event()));
  SUCCEEDS(memory->put_scan(scan("scan-0002", at("2026-11-27T00:30:00Z")), event()));
  SUCCEEDS(memory->put_setting(k_zone_key, "Asia/Shanghai", event()));
  SUCCEEDS(memory->put_setting(k_day_begin_key, "06:00", event()));
  const FactoryDay day = FactoryDay::of(*memory);
  STRCMP_EQUAL("06:00", day.begin().c_str());
  const auto trends = memory->trends({}, day, Span::Day);
  SUCCEEDS(trends);
  LONGS_EQUAL(1, trends->buckets.size());
  LONGS_EQUAL(2, trends->buckets[0].scans);
  CHECK(trends->buckets[0].begin == at("2026-11-26T22:00:00Z"));
  LONGS_EQUAL(2, memory->trends({}, day, Span::Hour)->buckets.size());
  const auto csv = history_csv(*memory, {}, {}, day);
  SUCCEEDS(csv);
  STRCMP_CONTAINS(
      ",reason,local_time,day,part,foot,size,ended_by,tip_bound_mm,work,work_reworked,"
      "work_missing_mm,work_narrow,work_wide,work_beside,work_doubled,follows\r\n",
      csv->c_str());
  STRCMP_CONTAINS(",2026-11-27 08:30:00,2026-11-27,,,,,,,,,,,,,\r\n", csv->c_str());
  STRCMP_CONTAINS("\r\n2026-11-26T23:30:00.000Z,scan-0001,", csv->c_str());
}

TEST(FactoryDay, TablesAreWrittenAsTheSpreadsheetReadsThem) {
  const test::TemporaryFolder folder;
  auto memory = Memory::open(folder.path() / k_memory_file);
  SUCCEEDS(memory);
  SUCCEEDS(memory->put_scan(scan("scan-0001", 1'795'000'000'000), event()));
  const auto german = csv_style("semicolon", "comma", true);
  CHECK(german.has_value());
  const auto csv = history_csv(*memory, {}, *german);
  SUCCEEDS(csv);
  CHECK(csv->starts_with("\xEF\xBB\xBFtime;scan;"));
  STRCMP_CONTAINS(";801,25;", csv->c_str());
  STRCMP_CONTAINS("\"a;b,c\"", csv->c_str());
  const auto tabs = history_csv(*memory, {}, *csv_style("tab", "point", false));
  STRCMP_CONTAINS("\t801.25\t", tabs->c_str());
  CHECK(!tabs->starts_with("\xEF"));
  for (const auto& [separator, decimal] :
       {std::pair{"comma", "comma"}, std::pair{";", "point"}, std::pair{"semicolon", ","}, std::pair{"", ""}})
    CHECK(!csv_style(separator, decimal, false));
}

}  // namespace biteline::memory
