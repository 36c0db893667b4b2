// SPDX-License-Identifier: MIT
#pragma once
/// \file Both sides' keys in one folder, as if the public ones had been carried over.

#include <filesystem>

#include "common/wire/keys.hpp"

namespace biteline::test {

inline Result<void> make_key_set(const std::filesystem::path& folder) {
  BITELINE_TRY(wire::make_sensor_keys(folder));
  BITELINE_TRY(wire::make_host_keys(folder));
  return wire::allow_host(folder, "host", folder / "host.public");
}

}  // namespace biteline::test
