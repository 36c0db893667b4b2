// SPDX-License-Identifier: MIT
#pragma once
/// \file What the service knows of the work on a shoe: `work/work.json` in its scan's folder.
///
/// It is there for a process that is looked at, and for each of several processes for one shoe.
/// It is there from before the path is sent until the folder goes.  One that still says "looking" when a
/// service starts is of a shoe that was worked and never looked at: it is not worked again by itself.

#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "host/records/memory/memory.hpp"
#include "host/report/refusal.hpp"
#include "host/second_look/second_look.hpp"

namespace biteline::service {

inline constexpr const char* k_work_folder = "work";
/// memory::Work::verdict until the last look is worked out.
inline constexpr const char* k_looking = "looking";
inline constexpr const char* k_work_ok = "ok";
inline constexpr const char* k_faulty = "faulty";
inline constexpr const char* k_not_looked = "not_looked";

struct WorkBook {
  memory::Work work{};
  int looks{0};                ///< that were worked out
  report::ToldRefusal told{};  ///< why a person must look; empty: nobody need to
  bool at_work{false};         ///< the arm was sent out, and has not come to its end yet
  std::string next{};          ///< the process that the shoe is to be worked with then, or "once more"
  std::string next_scan{};     ///< its result; empty: not yet begun
};

/// Verdict and figures of what a look found.  `judged`: as look::write_look_result() says.
[[nodiscard]] memory::Work work_of(const second_look::Findings& findings, ExitStatus judged);

/// Of a scan's looks, from 1.
[[nodiscard]] std::filesystem::path look_folder(const std::filesystem::path& scan, int number);

[[nodiscard]] Result<void> write_work(const std::filesystem::path& scan, const WorkBook& book);
/// Nothing where there is none.
[[nodiscard]] Result<std::optional<WorkBook>> read_work(const std::filesystem::path& scan);
/// The path was not sent, or not followed to its end: no look is owed.
void forget_work(const std::filesystem::path& scan);

}  // namespace biteline::service
