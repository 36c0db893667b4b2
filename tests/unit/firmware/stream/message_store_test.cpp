// SPDX-License-Identifier: MIT
#include "firmware/stream/message_store.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::stream {

TEST_GROUP(MessageStore) {
  MessageStore sut{100};

  static wire::Bytes message(std::size_t size_bytes, std::uint8_t mark) {
    return wire::Bytes(size_bytes, mark);
  }
};

TEST(MessageStore, HoldsMessagesInOrder) {
  LONGS_EQUAL(0, sut.push(message(10, 1)));
  LONGS_EQUAL(0, sut.push(message(20, 2)));
  LONGS_EQUAL(0, sut.held_from());
  LONGS_EQUAL(2, sut.held_to());
  LONGS_EQUAL(1, sut.at(0).front());
  LONGS_EQUAL(20, sut.at(1).size());
  LONGS_EQUAL(30, sut.held_bytes());
}

TEST(MessageStore, AcknowledgedMessagesStayUntilTheirRoomIsNeeded) {
  for (std::uint8_t i = 0; i < 10; ++i) LONGS_EQUAL(0, sut.push(message(10, i)));
  sut.set_acknowledged(5);
  LONGS_EQUAL(0, sut.held_from());
  LONGS_EQUAL(0, sut.push(message(10, 10)));
  LONGS_EQUAL(1, sut.held_from());
  LONGS_EQUAL(1, sut.at(1).front());
}

TEST(MessageStore, LosingAnUnacknowledgedMessageIsTold) {
  for (std::uint8_t i = 0; i < 10; ++i) (void)sut.push(message(10, i));
  sut.set_acknowledged(1);
  LONGS_EQUAL(2, sut.push(message(30, 10)));  // 0 was acknowledged, 1 and 2 were not
  LONGS_EQUAL(3, sut.held_from());
}

TEST(MessageStore, RoomCountsOnlyAcknowledgedMessages) {
  for (std::uint8_t i = 0; i < 10; ++i) (void)sut.push(message(10, i));
  CHECK(!sut.has_room(1));
  sut.set_acknowledged(2);
  CHECK(sut.has_room(20));
  CHECK(!sut.has_room(21));
}

TEST(MessageStore, MessageLargerThanTheStoreIsStillTaken) {
  (void)sut.push(message(10, 1));
  LONGS_EQUAL(1, sut.push(message(500, 2)));
  LONGS_EQUAL(1, sut.held_from());
  LONGS_EQUAL(2, sut.held_to());
}

TEST(MessageStore, ClearingTellsWhatNobodyHad) {
  for (std::uint8_t i = 0; i < 10; ++i) (void)sut.push(message(10, i));
  sut.set_acknowledged(7);
  LONGS_EQUAL(3, sut.clear());
  LONGS_EQUAL(0, sut.held_to());
  LONGS_EQUAL(0, sut.held_bytes());
  LONGS_EQUAL(0, sut.clear());
}

}  // namespace biteline::stream
