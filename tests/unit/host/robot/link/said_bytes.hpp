// SPDX-License-Identifier: MIT
#pragma once
/// \file Bytes as a controller's primary interface sends them (Universal Robots, "Client interfaces").

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "common/rtde/big_endian.hpp"

namespace biteline::robot::test {

using Bytes = std::vector<std::uint8_t>;

inline Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// A message or a part of one: length, type, body.
inline Bytes framed(std::uint8_t type, const Bytes& body) {
  Bytes out;
  rtde::Writer writer{out};
  writer.put(static_cast<std::uint32_t>(body.size() + 5));
  writer.put(type);
  return joined({out, body});
}

inline Bytes robot_message(std::uint8_t kind, const Bytes& body) {
  Bytes out;
  rtde::Writer writer{out};
  writer.put(std::uint64_t{1'000'000});  // stamp
  writer.put(std::int8_t{-2});           // source
  writer.put(kind);
  return framed(20, joined({out, body}));
}

inline Bytes runtime_exception(std::int32_t line, std::int32_t column, std::string_view text) {
  Bytes body;
  rtde::Writer writer{body};
  writer.put(line);
  writer.put(column);
  writer.put_text(text);
  return robot_message(10, body);
}

inline Bytes error_code(std::int32_t code, std::int32_t argument, std::int32_t level, std::string_view text) {
  Bytes body;
  rtde::Writer writer{body};
  for (const std::int32_t value : {code, argument, level}) writer.put(value);
  writer.put(std::uint32_t{0});  // type of the data
  writer.put(std::uint32_t{0});  // data
  writer.put_text(text);
  return robot_message(6, body);
}

inline Bytes key_message(std::string_view title, std::string_view text) {
  Bytes body;
  rtde::Writer writer{body};
  for (const std::int32_t value : {0, 0}) writer.put(value);  // code, argument
  writer.put(static_cast<std::uint8_t>(title.size()));
  writer.put_text(title);
  writer.put_text(text);
  return robot_message(7, body);
}

/// Of its mode alone.
inline Bytes robot_state() {
  return framed(16, framed(0, Bytes(42, 9)));
}

}  // namespace biteline::robot::test
