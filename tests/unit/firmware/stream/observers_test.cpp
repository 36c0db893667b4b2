// SPDX-License-Identifier: MIT
#include "firmware/stream/observers.hpp"

#include <CppUTest/TestHarness.h>

#include <map>

namespace biteline::stream {
namespace {

class CountingOutbox final : public Outbox {
 public:
  bool send(const PeerId& peer, std::span<const std::uint8_t> packet) override {
    if (full) return false;
    sent[peer].push_back(packet.front());
    return true;
  }
  bool full{false};
  std::map<PeerId, std::vector<std::uint8_t>> sent;
};

}  // namespace

TEST_GROUP(Observers) {
  CountingOutbox outbox;
  Observers sut{{.max_observers = 2, .window = 3}, outbox};
  SensorClock::time_point now{Nanoseconds{5'000'000'000}};
  wire::PictureWish fast{.rate_hz = 25};
  wire::PictureWish small{.rate_hz = 5, .width_max_px = 100};

  Observers::Welcome hello(const PeerId& peer, const wire::PictureWish& wish, std::uint64_t received = 0,
                           double profile_rate_hz = 0) {
    return sut.on_hello(
        peer, {.name = peer, .profile_rate_hz = profile_rate_hz, .picture = wish, .received = received}, now);
  }
  void picture(const wire::PictureWish& wish, std::uint8_t mark) {
    sut.offer_picture({.wish = wish, .scan_id = 1, .packet = {mark}});
  }
  void profile(std::uint64_t sequence) {
    const wire::Bytes packet{static_cast<std::uint8_t>(sequence)};
    sut.offer_profile(sequence, packet, now);
  }
};

TEST(Observers, EachGetsThePicturesThatItAskedFor) {
  hello("a", fast);
  hello("b", small);
  picture(fast, 1);
  picture(small, 2);
  CHECK(outbox.sent["a"] == std::vector<std::uint8_t>{1});
  CHECK(outbox.sent["b"] == std::vector<std::uint8_t>{2});
}

TEST(Observers, SlowOneGetsFewerAndAlwaysTheNewest) {
  hello("a", fast);
  for (std::uint8_t i = 0; i < 10; ++i) picture(fast, i);
  CHECK((outbox.sent["a"] == std::vector<std::uint8_t>{0, 1, 2}));
  hello("a", fast, 2);
  for (std::uint8_t i = 10; i < 20; ++i) picture(fast, i);
  CHECK((outbox.sent["a"] == std::vector<std::uint8_t>{0, 1, 2, 10, 11}));
}

TEST(Observers, ReceiptForWhatWasNeverSentOpensNoLargerWindow) {
  hello("a", fast);
  hello("a", fast, 1'000'000);
  for (std::uint8_t i = 0; i < 10; ++i) picture(fast, i);
  LONGS_EQUAL(3, outbox.sent["a"].size());
  hello("a", fast, 0);  // backwards
  for (std::uint8_t i = 0; i < 10; ++i) picture(fast, i);
  LONGS_EQUAL(3, outbox.sent["a"].size());
}

TEST(Observers, OneThatComesBackCountsOnFromWhereItWas) {
  hello("new address", fast, 500);
  for (std::uint8_t i = 0; i < 10; ++i) picture(fast, i);
  LONGS_EQUAL(3, outbox.sent["new address"].size());
  hello("new address", fast, 503);
  picture(fast, 77);
  LONGS_EQUAL(4, outbox.sent["new address"].size());
}

TEST(Observers, FullQueueCostsThePictureAndNotTheWindow) {
  hello("a", fast);
  outbox.full = true;
  for (std::uint8_t i = 0; i < 10; ++i) picture(fast, i);
  outbox.full = false;
  picture(fast, 50);
  CHECK(outbox.sent["a"] == std::vector<std::uint8_t>{50});
}

TEST(Observers, ProfilesComeAtTheRateAskedForAndNoneTwice) {
  hello("a", {}, 0, 10);
  hello("b", {});
  profile(1);
  profile(1);
  now += Nanoseconds{50'000'000};
  profile(2);  // too early
  now += Nanoseconds{50'000'000};
  profile(3);
  now += Nanoseconds{100'000'000};
  profile(3);  // nothing new
  CHECK((outbox.sent["a"] == std::vector<std::uint8_t>{1, 3}));
  CHECK(outbox.sent["b"].empty());
  sut.begin_scan();
  hello("a", {}, 2, 10);
  profile(3);  // of the next scan
  LONGS_EQUAL(3, outbox.sent["a"].size());
}

TEST(Observers, ThereIsPlaceForSoManyAndASilentOneLosesIts) {
  CHECK(hello("a", fast) == Observers::Welcome::New);
  CHECK(hello("b", fast) == Observers::Welcome::New);
  CHECK(hello("c", fast) == Observers::Welcome::NoPlace);
  CHECK(hello("a", fast) == Observers::Welcome::Known);
  now += Nanoseconds{1'500'000'000};
  hello("a", fast);
  now += Nanoseconds{1'000'000'000};
  sut.drop_silent(now);
  LONGS_EQUAL(1, sut.count());
  CHECK(sut.contains("a"));
  CHECK(hello("c", fast) == Observers::Welcome::New);
}

TEST(Observers, WishesAreToldOnceEachAndTheirChangesCounted) {
  hello("a", fast);
  hello("b", fast);
  LONGS_EQUAL(1, sut.picture_wishes().size());
  const std::uint64_t version = sut.wishes_version();
  hello("a", fast, 1);
  LONGS_EQUAL(version, sut.wishes_version());
  hello("a", small);
  CHECK(sut.wishes_version() > version);
  LONGS_EQUAL(2, sut.picture_wishes().size());
  hello("a", {.rate_hz = 0});
  sut.erase("b");
  LONGS_EQUAL(0, sut.picture_wishes().size());
}

}  // namespace biteline::stream
