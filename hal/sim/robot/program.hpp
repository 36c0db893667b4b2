// SPDX-License-Identifier: MIT
#pragma once
/// \file A script laid out in time: where the flange is at every instant of it.

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "hal/sim/robot/script.hpp"
#include "hal/sim/robot/timed_path.hpp"

namespace biteline::sim {

/// What is done beside the moves, and when: to a thread, a watchdog, an output; what is said; what ends it.
struct ProgramEvent {
  double time_s{0};
  ScriptStep step;
};

/// Immutable after plan().
class Program {
 public:
  /// Straight and process moves that blend into each other form one path; a joint move and everything else
  /// stops the arm. A joint move from where the arm's own links do not reach (the head's way round the shoe)
  /// is made straight instead.  It ends where it stops the arm by its own word, and before a goal that is
  /// farther away than all links in a row.
  [[nodiscard]] static Program plan(const Script& script, const ArmKinematics& arm,
                                    const SE3& T_base_flange_start, const SE3& T_flange_tcp,
                                    const Payload& payload = {}, std::uint32_t outputs = 0,
                                    const std::array<double, 2>& analog_ratio = {});

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] double duration_s() const { return pieces_.empty() ? 0 : pieces_.back().end_s; }
  /// The program's time `elapsed_s` after `time_s`, while moves go at `speed_ratio` of their speed.  Waits
  /// take their own time, whatever the speed.
  [[nodiscard]] double later_s(double time_s, double elapsed_s, double speed_ratio) const;
  [[nodiscard]] SE3 T_base_flange_at(double time_s) const;
  /// Within a joint move: the joints.  Elsewhere only the tip is planned, and nothing is known.
  [[nodiscard]] std::optional<JointVector> q_rad_at(double time_s) const;
  /// The tool frame in force.
  [[nodiscard]] SE3 T_flange_tcp_at(double time_s) const;
  [[nodiscard]] const Payload& payload_at(double time_s) const;
  /// Bits of the digital outputs, as DigitalOutStep counts them, as they were before it, and as the script
  /// has set and cleared them since.
  [[nodiscard]] std::uint32_t outputs_at(double time_s) const;

  /// Of the analog outputs, 0 to 1, likewise.
  [[nodiscard]] std::array<double, 2> analog_at(double time_s) const;

  /// The script itself has set the same output after the one time and not after the other.
  [[nodiscard]] bool sets_between(const OutputStep& same, double after_s, double until_s) const;

  /// In their order.
  [[nodiscard]] const std::vector<ProgramEvent>& events() const { return events_; }
  /// nullptr: it has none of that name.
  [[nodiscard]] const ScriptCode* thread(std::string_view name) const;

 private:
  struct Hold {
    SE3 T_base_flange{SE3::Identity()};
  };
  struct JointMove {
    JointVector from_rad, to_rad;
    double speed_rad_s, acceleration_rad_s2;
    [[nodiscard]] JointVector q_rad_at(double inside_s) const;
  };
  struct Piece {
    double begin_s{0};
    double end_s{0};
    SE3 T_flange_tcp{SE3::Identity()};
    Payload payload;
    std::uint32_t outputs{0};
    std::array<double, 2> analog_ratio{};
    std::variant<Hold, TimedPath, JointMove> motion;
  };
  [[nodiscard]] const Piece& piece_at(double time_s) const;
  [[nodiscard]] SE3 flange_of(const Piece& piece, double time_s) const;

  explicit Program(const ArmKinematics& arm) : arm_(arm) {}
  ArmKinematics arm_;
  std::string name_;
  std::vector<Piece> pieces_;
  std::vector<ProgramEvent> events_;
  std::vector<ScriptCode> threads_;
};

}  // namespace biteline::sim
