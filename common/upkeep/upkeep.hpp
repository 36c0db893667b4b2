// SPDX-License-Identifier: MIT
#pragma once
/// \file upkeep.yaml: what a unit has been through since it was first started.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/core/numbers.hpp"
#include "common/core/result.hpp"

namespace biteline::upkeep {

/// What is written in the folder that a unit keeps its state in.
inline constexpr const char* k_file = "upkeep.yaml";
/// What a head can have; the file takes nothing else.
inline constexpr NumberRange k_degc{.minimum = -100, .maximum = 300};

struct Upkeep {
  std::uint64_t starts{0};     ///< of the sensor program
  std::uint64_t boots{0};      ///< of the machine, as far as the program was started after them
  double run_s{0};             ///< the program ran
  double laser_s{0};           ///< the laser was on
  std::uint64_t lightings{0};  ///< the laser went on
  std::uint64_t frames{0};     ///< the camera's
  std::optional<double> hottest_degc{}, coldest_degc{};  ///< of the head, as its camera says
  std::string boot_id{};  ///< of the boot in which this was written, as the kernel names it; empty: not told
  std::vector<std::string> others{};  ///< lines of a newer program: kept as they are
};

/// Errc::FileNotFound where there is none; strict otherwise, but for single values of a newer program.
[[nodiscard]] Result<Upkeep> read_upkeep(const std::filesystem::path& file);
[[nodiscard]] std::string upkeep_text(const Upkeep& upkeep);

/// One line for a person: "12 starts, 3 boots, 130.5 h run, laser on 14.2 h in 512 times, head 18 to 46
/// degC".
[[nodiscard]] std::string in_words(const Upkeep& upkeep);

}  // namespace biteline::upkeep
