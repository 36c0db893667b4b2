// SPDX-License-Identifier: MIT
#include "host/records/release/manifest.hpp"

#include <openssl/evp.h>
#include <openssl/pem.h>

#include <cstdio>
#include <memory>

#include "common/system/file.hpp"
#include "host/records/digest/digest.hpp"
#include "host/records/release/key_lines.hpp"

namespace biteline::release {
namespace {

constexpr std::string_view k_first = "biteline-release 1\n";

const unsigned char* bytes_of(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

}  // namespace

std::string to_text(const Manifest& manifest) {
  std::string text{k_first};
  text.append("name ").append(manifest.name).append("\nsha256 ").append(manifest.sha256);
  return text.append("\nbytes ").append(std::to_string(manifest.bytes)).append("\n");
}

Result<Manifest> read_manifest(std::string_view text) {
  if (text.size() > k_most_manifest_bytes || !text.starts_with(k_first))
    return fail(Errc::BadFormat, "manifest of a release: 'biteline-release 1' expected in its first line");
  KeyLines lines{text.substr(k_first.size()), "manifest of a release"};
  Manifest manifest;
  manifest.name = lines.value("name");
  manifest.sha256 = lines.value("sha256");
  manifest.bytes = static_cast<std::uint64_t>(lines.whole("bytes"));
  if (!is_release_name(manifest.name)) lines.fault("name");
  if (!is_sha256(manifest.sha256)) lines.fault("sha256");
  if (manifest.bytes == 0 || manifest.bytes > k_most_bytes) lines.fault("bytes");
  BITELINE_TRY(lines.finish());
  return manifest;
}

Result<void> check_signature(const std::filesystem::path& public_key, std::string_view text,
                             std::string_view signature, const char* what) {
  BITELINE_ASSIGN(const std::string pem, read_regular_file(public_key, k_most_settings_bytes));
  const std::unique_ptr<BIO, int (*)(BIO*)> source{BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())),
                                                   &BIO_free};
  const std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)> key{
      source ? PEM_read_bio_PUBKEY(source.get(), nullptr, nullptr, nullptr) : nullptr, &EVP_PKEY_free};
  if (!key || EVP_PKEY_base_id(key.get()) != EVP_PKEY_ED25519)
    return fail(Errc::FileUnreadable, "%.200s: a public ed25519 key (PEM) expected", public_key.c_str());
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
  const bool vouched = context && signature.size() == k_signature_bytes &&
                       EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, key.get()) == 1 &&
                       EVP_DigestVerify(context.get(), bytes_of(signature), signature.size(), bytes_of(text),
                                        text.size()) == 1;
  if (vouched) return {};
  return fail(Errc::AuthenticationFailed, "%s is not signed by %.150s", what, public_key.c_str());
}

Result<void> check_file(const std::filesystem::path& file, const Manifest& manifest) {
  std::error_code error;
  if (const auto bytes = std::filesystem::file_size(file, error); error || bytes != manifest.bytes)
    return fail(Errc::SizeMismatch, "%.200s: %llu bytes expected", file.c_str(),
                static_cast<unsigned long long>(manifest.bytes));
  BITELINE_ASSIGN(const std::string digest, digest_of_file(file));
  if (digest == manifest.sha256) return {};
  return fail(Errc::BadValue, "%.200s is not the file that was signed: SHA-256 %.16s..., not %.16s...",
              file.c_str(), digest.c_str(), manifest.sha256.c_str());
}

}  // namespace biteline::release
