// SPDX-License-Identifier: MIT
#pragma once
/// \file The one state machine of a cell that scans on demand: which job, which start, what came of it.
///
/// asked -> in work -> done, or given up.  A page's start goes through begin(), too.

#include <optional>
#include <string>
#include <vector>

#include "host/interfaces/line_control/jobs.hpp"
#include "host/interfaces/line_control/line_state.hpp"

namespace biteline::line_control {

/// What a scan came to, as the memory keeps it.
struct Ended {
  std::string scan;     ///< scan-0007
  std::string verdict;  ///< ok, amber, review, refused; all else is failed
  std::string model;
  std::string foot{}, size{}, part{};
  bool sent{false}, followed{false};
  std::optional<double> length_mm{}, u95_mm{}, confidence{};
};

/// How the cell stands when a command comes.
struct Standing {
  bool control_held{false};  ///< by somebody at a page
  bool deciding{false};      ///< a scan waits for a person
  bool stopped{false};       ///< by a person
  bool sensor{true};         ///< is heard
};

/// Thread: one at a time; the owner locks.
class Cycle {
 public:
  /// Without a job the line's control has no say, and scans are asked for without end.
  explicit Cycle(std::vector<Job> jobs) : jobs_{std::move(jobs)} {}

  [[nodiscard]] bool on_demand() const { return !jobs_.empty(); }
  [[nodiscard]] const std::vector<Job>& jobs() const { return jobs_; }
  [[nodiscard]] const Job* find(int number) const;
  [[nodiscard]] bool busy() const { return phase_ != Phase::Idle; }

  [[nodiscard]] Refusal choose(int number, const Standing& standing);

  /// The part number of the scan that is started next, and of no other; empty: it has none.
  [[nodiscard]] Refusal choose_part(const std::string& part, const Standing& standing);
  /// A stop ends what was said before it.
  void forget_part();

  struct Start {
    Refusal refusal{Refusal::None};
    std::optional<Job> go{};  ///< nothing with Refusal::None: this request was taken before
    std::string part{};       ///< of the shoe that is scanned
  };
  /// `request`: 1 to 65535, another one for each start.  A start that goes is begun.
  [[nodiscard]] Start start(int request, const Standing& standing);

  /// A start of a page, or one of above (`request` is 0 for a page's).  The part number of its scan: the one
  /// that it brings, else the one that was chosen before.
  std::string begin(int request, const std::string& part = {});
  /// The shoe that was scanned last is scanned again; what was chosen for the next one stays.
  void begin_again();
  /// A scan comes in, asked for or not.
  void scan_begins();
  void scan_ends(const Ended& ended);
  /// What was asked for does not come: nothing is left in work before the scan began.
  void give_up();

  /// `working`: the step while a scan is in work.
  [[nodiscard]] LineState state(const Standing& standing, Step working, bool fault) const;

 private:
  enum class Phase { Idle, Asked, InWork };
  void finish(Verdict verdict);
  void ask_scan(int request);

  std::vector<Job> jobs_;
  Phase phase_{Phase::Idle};
  int request_{0};  ///< of what is in work; 0: a page's, or nobody's
  std::string next_part_{};
  std::string part_in_work_{};  ///< or of the last scan, when none is
  LineState state_{};
};

}  // namespace biteline::line_control
