// SPDX-License-Identifier: MIT
// Messages: any bytes under a check sum that fits are refused or read; what is read is sent again and read
// the same way.
#include "common/wire/checksum.hpp"
#include "common/wire/messages.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) return 0;
  wire::Bytes packet(data, data + size - 4);
  const std::uint32_t sum = wire::crc32c(packet);
  packet.resize(size);
  std::memcpy(packet.data() + size - 4, &sum, sizeof sum);
  const auto message = wire::decode(packet);
  if (!message) {
    fuzz::demand_clean(message.error());
    return 0;
  }
  wire::Bytes again;
  wire::encode(*message, again);
  const auto second = wire::decode(again);
  fuzz::demand(second.has_value() && second->body.index() == message->body.index(),
               "a message that was read can be sent");
  wire::Bytes third;
  wire::encode(*second, third);
  fuzz::demand(third == again, "and is the same then");
  return 0;
}
