// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <thread>
#include <vector>

#include "common/rt/buffer_pool.hpp"
#include "common/rt/drop_oldest_ring.hpp"
#include "common/rt/latest_value.hpp"

namespace biteline::rt {

// Enough hand-overs that the two threads meet at every place of a ring of four some thousand times, also on
// one core.
constexpr std::uint32_t k_items = 50000;

TEST_GROUP(DropOldestRing){};

TEST(DropOldestRing, GivesTheOldestBackWhenFull) {
  DropOldestRing<std::uint32_t, 2> sut;
  CHECK(!sut.rt_push(1));
  CHECK(!sut.rt_push(2));
  LONGS_EQUAL(1, *sut.rt_push(3));
  LONGS_EQUAL(2, *sut.rt_pop());
  LONGS_EQUAL(3, *sut.rt_pop());
  CHECK(!sut.rt_pop());
}

/// What became of every item handed through a ring by two threads.
struct Fate {
  std::uint64_t out_of_order{0};
  std::uint64_t lost_or_twice{0};
};

template <class Ring>
Fate stress() {
  Ring ring;
  std::vector<std::uint8_t> seen(k_items, 0);
  std::vector<std::uint32_t> victims, popped;
  victims.reserve(k_items);
  popped.reserve(k_items);
  std::atomic<bool> done{false};
  std::thread consumer{[&] {
    for (;;) {
      const bool last_look = done.load(std::memory_order_acquire);
      bool any = false;
      while (const auto item = ring.rt_pop()) {
        popped.push_back(*item);
        any = true;
      }
      if (last_look && !any) return;
      if (!any) std::this_thread::yield();
    }
  }};
  for (std::uint32_t i = 0; i < k_items; ++i) {
    if (const auto victim = ring.rt_push(i)) victims.push_back(*victim);
    if (i % 1024 == 0) std::this_thread::yield();
  }
  done.store(true, std::memory_order_release);
  consumer.join();
  Fate fate;
  for (std::size_t i = 1; i < popped.size(); ++i) fate.out_of_order += popped[i] <= popped[i - 1] ? 1 : 0;
  for (const std::uint32_t item : victims) ++seen[item];
  for (const std::uint32_t item : popped) ++seen[item];
  for (const std::uint8_t times : seen) fate.lost_or_twice += times == 1 ? 0 : 1;
  return fate;
}

TEST(DropOldestRing, EveryItemIsEitherDeliveredInOrderOrGivenBackOnce) {
  const Fate fate = stress<DropOldestRing<std::uint32_t, 4>>();
  LONGS_EQUAL(0, fate.out_of_order);
  LONGS_EQUAL(0, fate.lost_or_twice);
}

/// The ring as one would first write it: the consumer moves the tail with a plain store.  It overwrites the
/// producer's steal, and an item is given out twice.
template <class T, std::size_t Capacity>
class WrongDropOldestRing {
 public:
  std::optional<T> rt_push(T item) {
    const std::uint64_t head = head_.load(), tail = tail_.load();
    std::optional<T> victim;
    if (head - tail == Capacity) {
      victim = slots_[tail % Capacity].load();
      tail_.store(tail + 1);
    }
    slots_[head % Capacity].store(item);
    head_.store(head + 1);
    return victim;
  }
  std::optional<T> rt_pop() {
    const std::uint64_t tail = tail_.load();
    if (tail == head_.load()) return std::nullopt;
    const T item = slots_[tail % Capacity].load();
    std::this_thread::yield();  // widens the gap that is there anyway
    tail_.store(tail + 1);
    return item;
  }

 private:
  std::atomic<std::uint64_t> head_{0}, tail_{0};
  std::array<std::atomic<T>, Capacity> slots_{};
};

TEST(DropOldestRing, TheStressFindsTheWrongVariant) {
  // Two threads on one core may miss each other once, not twenty times.
  std::uint64_t faults = 0;
  for (int attempt = 0; attempt < 20 && faults == 0; ++attempt) {
    const Fate fate = stress<WrongDropOldestRing<std::uint32_t, 4>>();
    faults = fate.out_of_order + fate.lost_or_twice;
  }
  CHECK(faults > 0);
}

TEST_GROUP(LatestValue){};

TEST(LatestValue, ReaderNeverSeesTwoStoresMixed) {
  struct Wide {
    std::array<std::uint64_t, 9> all_equal;
  };
  LatestValue<Wide> sut;
  CHECK(!sut.rt_load());
  std::atomic<bool> done{false};
  std::uint64_t mixed = 0, backwards = 0, reads = 0;
  std::thread reader{[&] {
    std::uint64_t last = 0;
    while (!done.load()) {
      const auto value = sut.rt_load();
      if (!value) continue;
      ++reads;
      for (const std::uint64_t word : value->all_equal) mixed += word != value->all_equal[0] ? 1 : 0;
      backwards += value->all_equal[0] < last ? 1 : 0;
      last = value->all_equal[0];
    }
  }};
  for (std::uint64_t i = 1; i <= k_items; ++i) {
    Wide value;
    value.all_equal.fill(i);
    sut.rt_store(value);
    if (i % 4096 == 0) std::this_thread::yield();
  }
  done.store(true);
  reader.join();
  LONGS_EQUAL(0, mixed);
  LONGS_EQUAL(0, backwards);
}

TEST_GROUP(BufferPool){};

TEST(BufferPool, GivesEachBufferToOneHolderAndNothingWhenAllAreOut) {
  BufferPool<int> sut{3};
  const auto a = sut.rt_acquire(), b = sut.rt_acquire(), c = sut.rt_acquire();
  CHECK(a && b && c);
  CHECK(*a != *b && *b != *c && *a != *c);
  CHECK(!sut.rt_acquire());
  sut.rt_release(*b);
  LONGS_EQUAL(1, sut.rt_free_count());
  LONGS_EQUAL(*b, *sut.rt_acquire());
}

TEST(BufferPool, MoreBuffersThanAWordHoldsAreAllGivenAndTakenBack) {
  BufferPool<int, 130> sut{130};
  std::vector<bool> given(130);
  for (int i = 0; i < 130; ++i) {
    const auto index = sut.rt_acquire();
    CHECK(index && *index < 130 && !given[*index]);
    given[*index] = true;
  }
  CHECK(!sut.rt_acquire());
  for (const BufferIndex index : {0U, 63U, 64U, 127U, 128U, 129U}) sut.rt_release(index);
  LONGS_EQUAL(6, sut.rt_free_count());
  for (int i = 0; i < 6; ++i) CHECK(sut.rt_acquire().has_value());
  CHECK(!sut.rt_acquire());
}

TEST(BufferPool, TwoThreadsNeverHoldTheSameBuffer) {
  BufferPool<std::atomic<int>> sut{3};
  std::atomic<int> clashes{0};
  const auto work = [&] {
    for (std::uint32_t i = 0; i < k_items; ++i) {
      const auto index = sut.rt_acquire();
      if (!index) continue;
      if (sut[*index].fetch_add(1) != 0) ++clashes;
      sut[*index].fetch_sub(1);
      sut.rt_release(*index);
    }
  };
  std::thread other{work};
  work();
  other.join();
  LONGS_EQUAL(0, clashes.load());
  LONGS_EQUAL(3, sut.rt_free_count());
}

}  // namespace biteline::rt
