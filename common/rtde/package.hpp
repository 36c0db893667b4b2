// SPDX-License-Identifier: MIT
#pragma once
/// \file RTDE packages in a TCP stream: [uint16 size][uint8 type][payload], size counts the header.
///
/// Universal Robots, "Real-Time Data Exchange (RTDE) Guide", section "Protocol".

#include <array>
#include <cstdint>
#include <optional>

#include "common/core/result.hpp"
#include "common/rtde/big_endian.hpp"

namespace biteline::rtde {

/// One letter each; requests and replies share the number, so the direction must be known to read them.
enum class PackageType : std::uint8_t {
  SetupInputs = 'I',
  TextMessage = 'M',
  SetupOutputs = 'O',
  Pause = 'P',
  Start = 'S',
  Data = 'U',
  ProtocolVersion = 'V',
  ControllerVersion = 'v',
};

/// Of the guide's kinds; later controllers may have more.
[[nodiscard]] bool is_known(PackageType type);

enum class ProtocolVersion : std::uint16_t { V1 = 1, V2 = 2 };

constexpr std::size_t k_header_bytes = 3;
constexpr std::size_t k_max_package_bytes = 65535;  ///< what the uint16 of the header can say

struct Package {
  PackageType type{};
  ByteView payload;  ///< valid until the splitter's next feed()
};

/// Cuts a TCP stream, which may arrive in any pieces, into packages.
///
/// Kinds that nobody knows come out like all others.  Bounded: holds one largest package.  A stream that
/// breaks the framing has no place to start again, so the fault latches until reset().  Thread: one owner.
/// Memory: all in the object.
class PackageSplitter {
 public:
  /// Takes the front of `bytes` as far as there is room; returns how many.  All of it when next() was drained
  /// before and `bytes` is at most 65535 long.
  [[nodiscard]] std::size_t feed(ByteView bytes);

  /// The next whole package, or nothing yet.
  [[nodiscard]] Result<std::optional<Package>> next();

  /// For a new connection.
  void reset();

 private:
  std::array<std::uint8_t, 2 * k_max_package_bytes> buffer_{};
  std::size_t begin_{0};
  std::size_t end_{0};
  bool broken_{false};
};

/// Appends one package to `out`.  Pre: the payload fits a package.
void append_package(Bytes& out, PackageType type, ByteView payload);

}  // namespace biteline::rtde
