// SPDX-License-Identifier: MIT
#pragma once
/// \file Live pictures and what observers want, to and from the schema's tables.  Private to common/wire.

#include "common/wire/messages.hpp"
#include "common/wire/protocol_generated.h"

namespace biteline::wire {

/// 0 to 1000 Hz.
[[nodiscard]] bool is_rate(double rate_hz);

[[nodiscard]] flatbuffers::Offset<fb::PictureWish> pack_wish(flatbuffers::FlatBufferBuilder& fbb,
                                                             const PictureWish& wish);
/// No pictures when absent.
[[nodiscard]] Result<PictureWish> read_wish(const fb::PictureWish* table);

[[nodiscard]] flatbuffers::Offset<fb::Picture> pack_picture(flatbuffers::FlatBufferBuilder& fbb,
                                                            const Picture& picture);
/// Raw pixels are as many as the region and the step say.  A JPEG is not looked into.
[[nodiscard]] Result<Picture> read_picture(const fb::Picture& table);

}  // namespace biteline::wire
