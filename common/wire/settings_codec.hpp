// SPDX-License-Identifier: MIT
#pragma once
/// \file Settings files within messages, to and from the generated schema code.  Private to common/wire.

#include <optional>
#include <string>

#include "common/wire/messages.hpp"
#include "common/wire/protocol_generated.h"

namespace biteline::wire {

/// A settings file; absent when empty, cut at k_max_settings_bytes.
[[nodiscard]] flatbuffers::Offset<flatbuffers::String> settings_text(flatbuffers::FlatBufferBuilder& fbb,
                                                                     const std::string& source);
/// Empty when absent.  Line ends stay, other control characters become '?'.  Errc::ProtocolError: too long.
[[nodiscard]] Result<std::string> to_settings_text(const flatbuffers::String* source);

[[nodiscard]] flatbuffers::Offset<fb::SettingsState> pack_settings(
    flatbuffers::FlatBufferBuilder& fbb, const std::optional<SettingsState>& settings);
[[nodiscard]] Result<std::optional<SettingsState>> read_settings(const fb::SettingsState* table);

}  // namespace biteline::wire
