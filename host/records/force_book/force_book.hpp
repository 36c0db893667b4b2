// SPDX-License-Identifier: MIT
#pragma once
/// \file What a cell's shoes taught of the force, in the memory: for each model, foot and process.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/records/memory/memory.hpp"
#include "host/robot/path/force_told.hpp"

namespace biteline::force_book {

/// Whose force it is.  With another text of the process or another tip all is learned anew.
struct Subject {
  std::string model, foot;  ///< foot: left, right, or empty: not known
  std::string process;
  std::string process_sha256;
  std::string tip;  ///< taught, in the flange; empty: none was taught
  bool operator==(const Subject&) const = default;

  [[nodiscard]] bool same_place(const Subject& other) const {
    return model == other.model && foot == other.foot && process == other.process;
  }
};
/// `Subject::tip` of a taught one, mm.
[[nodiscard]] std::string tip_text(const std::optional<Vec3>& tip_flange);

/// One worked shoe, as path::ForceTold has it.
struct ShoeForce {
  std::string scan;
  double within{0}, mean_newton{0}, largest_newton{0}, along_mm{0};
  std::string tool{};      ///< that its process names; empty: none, or of an older program
  memory::UnixMs time{0};  ///< 0: of an older program
};
inline constexpr std::size_t k_shoes_kept = 200;

struct Entry {
  Subject of;
  path::ForceLearned learned{};
  std::vector<ShoeForce> shoes{};  ///< oldest first, the newest k_shoes_kept
};
/// "learned from N shoes and M runs in the air; the sensor drifts ...".
[[nodiscard]] std::string words_of(const path::ForceLearned& learned);

/// Whatever was learned of this place, also with another process text or tip.  Errc::BadFormat: it was not
/// written by this program.
[[nodiscard]] Result<std::optional<Entry>> read(const memory::Memory& memory, const Subject& of);
/// What counts for the next path; nothing: it is learned anew.
[[nodiscard]] Result<std::optional<path::ForceLearned>> learned(const memory::Memory& memory,
                                                                const Subject& of);
/// All places, in the order they came.
[[nodiscard]] Result<std::vector<Entry>> read_all(const memory::Memory& memory);

/// Here and below change and log line are one transaction; the answer is the entry as it is now.
[[nodiscard]] Result<Entry> learn_shoe(memory::Memory& memory, const Subject& of, double set_newton,
                                       const std::string& scan, const path::ForceTold& told,
                                       const std::string& tool = {});
/// What the sensor told beside the shoe.
[[nodiscard]] Result<Entry> learn_air(memory::Memory& memory, const Subject& of, double set_newton,
                                      const std::string& scan, std::span<const path::ForceSample> samples);
/// Of a model, for all feet and processes: after a change of tool.  The answer: how many.
[[nodiscard]] Result<int> forget(memory::Memory& memory, const std::string& model, const std::string& who);

[[nodiscard]] nlohmann::ordered_json to_json(const Entry& entry);

}  // namespace biteline::force_book
