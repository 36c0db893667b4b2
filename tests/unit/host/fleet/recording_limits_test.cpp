// SPDX-License-Identifier: MIT
#include "host/fleet/recording_limits.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::fleet {
namespace {

constexpr std::int64_t k_gb = 1'000'000'000;

/// Oldest first, a gigabyte each.
std::vector<KeptRecording> four() {
  return {{.number = 1, .bytes = k_gb, .age_days = 40},
          {.number = 2, .bytes = k_gb, .age_days = 30},
          {.number = 3, .bytes = k_gb, .age_days = 2},
          {.number = 4, .bytes = k_gb, .age_days = 1}};
}

}  // namespace

TEST_GROUP(RecordingLimits){};

TEST(RecordingLimits, NoLimitRemovesNothing) {
  CHECK(beyond({}, four()).empty());
  CHECK(beyond({.days = 50, .gb = 4}, four()).empty());
  CHECK(beyond({.days = 1, .gb = 1}, {}).empty());
}

TEST(RecordingLimits, OldOnesGo) {
  const std::vector<Going> going = beyond({.days = 10, .gb = {}}, four());
  CHECK((going == std::vector<Going>{{1, GoesBy::Age}, {2, GoesBy::Age}}));
  // Also the newest one.
  LONGS_EQUAL(4, beyond({.days = 0.5, .gb = {}}, four()).size());
}

TEST(RecordingLimits, OldestGoUntilTheRestHasRoom) {
  const std::vector<Going> going = beyond({.days = {}, .gb = 2.5}, four());
  CHECK((going == std::vector<Going>{{1, GoesBy::Space}, {2, GoesBy::Space}}));
  // What goes by age makes room, too.
  LONGS_EQUAL(2, beyond({.days = 10, .gb = 2.5}, four()).size());
  // The newest stays, however little room there is: somebody has just asked for it.
  LONGS_EQUAL(3, beyond({.days = {}, .gb = 0.1}, four()).size());
}

TEST(RecordingLimits, MarkedOnesAndThoseThatComeAnewStay) {
  std::vector<KeptRecording> kept = four();
  kept[0].marked = true;
  kept[1].busy = true;
  CHECK((beyond({.days = 1.5, .gb = {}}, kept) == std::vector<Going>{{3, GoesBy::Age}}));
  CHECK((beyond({.days = {}, .gb = 1}, kept) == std::vector<Going>{{3, GoesBy::Space}}));
  for (KeptRecording& one : kept) one.marked = true;
  CHECK(beyond({.days = 0.5, .gb = 0.1}, kept).empty());
}

}  // namespace biteline::fleet
