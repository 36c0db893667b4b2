// SPDX-License-Identifier: MIT
#pragma once
/// \file What shows that whoever makes the first account is at the machine itself, as the service's own user.

#include <filesystem>

#include "host/interfaces/accounts/accounts.hpp"

namespace biteline::accounts {

/// In the folder of results, for the service's user alone.
inline constexpr const char* k_first_token_file = ".first.token";

/// While nobody has an account: a new token in `folder`, and from now on `accounts` asks for it.  A door's
/// word that it was asked on this machine is no proof: any program may say so, and a door on another machine
/// does. Where there are accounts an old file goes.
[[nodiscard]] Result<void> offer_first_account(Accounts& accounts, const std::filesystem::path& folder);

/// Empty: none is there, or it is another user's.
[[nodiscard]] std::string read_first_token(const std::filesystem::path& folder);

}  // namespace biteline::accounts
