// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/told_version.hpp"

#include "common/rtde/big_endian.hpp"
#include "host/robot/link/ur/hear_primary.hpp"
#include "host/robot/link/ur/primary_messages.hpp"

namespace biteline::robot::ur {

Result<std::optional<SoftwareVersion>> version_in(std::span<const std::uint8_t> heard) {
  constexpr std::uint8_t k_message = 20, k_version = 3;
  for (;;) {
    BITELINE_ASSIGN(const std::optional<Part> message, take_part(heard));
    if (!message) return std::optional<SoftwareVersion>{};
    if (message->type != k_message) continue;
    rtde::Reader body{message->body};
    static_cast<void>(body.get<std::uint64_t>());  // stamp
    static_cast<void>(body.get<std::uint8_t>());   // source
    if (body.get<std::uint8_t>() != k_version) continue;
    static_cast<void>(body.get_text(body.get<std::uint8_t>().value_or(0)));  // "URControl"
    const int major = body.get<std::uint8_t>().value_or(0), minor = body.get<std::uint8_t>().value_or(0);
    const int bugfix = body.get<std::int32_t>().value_or(0);
    if (body.failed()) return fail(Errc::BadFormat, "a version message that ends too early");
    return std::optional{SoftwareVersion{major, minor, bugfix}};
  }
}

Result<SoftwareVersion> ask_version(const Endpoint& script, Nanoseconds patience) {
  return hear_primary<SoftwareVersion>(script, patience, "the version of its software", &version_in);
}

}  // namespace biteline::robot::ur
