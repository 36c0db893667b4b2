// SPDX-License-Identifier: MIT
#include "host/interfaces/accounts/secrets.hpp"

#include <argon2.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <span>

namespace biteline::accounts {
namespace {

constexpr std::uint32_t k_passes = 2;
constexpr std::uint32_t k_memory_kib = 19 * 1024;
constexpr std::uint32_t k_lanes = 1;
constexpr std::size_t k_salt_bytes = 16;
constexpr std::size_t k_hash_bytes = 32;
constexpr std::size_t k_token_bytes = 32;
/// Of hash_token(): the least that argon2 takes; and a salt that only says what the hash is for.
constexpr std::uint32_t k_token_memory_kib = 8;
constexpr std::array<char, 16> k_token_salt{'b', 'i', 't', 'e', 'l', 'i', 'n', 'e',
                                            '-', 's', 'e', 's', 's', 'i', 'o', 'n'};

Result<void> fill_random(std::span<std::uint8_t> bytes) {
  if (::getrandom(bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size())) return {};
  return fail_errno(Errc::DeviceError, errno, "getrandom");
}

std::string hex(std::span<const std::uint8_t> bytes) {
  constexpr const char* k_digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += k_digits[byte >> 4U];
    text += k_digits[byte & 0xFU];
  }
  return text;
}

}  // namespace

Result<std::string> hash_password(const std::string& password) {
  std::array<std::uint8_t, k_salt_bytes> salt{};
  BITELINE_TRY(fill_random(salt));
  std::string encoded(
      argon2_encodedlen(k_passes, k_memory_kib, k_lanes, k_salt_bytes, k_hash_bytes, Argon2_id), '\0');
  const int code =
      argon2id_hash_encoded(k_passes, k_memory_kib, k_lanes, password.data(), password.size(), salt.data(),
                            salt.size(), k_hash_bytes, encoded.data(), encoded.size());
  if (code != ARGON2_OK) return fail(Errc::DeviceError, "argon2: %s", argon2_error_message(code));
  encoded.resize(encoded.find('\0'));
  return encoded;
}

bool is_password(const std::string& password, const std::string& hash) {
  return argon2id_verify(hash.c_str(), password.data(), password.size()) == ARGON2_OK;
}

Result<std::string> make_token() {
  std::array<std::uint8_t, k_token_bytes> bytes{};
  BITELINE_TRY(fill_random(bytes));
  return hex(bytes);
}

std::string hash_token(const std::string& token) {
  std::array<std::uint8_t, k_hash_bytes> hash{};
  const int code = argon2id_hash_raw(1, k_token_memory_kib, 1, token.data(), token.size(),
                                     k_token_salt.data(), k_token_salt.size(), hash.data(), hash.size());
  return code == ARGON2_OK ? hex(hash) : std::string{};
}

}  // namespace biteline::accounts
