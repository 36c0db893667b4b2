// SPDX-License-Identifier: MIT
#include "common/wire/binary_schema.hpp"

#include <cstddef>

#include "common/wire/protocol_bfbs_generated.h"

namespace biteline::wire {

std::span<const std::uint8_t> binary_schema() {
  return {fb::EnvelopeBinarySchema::data(), fb::EnvelopeBinarySchema::size()};
}

}  // namespace biteline::wire
