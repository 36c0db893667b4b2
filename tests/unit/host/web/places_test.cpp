// SPDX-License-Identifier: MIT
// Who gives way when the table of connections is full.
#include "host/apps/biteline-web/places.hpp"

#include <CppUTest/TestHarness.h>

#include <vector>

namespace biteline::web {

TEST_GROUP(Places) {
  Places sut{256, 128, 16};

  Places::Id come(const std::string& address, Places::Standing standing = Places::Standing::Silent,
                  bool local = false) {
    const auto taken = sut.take(address, local);
    if (!taken) return 0;
    sut.stand(taken->id, standing);
    return taken->id;
  }
};

TEST(Places, TheOldestSilentOneGivesWayNotANewcomerNorAStranger) {
  const Places::Id stranger = come("a", Places::Standing::Stranger);
  const Places::Id oldest = come("a");
  for (int i = 2; i < 128; ++i) come("a");
  const auto taken = sut.take("a", false);
  CHECK(taken && taken->gives_way == oldest);
  LONGS_EQUAL(128, sut.count());
  for (int i = 0; i < 126; ++i) CHECK(sut.take("a", false)->gives_way != stranger);
  // The newcomers were silent, too: the oldest of them goes before a stranger does.
  CHECK(sut.take("a", false)->gives_way != stranger);
}

TEST(Places, WhoHoldsTheMostGivesWay) {
  for (int i = 0; i < 120; ++i) come("greedy");
  for (int i = 0; i < 119; ++i) come("too");
  for (int i = 0; i < 17; ++i) come("quiet-" + std::to_string(i));
  LONGS_EQUAL(256, sut.count());
  for (int i = 0; i < 50; ++i) {
    const auto taken = sut.take("new-" + std::to_string(i), false);
    CHECK(taken.has_value());
    CHECK(*taken->gives_way <= 239);
  }
}

TEST(Places, ASessionGivesWayToNobodyAndThisMachineHasRoomOfItsOwn) {
  for (int i = 0; i < 128; ++i) come("a", Places::Standing::Known);
  CHECK(!sut.take("a", false));
  for (int i = 0; i < 128; ++i) come("b", Places::Standing::Known);
  CHECK(!sut.take("c", false));
  for (int i = 0; i < 16; ++i) {
    const auto taken = sut.take("127.0.0.1", true);
    CHECK(taken && !taken->gives_way);
    sut.stand(taken->id, Places::Standing::Known);
  }
  CHECK(!sut.take("127.0.0.1", true));
}

TEST(Places, LeavingMakesRoomAndTwiceIsOnce) {
  std::vector<Places::Id> all;
  for (int i = 0; i < 128; ++i) all.push_back(come("a", Places::Standing::Known));
  sut.leave(all[3]);
  sut.leave(all[3]);
  sut.leave(0);
  LONGS_EQUAL(127, sut.count());
  const auto taken = sut.take("a", false);
  CHECK(taken && !taken->gives_way);
  // Who has lost its place gets none by what it says later.
  sut.stand(all[3], Places::Standing::Known);
  LONGS_EQUAL(128, sut.count());
}

TEST(Places, AFloodNeverTakesThePlaceOfWhoJustCame) {
  // What a request needs between its connection and its last byte: a flood of 200 connections meanwhile.
  for (int i = 0; i < 256; ++i) come(i % 2 == 0 ? "x" : "y");
  for (int round = 0; round < 20; ++round) {
    const Places::Id own = come("127.0.0.1", Places::Standing::Silent, true);
    for (int i = 0; i < 200; ++i) CHECK(sut.take(i % 2 == 0 ? "x" : "y", false)->gives_way != own);
    sut.leave(own);
  }
}

}  // namespace biteline::web
