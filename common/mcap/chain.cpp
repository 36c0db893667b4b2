// SPDX-License-Identifier: MIT
#include "common/mcap/chain.hpp"

#include <openssl/evp.h>

#include "common/core/contracts.hpp"

namespace biteline::mcap {

void Sha256::Closer::operator()(evp_md_ctx_st* context) const {
  EVP_MD_CTX_free(context);
}

Sha256::Sha256() : context_{EVP_MD_CTX_new()} {
  BITELINE_EXPECTS(context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
}

void Sha256::add(View bytes) {
  EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size());
}

std::array<std::uint8_t, 32> Sha256::take() {
  std::array<std::uint8_t, 32> bytes{};
  EVP_DigestFinal_ex(context_.get(), bytes.data(), nullptr);
  BITELINE_EXPECTS(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  return bytes;
}

std::string hex(View bytes) {
  constexpr const char* k_digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += k_digits[byte >> 4U];
    text += k_digits[byte & 15U];
  }
  return text;
}

std::string Chain::close_link() {
  const std::array<std::uint8_t, 32> link = hash_.take();
  begin(link);
  return hex(link);
}

}  // namespace biteline::mcap
