// SPDX-License-Identifier: MIT
#include "common/wire/packing.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

#include "tests/support/errors.hpp"

namespace biteline::wire {
namespace {

std::vector<std::uint32_t> round_trip(const std::vector<std::uint32_t>& values, Lengths lengths,
                                      std::uint32_t step) {
  std::vector<std::uint8_t> packed{0xAB};  // packing appends
  pack(values, lengths, step, packed);
  std::vector<std::uint32_t> result(values.size());
  const Result<void> unpacked = unpack(std::span{packed}.subspan(1), lengths, step, result);
  SUCCEEDS(unpacked);
  return result;
}

}  // namespace

TEST_GROUP(Packing){};

TEST(Packing, EveryBitPatternComesBack) {
  std::mt19937 random{3};
  for (const Lengths lengths : {Lengths::Dense, Lengths::Sparse}) {
    for (const std::uint32_t step : {0U, 1U}) {
      std::vector<std::uint32_t> values{0, 0xFFFFFFFF, 0x80000000, 0x7FFFFFFF, 1,    0x7FC00000,
                                        0, 255,        256,        65535,      65536};
      for (int i = 0; i < 1000; ++i) values.push_back(random() >> (random() % 32));
      CHECK(values == round_trip(values, lengths, step));
    }
  }
}

TEST(Packing, NothingPacksToNothing) {
  CHECK(round_trip({}, Lengths::Dense, 0).empty());
}

TEST(Packing, CountingNumbersCostTwoBitsEach) {
  std::vector<std::uint32_t> columns(1000);
  for (std::uint32_t i = 0; i < 1000; ++i) columns[i] = i + 1;
  std::vector<std::uint8_t> packed;
  pack(columns, Lengths::Sparse, 1, packed);
  // The first differs from its prediction (0) by 1, which costs a byte.
  LONGS_EQUAL(1000 / 4 + 1, packed.size());
}

TEST(Packing, CutOrLongerBytesAreRefusedAndNeverReadBeyond) {
  const std::vector<std::uint32_t> values{1, 70000, 3, 0xFFFFFFFF, 5};
  std::vector<std::uint8_t> packed;
  pack(values, Lengths::Dense, 0, packed);
  std::vector<std::uint32_t> result(values.size());
  for (std::size_t size = 0; size < packed.size(); ++size) {
    // A copy of exactly that size, so that the address sanitizer sees a read beyond it.
    const std::vector<std::uint8_t> cut{packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size)};
    FAILS_NAMING(Errc::Truncated, "cut off", unpack(cut, Lengths::Dense, 0, result));
  }
  packed.push_back(0);
  FAILS_NAMING(Errc::BadFormat, "left over", unpack(packed, Lengths::Dense, 0, result));
}

}  // namespace biteline::wire
