// SPDX-License-Identifier: MIT
#pragma once
/// \file The first account, made at the cell itself: nobody can log in before it.

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/wire/endpoint.hpp"

namespace biteline::web {

struct AddUserRequest {
  std::string name;
  std::string role;
  std::filesystem::path out;              ///< the service's results folder, while no service holds it
  std::optional<wire::Endpoint> control;  ///< of a service that runs; loopback: only the first account
  std::optional<std::filesystem::path> control_keys;
};

/// One line of `input`: from a terminal unseen and asked for twice.  Never from the command line, which every
/// user of the machine can read.
[[nodiscard]] Result<std::string> read_password(std::FILE* input);

/// Errc::PeerRefused: a service holds the folder; Errc::NoRights: there are accounts already, and an
/// administrator must make the next.
[[nodiscard]] Result<void> add_user(const AddUserRequest& request, const std::string& password);

}  // namespace biteline::web
