// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/login_limit.hpp"

#include <CppUTest/TestHarness.h>

namespace biteline::web {

using std::chrono::seconds;

TEST_GROUP(LoginLimit) {
  LoginLimit sut;
  LoginLimit::Clock::time_point now{seconds{1000}};
};

TEST(LoginLimit, FiveTriesThenOneEverySixSeconds) {
  for (int i = 0; i < 5; ++i) CHECK(sut.take("a", now));
  CHECK(!sut.take("a", now));
  CHECK(sut.take("b", now));
  CHECK(!sut.take("a", now + seconds{5}));
  CHECK(sut.take("a", now + seconds{7}));
  CHECK(!sut.take("a", now + seconds{7}));
}

TEST(LoginLimit, GoodLoginsCostNothing) {
  for (int i = 0; i < 1000; ++i) {
    CHECK(sut.take("a", now));
    sut.give_back("a", now);
  }
}

TEST(LoginLimit, ManyAddressesTogetherAreHeldUpToo) {
  int taken = 0;
  for (int i = 0; i < 10'000; ++i) taken += sut.take("address " + std::to_string(i), now) ? 1 : 0;
  LONGS_EQUAL(LoginLimit::k_tries_of_all, taken);
  CHECK(sut.take("another", now + seconds{1}));
}

}  // namespace biteline::web
