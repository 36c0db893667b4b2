// SPDX-License-Identifier: MIT
#include "host/fleet/alarms.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::fleet {
namespace {

constexpr std::int64_t k_now_ms = 1'795'000'000'000;

CellRow sound_cell(const char* name) {
  CellRow cell;
  cell.cell = name;
  cell.online = true;
  cell.heard_ms = k_now_ms - 5000;
  return cell;
}

}  // namespace

TEST_GROUP(Alarms) {
  FleetNews news;
  std::vector<LastHour> hours{{.cell = "cell-1", .shoes = 100, .refused = 20}};

  void setup() override {
    news.broker = true;
    news.cells = {sound_cell("cell-1"), sound_cell("cell-2")};
  }
  std::string told() const {
    std::string text;
    for (const Alarm& alarm : alarms_of(news, hours, k_now_ms)) text += alarm.code + " " + alarm.cell + ";";
    return text;
  }
};

TEST(Alarms, SoundFleetIsSilent) {
  STRCMP_EQUAL("", told().c_str());
}

TEST(Alarms, EachFaultIsToldOfItsCellAlone) {
  news.broker = false;
  news.cells[1].heard_ms = k_now_ms - 61'000;
  news.cells[0].waiting = 101;
  hours[0].refused = 21;
  OddOfModel odd;
  odd.model = "boot";
  odd.odd.cell = "cell-2";
  news.odd.push_back(odd);
  STRCMP_EQUAL("no_broker ;shoes_wait cell-1;many_refused cell-1;cell_away cell-2;odd_cell cell-2;",
               told().c_str());
}

TEST(Alarms, CellThatSaidGoodByeIsAwayAtOnce) {
  news.cells[0].online = false;
  STRCMP_EQUAL("cell_away cell-1;", told().c_str());
}

TEST(Alarms, NoShoesAreNoRefusals) {
  hours[0] = {.cell = "cell-1", .shoes = 0, .refused = 0};
  STRCMP_EQUAL("", told().c_str());
}

}  // namespace biteline::fleet
