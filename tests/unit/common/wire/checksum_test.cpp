// SPDX-License-Identifier: MIT
#include "common/wire/checksum.hpp"

#include <CppUTest/TestHarness.h>

#include <numeric>
#include <vector>

namespace biteline::wire {

TEST_GROUP(Checksum){};

TEST(Checksum, AgreesWithTheStandardsExamples) {
  // RFC 3720, appendix B.4: 32 bytes of zeros, of ones, rising.
  std::vector<std::uint8_t> bytes(32, 0);
  LONGS_EQUAL(0x8A9136AA, crc32c(bytes));
  bytes.assign(32, 0xFF);
  LONGS_EQUAL(0x62A8AB43, crc32c(bytes));
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  LONGS_EQUAL(0x46DD794E, crc32c(bytes));
}

TEST(Checksum, LengthsThatAreNoMultipleOfEightAgreeToo) {
  // "123456789", the check value of every CRC catalogue.
  const std::uint8_t digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  LONGS_EQUAL(0xE3069283, crc32c(digits));
  LONGS_EQUAL(0, crc32c({}));
}

}  // namespace biteline::wire
