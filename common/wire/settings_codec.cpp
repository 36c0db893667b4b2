// SPDX-License-Identifier: MIT
#include "common/wire/settings_codec.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::wire {

flatbuffers::Offset<flatbuffers::String> settings_text(flatbuffers::FlatBufferBuilder& fbb,
                                                       const std::string& source) {
  if (source.empty()) return {};
  return fbb.CreateString(source.data(), std::min(source.size(), k_max_settings_bytes));
}

Result<std::string> to_settings_text(const flatbuffers::String* source) {
  if (source == nullptr) return std::string{};
  if (source->size() > k_max_settings_bytes) {
    return fail(Errc::ProtocolError, "settings of %u bytes: at most %zu expected",
                static_cast<unsigned>(source->size()), k_max_settings_bytes);
  }
  std::string text = source->str();
  std::ranges::replace_if(
      text, [](unsigned char c) { return c != '\n' && (c < 0x20 || c == 0x7f); }, '?');
  return text;
}

flatbuffers::Offset<fb::SettingsState> pack_settings(flatbuffers::FlatBufferBuilder& fbb,
                                                     const std::optional<SettingsState>& settings) {
  if (!settings) return {};
  return fb::CreateSettingsState(fbb, settings_text(fbb, settings->text), settings->rate_max_hz,
                                 settings->changes);
}

Result<std::optional<SettingsState>> read_settings(const fb::SettingsState* table) {
  if (table == nullptr) return std::optional<SettingsState>{};
  if (!std::isfinite(table->rate_max_hz()) || table->rate_max_hz() < 0)
    return fail(Errc::ProtocolError, "settings: a highest rate that is none");
  BITELINE_ASSIGN(std::string text, to_settings_text(table->text()));
  return SettingsState{
      .text = std::move(text), .rate_max_hz = table->rate_max_hz(), .changes = table->changes()};
}

}  // namespace biteline::wire
