// SPDX-License-Identifier: MIT
#include "host/records/digest/digest.hpp"

#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <limits>
#include <vector>

#include "common/core/contracts.hpp"
#include "common/system/file.hpp"

namespace biteline {

void Digest::Closer::operator()(evp_md_ctx_st* context) const {
  EVP_MD_CTX_free(context);
}

Digest::Digest() : context_{EVP_MD_CTX_new()} {
  BITELINE_EXPECTS(context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
}

Digest& Digest::add(std::string_view bytes) {
  EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size());
  return *this;
}

Digest& Digest::add_text(std::string_view text) {
  return add(std::to_string(text.size())).add(":").add(text);
}

std::string Digest::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned size = 0;
  EVP_DigestFinal_ex(context_.get(), bytes.data(), &size);
  constexpr const char* k_digits = "0123456789abcdef";
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    text += k_digits[bytes.at(i) >> 4U];
    text += k_digits[bytes.at(i) & 15U];
  }
  return text;
}

Result<std::string> digest_of_file(const std::filesystem::path& file) {
  BITELINE_TRY(check_regular_file(file, std::numeric_limits<std::uint64_t>::max()));
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in{std::fopen(file.c_str(), "rb"), &std::fclose};
  if (!in) return fail_errno(Errc::FileUnreadable, errno, "%s", file.c_str());
  std::vector<char> piece(1U << 18U);
  Digest digest;
  while (true) {
    const std::size_t count = std::fread(piece.data(), 1, piece.size(), in.get());
    digest.add({piece.data(), count});
    if (count < piece.size()) break;
  }
  if (std::ferror(in.get()) != 0) return fail_errno(Errc::FileUnreadable, errno, "%s", file.c_str());
  return digest.hex();
}

}  // namespace biteline
