// SPDX-License-Identifier: MIT
#pragma once
/// \file One teaching of a model: what was done, and which steps follow of it.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace biteline::memory {

/// A line with a process: what somebody looks at, and what the arm runs.
struct TaughtWork {
  std::string scan;            ///< empty: none
  int line_version{0};         ///< as of its row: 0 as found, above 0 mended
  std::string process_sha256;  ///< of the process that its path was planned with; empty: none
  bool operator==(const TaughtWork&) const = default;
};

/// Facts alone; nothing here says that a step is done.
struct Teaching {
  std::int64_t id{0};     ///< 0: not in the memory yet
  std::int64_t begun{0};  ///< milliseconds since 1970, as all times here
  std::string begun_by;
  TaughtWork work{};                      ///< as it is now
  std::vector<std::string> scans_before;  ///< oldest first: each was scanned again
  std::string verdict;                    ///< of the scan
  bool has_path{false};                   ///< one that passed its checks, with its dry run
  std::string process;                    ///< its name
  std::string process_by;                 ///< who chose it; empty: it is the model's own or the service's

  /// Somebody did something with a line and a process.
  struct Deed {
    TaughtWork work;
    std::string who;
    std::int64_t time{0};
    std::string outcome{};  ///< of a run: begun, refused, stopped or followed
    std::string mark{};     ///< of a run that has begun: what of an earlier one still stood there
    bool operator==(const Deed&) const = default;
  };
  std::optional<Deed> dry_run{};   ///< it was looked at
  std::optional<Deed> air{};       ///< the last run in the air that was ordered
  std::optional<Deed> followed{};  ///< the last one that the arm ran to its end
  std::string model;               ///< saved under this name

  std::optional<std::int64_t> ended{};
  std::string ended_by;
  std::string ended_how;  ///< saved, given_up or replaced
  bool operator==(const Teaching&) const = default;
};

/// In the order in which they are done.
enum class TeachStep { Scan, Line, Process, DryRun, Air, Model };
inline constexpr std::array k_teach_steps{"scan", "line", "process", "dry_run", "air", "model"};

struct StepState {
  enum class Is { Done, Now, Open };
  Is is{Is::Open};
  std::string_view why{};  ///< a word for programs; empty: it is done
};
using TeachSteps = std::array<StepState, k_teach_steps.size()>;

/// What is done, what is next and why: of these facts alone.  A step whose line or process is another one by
/// now is open again.
[[nodiscard]] TeachSteps steps_of(const Teaching& teaching);
/// The one that is next; nothing: it has ended.
[[nodiscard]] std::optional<TeachStep> step_of(const Teaching& teaching);
/// Why `now` is not what was done; empty: it is.
[[nodiscard]] std::string_view other_than(const TaughtWork& done, const TaughtWork& now);

}  // namespace biteline::memory
