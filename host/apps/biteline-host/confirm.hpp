// SPDX-License-Identifier: MIT
#pragma once
/// \file A person's word at the start (--confirm) for one scan that lies in the results: by its own number,
/// once.

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/core/result.hpp"
#include "host/records/memory/memory.hpp"
#include "host/robot/link/gate/gate.hpp"

namespace biteline::service {

struct Confirm {
  std::string name;          ///< of its folder
  std::uint64_t scan_id{0};  ///< the sensor's, drawn for this scan alone; a live scan never has it
};

/// `name` is the scan's name alone.  Refused where no such scan lies there with its recording, and where the
/// word was used up: Errc::InvalidArgument or FileNotFound, with what to do.
[[nodiscard]] Result<Confirm> read_confirm(const std::filesystem::path& results, const std::string& name,
                                           const memory::Memory& memory);

/// Before anything comes of it, so that it counts once whatever does.  What the memory cannot take is no
/// word.
[[nodiscard]] Result<robot::Word> use_up(const Confirm& confirm, memory::Memory& memory);

}  // namespace biteline::service
