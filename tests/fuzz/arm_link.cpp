// SPDX-License-Identifier: MIT
// A stream of the generic arm protocol, some messages with a sum that fits: what is taken is sound, and says
// the same when it is said again.
#include "common/arm_link/messages.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case bytes{data, size};
  arm_link::Reader reader;
  for (std::uint32_t number = 1; !bytes.empty(); ++number) {
    const auto kind = bytes.take<std::uint8_t>();
    arm_link::Message message = arm_link::encode(number, arm_link::Beat{});
    message[5] = kind;
    const std::vector<std::uint8_t> body = bytes.take_bytes(message.size() - 20);
    std::copy(body.begin(), body.end(), message.begin() + 16);
    if ((kind & 0x80U) == 0) {
      arm_link::Sum sum;
      sum.add(std::span{message}.first(message.size() - 4));
      const std::uint32_t value = sum.value();
      std::memcpy(message.data() + message.size() - 4, &value, sizeof value);
    }
    reader.add(message);
    const Result<std::optional<arm_link::Received>> received = reader.next();
    if (!received) {
      fuzz::demand_clean(received.error());
      return 0;
    }
    fuzz::demand(received->has_value(), "a whole message is one");
    const auto again = arm_link::decode(arm_link::encode(number, (*received)->body));
    fuzz::demand(again.has_value() && again->body.index() == (*received)->body.index(),
                 "what was taken can be said again");
    if (const auto* point = std::get_if<arm_link::PathPoint>(&(*received)->body))
      fuzz::demand(point->T_base_tcp.matrix().allFinite() && point->q_rad.allFinite(), "a point is finite");
  }
  return 0;
}
