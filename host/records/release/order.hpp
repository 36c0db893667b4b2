// SPDX-License-Identifier: MIT
#pragma once
/// \file The order of a switch: which release, in which cells, from when on.  Signed as the releases are, so
/// that neither a centre nor a broker can bring one into force that its maker did not order.
///
/// A few lines of text; beside it stands its ed25519 signature `ORDER.sig`.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.hpp"
#include "host/records/release/plan.hpp"

namespace biteline::release {

inline constexpr const char* k_order_signature_suffix = ".sig";
/// Some 600 cells; what the broker takes in one message is 65536.
inline constexpr std::size_t k_most_order_bytes = 40'000;

struct Order {
  std::int64_t number{0};  ///< a later order has a larger one; from 1 on
  std::string sha256;      ///< of the release
  std::int64_t at_ms{0};   ///< since 1970, UTC
  std::vector<std::string> cells;

  [[nodiscard]] bool is_for(std::string_view cell) const;
};

[[nodiscard]] std::string to_text(const Order& order);
[[nodiscard]] Result<Order> read_order(std::string_view text);

/// An order whose signature was checked, as the centre tells of it.
struct HeardOrder {
  Order order;
  std::string digest;  ///< SHA-256 of its text
  bool sure{false};    ///< all its cells know it
};

/// The plan once this order was heard, or none (nullptr).  A switch that is sure stays, whatever is heard of
/// others. Errc::WrongState: the order is older than one that is known here, another one of the same number,
/// first heard after its time, or it comes before a switch that is sure. `has`: its release is whole on this
/// disk; else the order waits and is not known here.
[[nodiscard]] Result<Plan> follow(const Plan& stands, const HeardOrder* heard, bool has, std::int64_t now_ms);

}  // namespace biteline::release
