// SPDX-License-Identifier: MIT
#include "hal/sim/live/live_cell.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "common/canpose/pose_frames.hpp"
#include "hal/sim/live/slow_motion.hpp"
#include "hal/sim/live/urgency.hpp"
#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

/// The arm speeds up and slows down over this time before and after the scan.
constexpr double k_ramp_s = 0.5;
/// From wherever it is to the scan's begin, before the ramp.
constexpr double k_approach_s = 2;
/// From the scan's end to where the arm waits for scripts.
constexpr double k_park_s = 1.5;
/// There: upright, the flange over the middle of the table and looking down at it.
constexpr double k_degree = std::numbers::pi / 180;
const JointVector k_park_rad = k_degree * (JointVector() << 180, -90, 60, 100, 90, 160).finished();
/// A pose's frame follows its SYNC by about its own length on a 1 Mbit/s bus with a 4 Mbit/s data phase.
constexpr Nanoseconds k_frame_time{250'000};

double seconds(Nanoseconds time) {
  return static_cast<double>(time.count()) * 1e-9;
}
Nanoseconds nanoseconds(double time_s) {
  return Nanoseconds{std::llround(time_s * 1e9)};
}

/// Way along the scan: an even ramp up, the scan from 0 to `length_mm` at full speed, an even ramp down.
struct ScanWay {
  double length_mm, speed_mm_s;

  [[nodiscard]] double ramp_mm() const { return 0.5 * speed_mm_s * k_ramp_s; }
  [[nodiscard]] double duration_s() const { return 2 * k_ramp_s + length_mm / speed_mm_s; }
  [[nodiscard]] double at_mm(double time_s) const {
    if (time_s < k_ramp_s) return -ramp_mm() + 0.5 * speed_mm_s / k_ramp_s * time_s * time_s;
    const double left_s = duration_s() - time_s;
    if (left_s < k_ramp_s) return length_mm + ramp_mm() - 0.5 * speed_mm_s / k_ramp_s * left_s * left_s;
    return speed_mm_s * (time_s - k_ramp_s);
  }
};

GvCamera::Config camera_config(const LiveSettings& settings, const MadeHead& head) {
  GvCamera::Config camera;
  camera.address = settings.camera_address;
  camera.sensor_width_px = head.sensor_width_px;
  camera.sensor_height_px = head.sensor_height_px;
  camera.region = head.model.region;
  camera.exposure = *head.model.exposure;
  camera.rate_hz = settings.scene.rate_hz;
  camera.ptp = settings.camera_ptp;
  camera.lost_packet_ratio = settings.lost_packet_ratio;
  if (!settings.camera_ptp)
    camera.clock_offset = Nanoseconds{-42'000'000'000};  // as if counting from its own power-up
  return camera;
}

/// Smooth from 0 to 1.
double eased(double part) {
  return part * part * (3 - 2 * part);
}

}  // namespace

LiveCell::LiveCell(const LiveSettings& settings, std::unique_ptr<MadeScene> scene,
                   const ArmKinematics& kinematics, ReachableScan reachable)
    : settings_(settings),
      scene_(std::move(scene)),
      arm_scan_(std::move(reachable.scan)),
      moved_because_(std::move(reachable.moved_because)),
      arm_(arm_scan_
               ? Arm(kinematics, arm_scan_->q_rad_at(0), settings.disturbances.arm)
               : Arm(kinematics,
                     T_base_flange_on_path(
                         -ScanWay{scene_->path.length_mm(), scene_->path.settings().speed_mm_s}.ramp_mm()))),
      renderer_(scene_->scene, scene_->head),
      targets_(settings.targets ? std::make_unique<TargetShow>(scene_->head, *settings.targets) : nullptr),
      pose_noise_(Random(settings.scene.shoe.seed).fork(77)),
      trace_(settings.tool ? std::make_unique<WorkTrace>(*scene_, *settings.tool) : nullptr) {}

LiveCell::~LiveCell() {
  // They call into each other: the wires hear nobody any more, then the callers end, then what they called.
  if (bus_) bus_->close();
  trigger_.reset();
  robot_.reset();
  if (tracing_.valid()) tracing_.wait();
  camera_.reset();
  bus_.reset();
}

Result<std::unique_ptr<LiveCell>> LiveCell::open(const LiveSettings& settings) {
  const auto nominal = ArmKinematics::named(settings.arm);
  if (!nominal)
    return fail(Errc::InvalidArgument, "arm '%s': ur3e, ur5e or ur10e expected", settings.arm.c_str());
  const ArmKinematics kinematics = nominal->made(settings.arm_seed);
  BITELINE_ASSIGN(auto scene, make_scene(settings.scene));
  // As its camera powers up; a calibration would tell the same.
  geometry::CameraState& camera_state = scene->head.model.camera_state;
  camera_state = geometry::plain_state();
  camera_state[geometry::StateKey::SensorWidth] = scene->head.sensor_width_px;
  camera_state[geometry::StateKey::SensorHeight] = scene->head.sensor_height_px;
  ReachableScan reachable;
  if (settings.scene.holder == Holder::Bracket && !settings.targets) {
    BITELINE_ASSIGN(reachable, place_within_reach(*scene, kinematics, settings.arm));
  }
  std::unique_ptr<LiveCell> cell(new LiveCell(settings, std::move(scene), kinematics, std::move(reachable)));
  LiveCell* self = cell.get();

  {
    const Urgently urgently{k_trigger_priority};
    cell->trigger_ = std::make_unique<TriggerTimer>(
        [self](SensorClock::time_point edge, Nanoseconds pulse) { self->on_edge(edge, pulse); });
  }
  BusServer::Callbacks callbacks;
  callbacks.on_line = [self](Line line, bool active, SensorClock::time_point stamp) {
    self->on_line(line, active, stamp);
  };
  callbacks.on_trigger = [self](Nanoseconds period, Nanoseconds pulse) {
    if (!self->ready_) return;
    self->period_asked_ = period;
    self->pulse_asked_ = pulse;
    self->trigger_->configure(nanoseconds(seconds(period) / self->time_ratio()), pulse);
  };
  {
    const Urgently urgently{k_wires_priority};
    BITELINE_ASSIGN(cell->bus_, BusServer::open(settings.wires, std::move(callbacks)));
  }
  std::optional<Urgently> urgently{k_camera_priority};
  cell->time_share_ =
      std::make_unique<TimeShare>(settings.time_ratio ? *settings.time_ratio : cell->measured_time_ratio(),
                                  nanoseconds(1 / settings.scene.rate_hz));
  BITELINE_ASSIGN(cell->camera_,
                  GvCamera::open(camera_config(settings, cell->scene_->head),
                                 [self](const GvExposure& exposure, std::span<std::uint8_t> pixels) {
                                   self->paint(exposure, pixels);
                                 }));
  urgently.reset();
  cell->bus_->drive(Line::Interlock, true, hal::monotonic_now());
  cell->bus_->drive(Line::Key, true, hal::monotonic_now());
  urgently.emplace(k_robot_priority);
  BITELINE_ASSIGN(cell->robot_,
                  UrController::open(settings.robot, cell->arm_,
                                     [self](SensorClock::time_point instant, const ArmState& state,
                                            const ArmReal& real) { self->on_cycle(instant, state, real); }));
  cell->ready_ = true;
  return cell;
}

/// By pictures all the way round the shoe, as the camera's thread will make them.
double LiveCell::measured_time_ratio() {
  if (targets_) return 1;  // the arm stands
  constexpr int k_pictures = 12;
  const MadeHead& head = scene_->head;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(head.model.region.width_px) *
                                   static_cast<std::size_t>(head.model.region.height_px));
  const Nanoseconds picture_takes = mean_turn(k_pictures, [&](int picture) {
    const double way_mm = scene_->path.length_mm() * picture / k_pictures;
    renderer_.render({.T_scene_cam = scene_->path.T_shoe_cam_at(way_mm), .region = head.model.region}, pixels,
                     nullptr);
  });
  return affordable_ratio(picture_takes, nanoseconds(1 / settings_.scene.rate_hz));
}

void LiveCell::slow_down_where_late() {
  if (settings_.time_ratio || !time_share_->settle()) return;
  trigger_->configure(nanoseconds(seconds(period_asked_) / time_ratio()), pulse_asked_);
  if (settings_.on_slower) settings_.on_slower(time_ratio());
}

double LiveCell::scan_duration_s() const {
  return arm_scan_ ? arm_scan_->full_until_s() - arm_scan_->full_from_s() : scene_->path.duration_s();
}

SE3 LiveCell::T_base_flange_on_path(double way_mm) const {
  return scene_->T_base_shoe * scene_->path.T_shoe_cam_at(way_mm) *
         scene_->head.model.T_flange_cam.inverse(Eigen::Isometry);
}

bool LiveCell::enabled(SensorClock::time_point now) const {
  const bool fed = settings_.monostable == Nanoseconds{0} ||
                   now.time_since_epoch() - Nanoseconds{heartbeat_ns_} < settings_.monostable;
  return fed && bus_->level(Line::LaserEnable);
}

SensorClock::time_point LiveCell::disabled_since() const {
  const SensorClock::time_point runs_out{Nanoseconds{heartbeat_ns_} + settings_.monostable};
  if (settings_.monostable == Nanoseconds{0}) return dark_since();
  return bus_->level(Line::LaserEnable) ? runs_out : std::min(runs_out, dark_since());
}

bool LiveCell::laser_shines() const {
  return enabled(hal::monotonic_now()) && bus_->level(Line::Interlock) && bus_->level(Line::Key);
}

void LiveCell::on_edge(SensorClock::time_point edge, Nanoseconds pulse) {
  constexpr Nanoseconds k_second_pulse{800'000};
  if (due(faults.edges_to_lose)) return;
  fire(edge, pulse);
  if (due(faults.edges_to_double)) fire(edge + k_second_pulse, Nanoseconds{0});
}

void LiveCell::fire(SensorClock::time_point edge, Nanoseconds pulse) {
  // The echo first: the camera's packets must not overtake it on a busy machine.
  if (!due(faults.echoes_to_lose)) {
    bus_->drive(Line::StrobeEcho, true, edge);
    bus_->drive(Line::StrobeEcho, false, edge + pulse);
  }
  if (!faults.camera_silent) camera_->trigger(edge);
}

void LiveCell::paint(const GvExposure& exposure, std::span<std::uint8_t> pixels) {
  const auto T_shoe_cam_at = [&](SensorClock::time_point instant) -> SE3 {
    return scene_->T_base_shoe.inverse(Eigen::Isometry) * arm_.real_at(instant).T_base_flange *
           scene_->head.model.T_flange_cam;
  };
  const bool lit = laser_shines() && exposure.strobe;
  if (lit) time_share_->late_by(hal::monotonic_now() - exposure.begin);
  if (lit) ++lit_;
  if (targets_) {
    targets_->paint(target_, exposure, lit, pixels);
    return;
  }
  Shot shot{.T_scene_cam = T_shoe_cam_at(exposure.begin + exposure.exposure / 2),
            .region = exposure.region,
            .exposure_ratio = std::pow(10, exposure.gain_db / 20) * seconds(exposure.exposure) /
                              seconds(*scene_->head.model.exposure),
            .laser_on = lit,
            .noise_seed = settings_.scene.shoe.seed * 1'000'003 + exposure.sequence};
  disturb(shot, settings_.disturbances, T_shoe_cam_at(exposure.begin),
          T_shoe_cam_at(exposure.begin + exposure.exposure), seconds(exposure.begin.time_since_epoch()));
  const std::lock_guard lock{scene_mutex_};
  renderer_.render(shot, pixels, nullptr);
}

void LiveCell::on_line(Line line, bool active, SensorClock::time_point stamp) {
  if (line == Line::Heartbeat && active) heartbeat_ns_ = stamp.time_since_epoch().count();
  if (line != Line::LaserEnable) return;
  if (active) ++lightings_;
  (active ? lit_since_ns_ : dark_since_ns_) = stamp.time_since_epoch().count();
  if (targets_) return;
  if (active && ready_) slow_down_where_late();
  scan_at_ns_ = active ? (stamp + settings_.scan_after_laser).time_since_epoch().count() : 0;
  if (!active) scan_full_until_ns_ = 0;  // a scan without light is over, wherever the arm still goes
}

void LiveCell::show_target(std::size_t place) {
  constexpr double k_move_s = 0.4;
  const SensorClock::time_point now = hal::monotonic_now();
  const SE3 T_from = arm_.at(now).T_base_flange, T_to = targets_->place(place).T_base_flange;
  arm_.run({.name = "to the target",
            .duration_s = k_move_s,
            .T_base_flange_at =
                [=](double time_s) { return geometry::interpolate(T_from, T_to, eased(time_s / k_move_s)); }},
           now);
  target_ = place;
}

LiveCell::ScanMotion LiveCell::scan_motion(const ArmState& state) const {
  if (!arm_scan_) return flange_scan(state.T_base_flange);
  // A program may have left the arm where nobody knows its joints: its begin is the best guess.
  return joint_scan(state.q_rad.value_or(arm_scan_->q_rad_at(0)));
}

LiveCell::ScanMotion LiveCell::joint_scan(const JointVector& q_from_rad) const {
  struct Leg {
    JointEase ease;
    double begin_s;
  };
  const JointLimits& limits = arm_.kinematics().limits();
  double time_s = 0;
  const auto add = [&](std::vector<Leg>& legs, const JointVector& from_rad, const JointVector& to_rad) {
    legs.push_back({JointEase(from_rad, to_rad, limits), time_s});
    time_s += legs.back().ease.duration_s();
  };
  std::vector<Leg> there, back;
  const JointVector begin_rad = arm_scan_->q_rad_at(0);
  constexpr double k_there_rad = 1e-6;
  const auto stands_at = [&](const JointVector& q_rad) {
    return (q_from_rad - q_rad).cwiseAbs().maxCoeff() <= k_there_rad;
  };
  const JointVector end_rad = arm_scan_->q_rad_at(arm_scan_->duration_s());
  if (!stands_at(begin_rad)) {
    // Beside the shoe: up first.
    const bool at_end = stands_at(end_rad);
    if (at_end) add(there, q_from_rad, arm_scan_->above_end_rad());
    add(there, at_end ? arm_scan_->above_end_rad() : q_from_rad, k_park_rad);
    add(there, k_park_rad, arm_scan_->above_begin_rad());
    add(there, arm_scan_->above_begin_rad(), begin_rad);
  }
  const double scan_s = time_s;
  time_s += arm_scan_->duration_s();
  const double back_s = time_s;
  if (!settings_.stay_at_end) {
    add(back, end_rad, arm_scan_->above_end_rad());
    add(back, arm_scan_->above_end_rad(), k_park_rad);
  }
  const auto on_legs = [](const std::vector<Leg>& legs, double at_s) {
    const auto after = std::upper_bound(legs.begin() + 1, legs.end(), at_s,
                                        [](double t, const Leg& leg) { return t < leg.begin_s; });
    const Leg& leg = *(after - 1);
    return leg.ease.q_rad_at(at_s - leg.begin_s);
  };
  return {.motion = {.name = "scan",
                     .duration_s = time_s,
                     .q_rad_at =
                         [=, scan = arm_scan_](double at_s) {
                           if (at_s < scan_s) return on_legs(there, at_s);
                           if (at_s >= back_s && !back.empty()) return on_legs(back, at_s);
                           return scan->q_rad_at(at_s - scan_s);
                         },
                     .q_end_rad = back.empty() ? end_rad : k_park_rad},
          .full_from_s = scan_s + arm_scan_->full_from_s(),
          .full_until_s = scan_s + arm_scan_->full_until_s()};
}

LiveCell::ScanMotion LiveCell::flange_scan(const SE3& T_base_flange_from) const {
  const ScanWay way{scene_->path.length_mm(), scene_->path.settings().speed_mm_s};
  const SE3 T_begin = T_base_flange_on_path(way.at_mm(0));
  const bool there = (T_base_flange_from.inverse(Eigen::Isometry) * T_begin).isApprox(SE3::Identity(), 1e-9);
  const double approach_s = there ? 0 : k_approach_s;
  const double scanned_s = approach_s + way.duration_s();
  const SE3 T_end = T_base_flange_on_path(way.at_mm(way.duration_s()));
  const SE3 T_park = arm_.kinematics().T_base_flange(k_park_rad);
  return {.motion = {.name = "scan",
                     .duration_s = scanned_s + k_park_s,
                     .T_base_flange_at =
                         [=, this](double time_s) {
                           if (time_s < approach_s)
                             return geometry::interpolate(T_base_flange_from, T_begin,
                                                          eased(time_s / approach_s));
                           if (time_s > scanned_s)
                             return geometry::interpolate(T_end, T_park,
                                                          eased((time_s - scanned_s) / k_park_s));
                           return T_base_flange_on_path(way.at_mm(time_s - approach_s));
                         },
                     .q_end_rad = k_park_rad},
          .full_from_s = scanned_s - k_ramp_s - scene_->path.duration_s(),
          .full_until_s = scanned_s - k_ramp_s};
}

void LiveCell::leave_trace(SensorClock::time_point instant, const ArmState& state, const ArmReal& real) {
  if (!trace_ || trace_due_) return;
  const Nanoseconds since = instant - std::exchange(trace_at_, instant);
  constexpr Nanoseconds k_longest{100'000'000};  // after a time in which nothing was looked at
  trace_->step(state, real.T_base_flange, seconds(std::clamp(since, Nanoseconds{0}, k_longest)));
  if (!trace_->due()) return;
  trace_due_ = true;
  tracing_ = std::async(std::launch::async, [this] { work_shoe(); });
}

void LiveCell::work_shoe() {
  be_patient();
  MadeShoe worked = trace_->lay();
  Result<Scene> scene = Scene::build(meshes_of(worked, settings_.scene).all);
  const std::lock_guard lock{scene_mutex_};
  // Without memory for it the shoe stays as it was.
  if (scene) {
    scene_->scene = std::move(*scene);
    worked_.emplace(std::move(worked));
  }
  trace_due_ = false;
}

Result<void> LiveCell::write_work(const std::filesystem::path& folder) {
  const std::lock_guard lock{scene_mutex_};
  if (!worked_) return {};
  return write_line_truth(folder,
                          {.shoe = *worked_, .T_base_shoe = scene_->T_base_shoe, .line = scene_->line});
}

void LiveCell::on_cycle(SensorClock::time_point instant, const ArmState& state, const ArmReal& real) {
  const std::int64_t now_ns = instant.time_since_epoch().count();
  std::int64_t asked_ns = scan_at_ns_;
  leave_trace(instant, state, real);
  if (asked_ns != 0 && now_ns >= asked_ns && !trace_due_ &&
      scan_at_ns_.compare_exchange_strong(asked_ns, 0)) {
    ScanMotion scan = scan_motion(state);
    const auto at_ns = [&](double scan_s) {
      return (instant + nanoseconds(scan_s / time_ratio())).time_since_epoch().count();
    };
    scan_full_until_ns_ = at_ns(scan.full_until_s);
    scan_full_from_ns_ = at_ns(scan.full_from_s);
    arm_.run(slowed(std::move(scan.motion), time_ratio()), instant);
    ++scans_;
  }
  const bool scans = now_ns >= scan_full_from_ns_ && now_ns < scan_full_until_ns_;
  bus_->drive(Line::ScanActive, scans, instant);
  send_pose(instant, state, real.T_base_flange_told);
  if (!state.moving || !settings_.keep_track) return;
  track_.add({.stamp = instant.time_since_epoch() + settings_.robot.clock_offset,
              .T_base_tcp = real.T_base_flange_told * state.T_flange_tcp,
              .program = state.program_running,
              .outputs = state.outputs,
              .scans = scans,
              .time_ratio = state.program_running ? 1 : time_ratio()});
}

void LiveCell::send_pose(SensorClock::time_point instant, const ArmState& state,
                         const SE3& T_base_flange_told) {
  sync_counter_ =
      sync_counter_ >= canpose::k_sync_counter_last ? 1 : static_cast<std::uint8_t>(sync_counter_ + 1);
  Twist noise;
  for (int k = 0; k < 3; ++k) {
    noise[k] = settings_.pose_noise_mm * pose_noise_.gaussian();
    noise[k + 3] = settings_.pose_noise_rad * pose_noise_.gaussian();
  }
  const SE3 T_base_flange = T_base_flange_told * geometry::exp_se3(noise);
  if (settings_.on_pose) settings_.on_pose(instant, T_base_flange);
  if (faults.bus_off) return;
  const Nanoseconds stamp =
      instant.time_since_epoch() + settings_.robot.clock_offset + Nanoseconds{faults.robot_clock_step_ns};
  const auto frame = canpose::encode_fd(
      {.sync_counter = sync_counter_,
       .status = static_cast<std::uint8_t>(canpose::k_simulated |
                                           (state.program_running ? canpose::k_program_running : 0)),
       .stamp_us = static_cast<std::uint64_t>(stamp.count() / 1000),
       .T_base_flange = T_base_flange});
  if (!frame) return;  // beyond the format's reach of 214 m
  const Nanoseconds ahead = due(faults.poses_from_future) ? std::chrono::hours{1} : Nanoseconds{0};
  hal::CanFrame sync{.id = canpose::k_sync_id, .size_bytes = 1, .received = instant + ahead};
  sync.data[0] = sync_counter_;
  if (!faults.sync_stopped) bus_->send(sync);
  if (faults.poses_silent) return;
  hal::CanFrame pose{.id = canpose::k_default_base_id + canpose::k_fd_id_offset,
                     .fd = true,
                     .bit_rate_switch = true,
                     .size_bytes = canpose::k_fd_size_bytes,
                     .received = instant + k_frame_time};
  std::copy(frame->begin(), frame->end(), pose.data.begin());
  bus_->send(pose);
}

LiveCounts LiveCell::counts() const {
  return {.exposures = camera_->exposures(),
          .exposures_lit = lit_,
          .triggers = trigger_->edges(),
          .triggers_missed = camera_->triggers_missed(),
          .scans = scans_,
          .scripts_run = robot_->scripts_run(),
          .scripts_refused = robot_->scripts_refused(),
          .bus_messages_dropped = bus_->messages_dropped()};
}

}  // namespace biteline::sim
