// SPDX-License-Identifier: MIT
#pragma once
/// \file Who runs this process.

#include <string>

namespace biteline {

/// The login name of the process's user; "user NUMBER" where the system has no name for it.
[[nodiscard]] std::string user_name();

}  // namespace biteline
