// SPDX-License-Identifier: MIT
#pragma once
/// \file gate.json: the gate's decision with everything it was made from, so that anybody can make it again.

#include <filesystem>

#include "host/robot/link/gate/gate.hpp"

namespace biteline::robot {

/// Beside the result, written before the path is sent.
[[nodiscard]] Result<void> write_gate(const std::filesystem::path& file, const GateInputs& inputs);

struct GateFile {
  GateInputs inputs;
  bool permitted{false};  ///< as written
};

/// Strict: a file whose words are not what its inputs give is Errc::BadValue, one that lacks an input
/// Errc::BadFormat.
[[nodiscard]] Result<GateFile> read_gate(const std::filesystem::path& file);

}  // namespace biteline::robot
