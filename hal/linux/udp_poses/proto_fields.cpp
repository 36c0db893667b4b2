// SPDX-License-Identifier: MIT
#include "hal/linux/udp_poses/proto_fields.hpp"

namespace biteline::hal {

std::optional<ProtoFields::Field> ProtoFields::next() {
  if (rest_.empty() || !whole_) return std::nullopt;
  const std::optional<Field> found = field();
  whole_ = found.has_value();
  return found;
}

std::optional<ProtoFields::Field> ProtoFields::field() {
  const std::optional<std::uint64_t> key = varint();
  if (!key || *key >> 3U == 0) return std::nullopt;
  Field found{.number = *key >> 3U, .type = static_cast<Type>(*key & 7U)};
  std::optional<std::uint64_t> value;
  switch (found.type) {
    case Type::Varint:
    case Type::Bytes:
      value = varint();
      break;
    case Type::Fixed64:
      value = fixed(8);
      break;
    case Type::Fixed32:
      value = fixed(4);
      break;
  }
  if (!value) return std::nullopt;  // cut off, or a type that is none: groups are of Protocol Buffers 1
  if (found.type != Type::Bytes) {
    found.value = *value;
    return found;
  }
  if (*value > rest_.size()) return std::nullopt;
  found.bytes = rest_.first(static_cast<std::size_t>(*value));
  rest_ = rest_.subspan(static_cast<std::size_t>(*value));
  return found;
}

std::optional<std::uint64_t> ProtoFields::varint() {
  constexpr std::size_t k_longest = 10;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < k_longest && i < rest_.size(); ++i) {
    value |= static_cast<std::uint64_t>(rest_[i] & 0x7FU) << (7 * i);
    if ((rest_[i] & 0x80U) != 0) continue;
    rest_ = rest_.subspan(i + 1);
    return value;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> ProtoFields::fixed(std::size_t count) {
  if (rest_.size() < count) return std::nullopt;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= static_cast<std::uint64_t>(rest_[i]) << (8 * i);
  rest_ = rest_.subspan(count);
  return value;
}

}  // namespace biteline::hal
