// SPDX-License-Identifier: MIT
#pragma once
/// \file The whole cell in running time: camera, wires, pose bus and robot around one made shoe.

#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/sim/bus/bus_server.hpp"
#include "hal/sim/gvcamera/gv_camera.hpp"
#include "hal/sim/live/arm_scan.hpp"
#include "hal/sim/live/cell_faults.hpp"
#include "hal/sim/live/cell_track.hpp"
#include "hal/sim/live/reachable_scan.hpp"
#include "hal/sim/live/slow_motion.hpp"
#include "hal/sim/live/target_show.hpp"
#include "hal/sim/live/trigger_timer.hpp"
#include "hal/sim/live/work_trace.hpp"
#include "hal/sim/record/disturbances.hpp"
#include "hal/sim/record/made_scene.hpp"
#include "hal/sim/record/surroundings.hpp"
#include "hal/sim/robot/ur_controller.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

struct LiveSettings {
  SceneSettings scene{};
  std::string wires{"biteline-cell"};  ///< name of the simulated wires
  std::string camera_address{"127.0.0.1"};
  UrController::Config robot{};
  std::string arm{"ur5e"};
  std::uint64_t arm_seed{0};    ///< of the arm's own kinematics (ArmKinematics::made); 0: nominal
  Disturbances disturbances{};  ///< none, where nothing is said
  double lost_packet_ratio{0};
  bool camera_ptp{true};
  double pose_noise_mm{0.010};                ///< of each pose on the bus
  double pose_noise_rad{5.2e-5};              ///< 0.003 degrees
  Nanoseconds scan_after_laser{300'000'000};  ///< the arm sets out so long after the laser went on
  /// Ring targets stand before the head in place of the shoe; the arm goes by show_target() only.
  std::optional<TargetShowSettings> targets{};
  /// Scans go at this share of real time; nothing: at as much as this machine can, measured at the start, and
  /// less after a scan whose pictures came late.
  std::optional<double> time_ratio{1.0};
  std::function<void(double time_ratio)> on_slower{};  ///< on the wires' thread
  /// Before the laser, fed by the heartbeat line; 0: none.  The boards have 60 ms.  A machine that holds the
  /// sensor's safety thread up for longer darkens a scan.
  Nanoseconds monostable{0};
  /// The arm waits where the scan ends, on a bracket; else upright above the table.
  bool stay_at_end{false};
  /// Told each pose beside the bus, with its noise, on the controller's thread: for another maker's language.
  std::function<void(SensorClock::time_point, const SE3& T_base_flange)> on_pose{};
  /// What the arm's tool leaves on the shoe; nothing: it leaves no trace.
  std::optional<WorkingTool> tool{};
  bool keep_track{true};  ///< for write_track(); memory grows with the arm's way
};

/// What happened, for the last line and for tests.
struct LiveCounts {
  std::uint64_t exposures{0}, exposures_lit{0}, triggers{0}, triggers_missed{0};
  std::uint64_t scans{0}, scripts_run{0}, scripts_refused{0}, bus_messages_dropped{0};
};

/// The laser shines while LaserEnable, Interlock and Key are active and the monostable, if there is one, has
/// not run out.  When LaserEnable goes on, the arm takes the head
/// once round the shoe; ScanActive is high while the stripe is on the scan's path.  After that it waits for
/// scripts: upright above the table, or where the scan ends.
///
/// A head on a bracket goes as the arm's joints can take it (ArmScan); places where they cannot are passed
/// over for others.  A straight holder's goes as if the arm had no links: no upright arm takes it all the way
/// round.
///
/// With a tool that leaves a trace (LiveSettings::tool) the shoe changes once the program has ended that
/// worked it, and the next scan sees it so; it sets out when the shoe is ready.
///
/// Threads: the camera's (renders), the robot's (cycle, pose bus), the wires', the trigger's, real-time ones
/// where this process may (urgency.hpp).  Public methods: any.
class LiveCell {
 public:
  [[nodiscard]] static Result<std::unique_ptr<LiveCell>> open(const LiveSettings& settings);
  ~LiveCell();
  LiveCell(const LiveCell&) = delete;
  LiveCell& operator=(const LiveCell&) = delete;

  [[nodiscard]] const MadeScene& scene() const { return *scene_; }
  [[nodiscard]] const LiveSettings& settings() const { return settings_; }
  [[nodiscard]] UrController::Ports robot_ports() const { return robot_->ports(); }
  [[nodiscard]] LiveCounts counts() const;
  /// Of real time, for scans (slow_motion.hpp).
  [[nodiscard]] double time_ratio() const { return time_share_->ratio(); }
  /// The scan from its begin to its end, without the ways there and back, in the arm's own time.
  [[nodiscard]] double scan_duration_s() const;
  /// The arm's own way; nothing with a straight holder.
  [[nodiscard]] const ArmScan* arm_scan() const { return arm_scan_.get(); }
  /// The arm stands on the table, and the shoe on a fixture: in the base.
  struct Stand {
    double table_z_mm{0}, fixture_z_mm{0}, fixture_beyond_mm{k_plate_beyond_mm};
  };
  [[nodiscard]] Stand stand() const {
    return {.fixture_z_mm = scene_->T_base_shoe.translation().z(),
            .fixture_beyond_mm = plate_beyond_line_mm(scene_->shoe.outline(), scene_->line)};
  }
  /// What stood in the way at the place asked for; empty: the shoe stands there.
  [[nodiscard]] const std::string& moved_because() const { return moved_because_; }

  /// What the head sees where LiveSettings::targets are asked for; else nothing.
  [[nodiscard]] const TargetShow* targets() const { return targets_.get(); }
  /// The arm takes the head to that place of targets(), and rests there.
  void show_target(std::size_t place);

  CellFaults faults;
  /// The door, the key switch and the head's thermal contact, as a person or the room moves them.
  void drive(Line line, bool active) { bus_->drive(line, active, hal::monotonic_now()); }
  [[nodiscard]] bool level(Line line) const { return bus_->level(line); }
  /// When the laser's line last rose and last fell.
  [[nodiscard]] SensorClock::time_point lit_since() const {
    return SensorClock::time_point{Nanoseconds{lit_since_ns_}};
  }
  [[nodiscard]] SensorClock::time_point dark_since() const {
    return SensorClock::time_point{Nanoseconds{dark_since_ns_}};
  }
  /// Whether the laser may shine at `now`: its enable line is active, and the monostable has not run out.
  [[nodiscard]] bool enabled(SensorClock::time_point now) const;
  /// When that ended the last time.  Pre: enabled() was false after it.
  [[nodiscard]] SensorClock::time_point disabled_since() const;
  /// How often the laser's line rose.
  [[nodiscard]] std::uint64_t lightings() const { return lightings_; }
  UrController& robot() { return *robot_; }
  [[nodiscard]] ArmState arm_at(SensorClock::time_point instant) const { return arm_.at(instant); }
  [[nodiscard]] ArmReal arm_really_at(SensorClock::time_point instant) const { return arm_.real_at(instant); }

  /// The tool's way as the controller knows it, one row for each cycle while the arm moved.
  [[nodiscard]] Result<void> write_track(const std::filesystem::path& file) const {
    return track_.write(file);
  }
  /// The truth of what its tool has left so far, as write_line_truth(); nothing where it leaves no trace.
  [[nodiscard]] Result<void> write_work(const std::filesystem::path& folder);

 private:
  LiveCell(const LiveSettings& settings, std::unique_ptr<MadeScene> scene, const ArmKinematics& kinematics,
           ReachableScan reachable);
  void on_edge(SensorClock::time_point edge, Nanoseconds pulse);
  void fire(SensorClock::time_point edge, Nanoseconds pulse);
  void paint(const GvExposure& exposure, std::span<std::uint8_t> pixels);
  void on_line(Line line, bool active, SensorClock::time_point stamp);
  void on_cycle(SensorClock::time_point instant, const ArmState& state, const ArmReal& real);
  /// The controller's thread: what the tool does, and the shoe anew once its program has ended.
  void leave_trace(SensorClock::time_point instant, const ArmState& state, const ArmReal& real);
  void work_shoe();
  void send_pose(SensorClock::time_point instant, const ArmState& state, const SE3& T_base_flange_told);
  [[nodiscard]] double measured_time_ratio();
  void slow_down_where_late();
  [[nodiscard]] bool laser_shines() const;
  [[nodiscard]] SE3 T_base_flange_on_path(double way_mm) const;
  struct ScanMotion {
    FlangeMotion motion;
    double full_from_s, full_until_s;  ///< ScanActive
  };
  [[nodiscard]] ScanMotion scan_motion(const ArmState& state) const;
  [[nodiscard]] ScanMotion flange_scan(const SE3& T_base_flange_from) const;
  [[nodiscard]] ScanMotion joint_scan(const JointVector& q_from_rad) const;

  LiveSettings settings_;
  std::unique_ptr<MadeScene> scene_;
  std::unique_ptr<TimeShare> time_share_;
  std::shared_ptr<const ArmScan> arm_scan_;
  std::string moved_because_;
  Arm arm_;
  StripeRenderer renderer_;
  std::unique_ptr<TargetShow> targets_;
  std::atomic<std::size_t> target_{0};
  std::atomic<std::int64_t> scan_at_ns_{0};  ///< when the arm is to set out; 0: not asked
  std::atomic<std::int64_t> scan_full_from_ns_{0}, scan_full_until_ns_{0};
  std::atomic<std::uint64_t> lit_{0}, scans_{0}, lightings_{0};
  std::atomic<std::int64_t> lit_since_ns_{0}, dark_since_ns_{0};
  std::atomic<std::int64_t> heartbeat_ns_{0};  ///< last rising edge
  std::uint8_t sync_counter_{0};               ///< controller's thread
  Random pose_noise_;                          ///< controller's thread
  CellTrack track_;
  std::unique_ptr<WorkTrace> trace_;              ///< none: the tool leaves none
  std::optional<MadeShoe> worked_;                ///< the shoe with it
  std::mutex scene_mutex_;                        ///< of the scene's surface, between pictures
  std::atomic<bool> trace_due_{false};            ///< the shoe is made anew; no scan sets out before
  std::future<void> tracing_;                     ///< controller's thread
  SensorClock::time_point trace_at_{};            ///< controller's thread
  Nanoseconds period_asked_{0}, pulse_asked_{0};  ///< wires' thread
  std::atomic<bool> ready_{false};                ///< every part exists
  std::unique_ptr<BusServer> bus_;
  std::unique_ptr<GvCamera> camera_;
  std::unique_ptr<UrController> robot_;
  std::unique_ptr<TriggerTimer> trigger_;
};

}  // namespace biteline::sim
