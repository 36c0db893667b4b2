// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include "host/bite_line/buckets.hpp"

namespace biteline::bite_line {

namespace {

constexpr std::size_t k_items = 100'000;  // several chunks

}  // namespace

TEST_GROUP(Buckets){};

TEST(Buckets, EachHoldsItsOwnItemsInRisingOrder) {
  // Every eighth item is left out; the others go round the seven buckets in steps of three.
  const auto bucket_of = [](std::size_t i) { return i % 8 == 0 ? -1 : static_cast<int>(3 * i % 7); };
  const Buckets sut{k_items, 7, bucket_of};
  LONGS_EQUAL(7, sut.size());
  std::vector<std::size_t> next(7, 0);
  for (std::size_t i = 0; i < k_items; ++i) {
    if (bucket_of(i) < 0) continue;
    const auto bucket = static_cast<std::size_t>(bucket_of(i));
    CHECK(next[bucket] < sut[bucket].size());
    LONGS_EQUAL(i, sut[bucket][next[bucket]++]);
  }
  for (std::size_t bucket = 0; bucket < 7; ++bucket) LONGS_EQUAL(next[bucket], sut[bucket].size());
}

TEST(Buckets, ItemsWhereTakesThoseAndNoOthers) {
  const PooledVector<std::uint32_t> sut = items_where(k_items, [](std::size_t i) { return i % 3 == 1; });
  LONGS_EQUAL(k_items / 3, sut.size());
  for (std::size_t k = 0; k < sut.size(); ++k) LONGS_EQUAL(3 * k + 1, sut[k]);
  LONGS_EQUAL(0, items_where(0, [](std::size_t) { return true; }).size());
}

}  // namespace biteline::bite_line
