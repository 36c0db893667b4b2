// SPDX-License-Identifier: MIT
#include "host/bite_line/pooled_vector.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace biteline::bite_line {

TEST_GROUP(LargeMemory){};

TEST(LargeMemory, TheNextScansArrayOfAboutThatSizeLiesWhereTheLastOneLay) {
  const void* place = nullptr;
  {
    PooledVector<float> sut(1'450'000);
    place = sut.data();
  }
  const PooledVector<float> other(700'000);  // of another size: not there
  const PooledVector<float> again(1'449'000);
  POINTERS_EQUAL(place, again.data());
  CHECK(other.data() != place);
}

TEST(LargeMemory, TwoArraysAtATimeNeverShareABlock) {
  const auto lost_of = [](std::uint8_t value) {
    std::size_t lost = 0;
    for (int round = 0; round < 200; ++round) {
      const PooledVector<std::uint8_t> sut(100'000 + static_cast<std::size_t>(round) * 500, value);
      lost += static_cast<std::size_t>(std::ranges::count_if(sut, [&](auto held) { return held != value; }));
    }
    return lost;
  };
  std::size_t lost_beside = 1;
  std::thread beside{[&] { lost_beside = lost_of(1); }};
  LONGS_EQUAL(0, lost_of(2));
  beside.join();
  LONGS_EQUAL(0, lost_beside);
}

TEST(LargeMemory, ManyAndHugeArraysAreTakenAndGivenBack) {
  std::vector<PooledVector<std::uint8_t>> many;
  for (std::size_t i = 0; i < 2000; ++i) many.emplace_back(40'000, std::uint8_t{3});
  many.clear();
  PooledVector<std::uint8_t> huge(100'000'000, std::uint8_t{4});
  LONGS_EQUAL(4, huge.back());
}

}  // namespace biteline::bite_line
