// SPDX-License-Identifier: MIT
// Packed columns: what unpacks packs to the same numbers, and any numbers come back.
#include "common/wire/packing.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

namespace {

void demand_round_trip(const std::vector<std::uint32_t>& numbers, wire::Lengths lengths, std::uint32_t step) {
  std::vector<std::uint8_t> packed;
  wire::pack(numbers, lengths, step, packed);
  std::vector<std::uint32_t> again(numbers.size());
  fuzz::demand(wire::unpack(packed, lengths, step, again).has_value() && again == numbers,
               "numbers come back");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case bytes{data, size};
  const auto head = bytes.take<std::uint16_t>();
  const auto lengths = (head & 1U) != 0 ? wire::Lengths::Sparse : wire::Lengths::Dense;
  const std::uint32_t step = (head >> 1U) & 1U;
  std::vector<std::uint32_t> numbers((head >> 2U) & 0xFFFU);
  const std::vector<std::uint8_t> packed = bytes.rest();
  if (wire::unpack(packed, lengths, step, numbers)) demand_round_trip(numbers, lengths, step);
  numbers.assign(packed.size() / sizeof(std::uint32_t), 0);
  if (!numbers.empty()) std::memcpy(numbers.data(), packed.data(), numbers.size() * sizeof(std::uint32_t));
  demand_round_trip(numbers, lengths, step);
  return 0;
}
