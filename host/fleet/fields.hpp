// SPDX-License-Identifier: MIT
#pragma once
/// \file The one border of what comes over the broker: JSON's fields, each with its type and its bounds.

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/core/result.hpp"
#include "common/core/text_bounds.hpp"
#include "host/interfaces/control/messages.hpp"

namespace biteline::fleet {

using control::Json;

inline constexpr std::size_t k_most_text_bytes = bounds::k_reason;
inline constexpr std::int64_t k_most_number = 1LL << 53;

/// Reads fields and remembers the first that is wrong.
class Fields {
 public:
  Fields(std::string_view text, const char* what) : what_{what} {
    if (std::optional<Json> json = control::parse_bounded(text); json && json->is_object()) {
      json_ = std::move(*json);
    } else {
      fault("a JSON object");
    }
  }

  std::string text(const char* key, std::size_t most = k_most_text_bytes) {
    const Json* const value = find(key);
    if (value == nullptr || !value->is_string()) return fault(key), std::string{};
    auto text = value->get<std::string>();
    if (text.size() > most || text.find('\0') != std::string::npos) return fault(key), std::string{};
    return text;
  }
  std::int64_t whole(const char* key) {
    const Json* const value = find(key);
    if (value == nullptr || !value->is_number_integer()) return fault(key), 0;
    const auto number = value->get<std::int64_t>();
    if (number < 0 || number > k_most_number) return fault(key), 0;
    return number;
  }
  bool truth(const char* key) {
    const Json* const value = find(key);
    if (value == nullptr || !value->is_boolean()) return fault(key), false;
    return value->get<bool>();
  }
  std::optional<double> number_if(const char* key) {
    const Json* const value = find(key);
    if (value == nullptr || value->is_null()) return std::nullopt;
    if (!value->is_number() || !std::isfinite(value->get<double>())) return fault(key), std::nullopt;
    return value->get<double>();
  }
  const Json* find(const char* key) const {
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
  }
  void fault(const char* key) {
    if (wrong_.empty()) wrong_ = key;
  }
  /// Empty: nothing is wrong so far.
  [[nodiscard]] std::string fault_words() const {
    return wrong_.empty() ? std::string{} : wrong_ + " is missing or out of bounds";
  }
  Result<void> finish() const {
    if (wrong_.empty()) return {};
    return fail(Errc::ProtocolError, "%s: %s", what_, fault_words().c_str());
  }

 private:
  const char* what_;
  Json json_ = Json::object();
  std::string wrong_;
};

/// Texts of a memory may hold anything: what is no UTF-8 is replaced.
inline std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace biteline::fleet
