// SPDX-License-Identifier: MIT
#pragma once
/// \file One profile to and from the generated schema code.  Private to common/wire.

#include "common/wire/messages.hpp"
#include "common/wire/protocol_generated.h"

namespace biteline::wire {

[[nodiscard]] flatbuffers::Offset<fb::Profile> pack_profile(flatbuffers::FlatBufferBuilder& fbb,
                                                            const profile::ProfileHeader& header,
                                                            std::span<const profile::ProfilePoint> points);

/// Checks what the verifier cannot: counts, column lengths, finite numbers, the pose.
[[nodiscard]] Result<profile::Profile> read_profile(const fb::Profile& table);

}  // namespace biteline::wire
