// SPDX-License-Identifier: MIT
#pragma once
/// \file A release: models and processes as one file, and the signed text that vouches for it.
///
/// `NAME.tar` is an archive (host/records/archive) of models/MODEL/... and processes/PROCESS.yaml. Beside it
/// stand `NAME.tar.manifest`, a few lines with its SHA-256, and their ed25519 signature
/// `NAME.tar.manifest.sig`, made with openssl as that of the sensor's versions.  The private key stays where
/// releases are made.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/core/result.hpp"

namespace biteline::release {

inline constexpr const char* k_archive_kind = "release";
inline constexpr const char* k_models = "models";
inline constexpr const char* k_processes = "processes";
inline constexpr const char* k_manifest_suffix = ".manifest";
inline constexpr const char* k_signature_suffix = ".manifest.sig";
inline constexpr std::uint64_t k_most_bytes = 1ULL << 30U;
inline constexpr std::size_t k_signature_bytes = 64;
inline constexpr std::size_t k_most_manifest_bytes = 400;

struct Manifest {
  std::string name;    ///< for people
  std::string sha256;  ///< of the file: what it is known by
  std::uint64_t bytes{0};
};

[[nodiscard]] std::string to_text(const Manifest& manifest);
[[nodiscard]] Result<Manifest> read_manifest(std::string_view text);

/// Errc::AuthenticationFailed where `signature` is not that of `text` by the key whose public half is in the
/// PEM file; Errc::FileUnreadable: that file is no ed25519 key.  `what`: for people, "the release".
[[nodiscard]] Result<void> check_signature(const std::filesystem::path& public_key, std::string_view text,
                                           std::string_view signature, const char* what);

/// Errc::SizeMismatch or BadValue where the file is not the one that the manifest names.
[[nodiscard]] Result<void> check_file(const std::filesystem::path& file, const Manifest& manifest);

}  // namespace biteline::release
