// SPDX-License-Identifier: MIT
#pragma once
/// \file The one gate before an arm: everything that must hold at the moment a path is sent.

#include <optional>
#include <string>
#include <vector>

#include "host/robot/link/gate/refused.hpp"
#include "host/robot/link/gate/stops.hpp"
#include "host/robot/path/checks/checked_path.hpp"

namespace biteline::robot {

/// A person's word for one scan.
struct Word {
  std::string by;  ///< the user's name on this machine
  std::string at;  ///< date and time, UTC
};

/// Lost in a row, at the worst place of the scan.
struct LostInARow {
  std::uint64_t frames{0};
  std::uint64_t profiles{0};
  std::uint64_t edges{0};  ///< exposures that the time between two profiles has room for
};

/// What shows that the shoe still stands as it was scanned.
struct Unmoved {
  enum class By {
    Look,   ///< the sensor has looked again
    Clamp,  ///< the clamp that holds it says that it has not let go
  };
  By by{By::Look};
  double age_s{0};  ///< of a look: since its end; of the clamp: for how long it has held without a break
  double shift_mm{0}, u95_mm{0};  ///< of a look
  double limit_mm{0};             ///< of the two together
  bool same_shoe{true};           ///< of a look
};

/// Of a look: the same shoe, its shift together with U95 within the limit.
[[nodiscard]] bool stands_as_scanned(const Unmoved& look);

struct ScanFacts {
  std::string name;  ///< of its folder
  std::uint64_t scan_id{0};
  bool recovered{false};       ///< of a process that ended: nobody saw it come in
  bool from_recording{false};  ///< the sensor plays a session
  bool one_connection{false};  ///< to the sensor, from its first profile to its end
  std::optional<double>
      age_s{};  ///< since its end, by this host's monotonic clock; not known of a recovered one
  std::uint64_t messages_lost{0};
  LostInARow lost;
  bool sent_before{false};
  /// By the camera's state, or by places that were seen twice; nothing: of a file that does not say.
  std::optional<bool> pictures_vouched{};
  std::optional<bool> stopped{};  ///< since the scan was ordered; nothing: of a gate that did not look
  std::optional<Word> confirmed{};
  std::optional<Unmoved> unmoved{};
};

struct ResultFacts {
  bool line_passed{false};
  bool path_passed{false};
  double way_clearance_mm{0};      ///< of the way to the path's beginning
  std::optional<double> u95_mm{};  ///< the largest along the processed path
  std::optional<double>
      tip_bound_mm{};              ///< of the tip off the line, likewise; nothing: as U95, or an older file
  std::optional<bool> approved{};  ///< the verdict on this result; nothing: nobody has said a word
  std::optional<std::string> approved_by{};  ///< whose verdict, when; or "automatic" with its figures
  double tool_off_mm{0}, tool_off_rad{0};    ///< the path's tool from the process's
  std::optional<bool> same_payload{};        ///< of path and process; nothing: the process tells none
  /// The tool that the process names, and the one that is mounted as a person said; nothing: the process
  /// names none, and nobody has said.
  std::optional<std::string> tool{}, mounted_tool{};
  std::optional<std::string> changer_trouble{};  ///< why a changer has not brought it
  /// Nothing, here and below: it was not taught.
  std::optional<double> tip_from_taught_mm{};
  std::optional<bool> payload_as_taught{};
  std::optional<bool> output_as_taught{};        ///< that switches the tool
  std::optional<double> table_from_taught_mm{};  ///< of the height that the path was planned with
};

/// How far an arm's pose, as its controller tells it, may be from that of its joints by the kinematics that
/// paths are planned with: the controller tells its tip by rows of its own.
inline constexpr double k_pose_off_mm = 0.2, k_pose_off_rad = 0.002;

/// As the controller and this host say.  What an old controller cannot say is not known.
struct ArmFacts {
  std::string arm;                      ///< configured: UR5e, ...
  std::optional<std::string> serial{};  ///< configured
  std::optional<std::string> told_version{}, told_model{}, told_serial{};
  std::optional<bool> told_remote{};
  /// Of an arm by the generic protocol, which knows neither remote control nor our models: its pose as it
  /// tells it, from that of its joints.  Nothing: a Universal Robots' arm.
  std::optional<double> pose_off_mm{}, pose_off_rad{};
  kinematics::Joints q_checked_rad{kinematics::Joints::Zero()};  ///< where its way was checked from
  kinematics::Joints q_now_rad{kinematics::Joints::Zero()};
  bool held{false};  ///< this service holds the arm's lock
  /// The arm and its controller were looked at; false: the scan itself was refused before.  Nothing: of a
  /// file that does not say.
  std::optional<bool> asked{};
};

/// A file's SHA-256 as the service wrote or read it, and now; nothing: it is not compared.
struct FileFacts {
  std::optional<std::string> written{}, now{};
};
/// What was looked at is what is sent.
struct FilesFacts {
  FileFacts line, cloud, report, process;
};

struct GateInputs {
  path::GateLimits limits;
  ScanFacts scan;
  ResultFacts result;
  ArmFacts arm;
  FilesFacts files{};
};

struct GateRow {
  /// NotKnown does not stop the path; Failed does, and so does NotLookedAt.
  enum class State { Passed, Failed, NotKnown, NotLookedAt };
  Refused code;
  std::string name;
  std::string value;
  std::string limit;
  State state{State::Failed};
};

/// Its row is about the arm as it stands when the path is sent.
[[nodiscard]] bool needs_the_arm(Refused code);
/// The whole table, from the inputs alone: the same inputs give the same rows at any time.
[[nodiscard]] std::vector<GateRow> judge(const GateInputs& inputs);
[[nodiscard]] bool passed(const std::vector<GateRow>& rows);
/// The failed rows as one sentence.
[[nodiscard]] std::string failures(const std::vector<GateRow>& rows);

/// A path that the gate let through, to the arm as it stands now.  What sends paths takes this type and no
/// other; only open_gate() makes one.
class PermittedPath {
 public:
  [[nodiscard]] const path::CheckedPath& path() const { return path_; }
  /// The arm must not have moved since the check, right up to the sending.
  [[nodiscard]] bool holds_for(const kinematics::Joints& q_rad) const;
  /// Of the order that it follows from: nobody must have said stop since, right up to the sending, nor while
  /// the arm follows.
  [[nodiscard]] const StopMark& mark() const { return mark_; }

 private:
  friend struct Gatekeeper;
  PermittedPath(path::CheckedPath path, const GateInputs& inputs, const StopMark& mark)
      : path_{std::move(path)},
        mark_{mark},
        from_rad_{inputs.arm.q_checked_rad},
        start_rad_{inputs.limits.start_rad} {}
  path::CheckedPath path_;
  StopMark mark_;
  kinematics::Joints from_rad_;
  double start_rad_;
};

struct GateOutcome {
  std::vector<GateRow> rows;
  std::optional<PermittedPath> path;  ///< present when no row failed
};

/// What of the arm is known to be wrong before anything is scanned: model, pose, serial number, remote
/// control. One sentence with what to do; empty: nothing is known to be wrong.
[[nodiscard]] std::string why_not_ready(const ArmFacts& arm);

/// `path`: entered by the checked way from where the arm stands; `mark`: of the order that it follows from.
[[nodiscard]] GateOutcome open_gate(const GateInputs& inputs, const path::CheckedPath& path,
                                    const StopMark& mark);

}  // namespace biteline::robot
