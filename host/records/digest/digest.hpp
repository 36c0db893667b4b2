// SPDX-License-Identifier: MIT
#pragma once
/// \file SHA-256 of texts and files: what a result or a release is filed under.

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "common/core/result.hpp"

extern "C" struct evp_md_ctx_st;

namespace biteline {

/// Takes bytes and gives 64 hex digits.  Move-only; thread: one owner.
class Digest {
 public:
  Digest();
  Digest& add(std::string_view bytes);
  /// As add(), with its length before it: neighbouring texts cannot run into each other.
  Digest& add_text(std::string_view text);
  /// Call once, last.
  [[nodiscard]] std::string hex();

 private:
  struct Closer {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Closer> context_;
};

/// Of the file's bytes, read in pieces.  Fails for what is no regular file.
[[nodiscard]] Result<std::string> digest_of_file(const std::filesystem::path& file);

}  // namespace biteline
