// SPDX-License-Identifier: MIT
#pragma once
/// \file Passwords and tokens: what is kept of them tells nobody what they are.

#include <string>

#include "common/core/result.hpp"

namespace biteline::accounts {

/// argon2id, 19 MiB, two passes, one lane: OWASP's first choice for it (Password Storage Cheat Sheet); some
/// 30 ms. The text holds salt and settings (PHC string).  Errc::DeviceError without memory or random numbers.
[[nodiscard]] Result<std::string> hash_password(const std::string& password);
/// Takes as long for a wrong password as for the right one.
[[nodiscard]] bool is_password(const std::string& password, const std::string& hash);

/// 256 random bits of the kernel as 64 hex digits.
[[nodiscard]] Result<std::string> make_token();
/// One way and always the same; cheap, because a token of 256 random bits cannot be tried out.
[[nodiscard]] std::string hash_token(const std::string& token);

}  // namespace biteline::accounts
