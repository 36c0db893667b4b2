// SPDX-License-Identifier: MIT
#pragma once
/// \file The hash chain of a file: nothing before a link can be changed without changing every link after it.
///
/// A link is a metadata record `biteline.chain`.  Its `sha256` is of the link before it (32 bytes, zeros for
/// the first) and of all the file's bytes between the two links.

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "common/mcap/records.hpp"

extern "C" struct evp_md_ctx_st;

namespace biteline::mcap {

inline constexpr const char* k_chain_name = "biteline.chain";

/// SHA-256.  Move-only; thread: one owner.
class Sha256 {
 public:
  Sha256();
  void add(View bytes);
  /// 32 bytes; begins anew.
  [[nodiscard]] std::array<std::uint8_t, 32> take();

 private:
  struct Closer {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Closer> context_;
};

/// 64 digits.
[[nodiscard]] std::string hex(View bytes);

class Chain {
 public:
  Chain() { begin({}); }
  void add(View bytes) { hash_.add(bytes); }
  /// The link over all bytes since the last; what comes next is counted from here.
  [[nodiscard]] std::string close_link();

 private:
  void begin(const std::array<std::uint8_t, 32>& before) { hash_.add(before); }
  Sha256 hash_;
};

}  // namespace biteline::mcap
