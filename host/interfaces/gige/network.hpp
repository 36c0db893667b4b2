// SPDX-License-Identifier: MIT
#pragma once
/// \file The interface on which the face is to be seen, and why it may not be.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::gige {

/// IPv4 in the host's byte order.
struct Interface {
  std::string name;
  std::uint32_t address{0}, mask{0};
  std::array<std::uint8_t, 6> mac{};  ///< zeros on loopback
  bool loopback{false};

  [[nodiscard]] std::uint32_t broadcast() const { return address | ~mask; }
};

/// "192.0.2.7"; nothing: no IPv4 address.
[[nodiscard]] std::optional<std::uint32_t> read_address(const std::string& text);
[[nodiscard]] std::string address_text(std::uint32_t address);

/// Those of this machine with an IPv4 address.
[[nodiscard]] Result<std::vector<Interface>> interfaces();

/// Of a name or an address; any address of 127.0.0.0/8 is on loopback.  Errc::InvalidArgument names those
/// there are.
[[nodiscard]] Result<Interface> choose_interface(const std::vector<Interface>& all,
                                                 const std::string& wanted);

/// Errc::InvalidArgument: the camera at this address is reached by this interface.
[[nodiscard]] Result<void> keep_off_camera(const Interface& interface, std::uint32_t camera);

/// Asks for half a second which GigE Vision devices there are on the interface's network; their addresses.
[[nodiscard]] Result<std::vector<std::uint32_t>> devices_on(const Interface& interface);

}  // namespace biteline::gige
