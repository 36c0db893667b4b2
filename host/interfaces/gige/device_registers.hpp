// SPDX-License-Identifier: MIT
#pragma once
/// \file The face's memory: what may be read, what may be written, and in which range.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "common/gige/packets.hpp"
#include "host/interfaces/gige/frame.hpp"
#include "host/interfaces/gige/picture_frame.hpp"

namespace biteline::gige {

/// What the face tells of itself.
struct Identity {
  std::uint32_t address{0}, mask{0};  ///< IPv4, host's byte order
  std::array<std::uint8_t, 6> mac{};  ///< zeros on loopback
  std::string version, serial, name;  ///< cut at 31, 15 and 15 bytes
};

/// What a client chose.
struct Choices {
  Format format{Format::Abc32f};
  std::uint32_t lines{1};  ///< of a frame
  bool chunks{false};
  [[nodiscard]] bool picture() const { return format == Format::Mono8; }
  /// Records in the chunk: a picture has one.
  [[nodiscard]] std::uint32_t records() const { return picture() ? 1 : lines; }
  [[nodiscard]] bool operator==(const Choices&) const = default;
};

/// Bytes of a frame's payload: the picture, and with chunks its tag and the lines' records with theirs.
struct PayloadSize {
  std::size_t picture{0};  ///< filled up to a multiple of 4 where chunks follow
  std::size_t whole{0};
};
[[nodiscard]] PayloadSize payload_size(const Choices& choices, std::size_t columns);

/// Thread: one owner.
class DeviceRegisters {
 public:
  explicit DeviceRegisters(const Identity& identity);

  /// Whole words only: Status::BadAlignment; beyond what is there: Status::InvalidAddress.
  [[nodiscard]] Status read(std::uint32_t address, std::span<std::uint8_t> out) const;
  /// A client's word; `acquiring`: what shapes a frame stands.
  [[nodiscard]] Status write(std::uint32_t address, std::uint32_t value, bool acquiring);

  [[nodiscard]] std::uint32_t word(std::uint32_t address) const;
  void set(std::uint32_t address, std::uint32_t value) { words_[address] = value; }
  /// A head of so many columns, whose depths are told so.
  void set_head(std::size_t columns, const Depth& depth, const PictureShape& pictures);
  [[nodiscard]] Choices choices() const;
  /// Of a frame in the chosen format.
  [[nodiscard]] std::size_t columns() const;

 private:
  void set_text(std::uint32_t address, std::size_t bytes, std::string_view text);
  void set_float(std::uint32_t address, float value);
  void follow_choices();

  std::map<std::uint32_t, std::uint32_t> words_;
  std::string description_;
  std::size_t columns_{0};
  std::uint32_t lines_{1};  ///< as a client chose them, while pictures are shown, too
  Depth depth_;
  PictureShape pictures_;
};

}  // namespace biteline::gige
