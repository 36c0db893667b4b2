// SPDX-License-Identifier: MIT
// A cell without pictures: a made shoe, scanned quickly whenever a scan is asked for, and a simulated arm
// whose tool leaves wet glue on it while its output is on.  The next scan sees that.
//
//     biteline-worked-cell FOLDER [presses | turret | turret-stuck | gun GOOD_FOR_S THEN_RATIO |
//                                  GAP_MM GAP_PROGRAMS [moved]]
//
// turret: a changer with two tools, asked for by the outputs 4 and 5, telling by the inputs 2 and 3; the
// first one stands.  turret-stuck: it never comes to the other. gun: after so much of full flow it gives that
// share alone, 0 for an empty one. presses: the shoe's wall is made of springs, and the arm's force sensor
// has the errors of a common one. GAP_MM: a gap of that length that GAP_PROGRAMS programs leave; moved:
// somebody moves the shoe after the first scan.  Tells the controller's ports as a line of JSON, then the
// sensor's address, then each start. FOLDER gets the truth of what lies on the shoe, as each scan sees it.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <numbers>
#include <string_view>

#include "hal/sim/live/work_trace.hpp"
#include "hal/sim/record/surroundings.hpp"
#include "hal/sim/robot/ur_controller.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "tests/support/scan_server.hpp"

namespace biteline {
namespace {

constexpr int k_output = 1;  // of cement.yaml
constexpr double k_width_mm = 6, k_gap_middle_mm = 200, k_moved_mm = 0.6;
constexpr double k_profile_step_mm = 1;
constexpr double k_wall_newton_per_mm = 15;

sim::TurretFacts two_tools(bool stuck) {
  return {.places = {{.ask_output = 4, .there_input = 2}, {.ask_output = 5, .there_input = 3}},
          .stuck = stuck};
}

sim::JointVector parked_rad() {
  return std::numbers::pi / 180 * (sim::JointVector() << 180, -90, 60, 100, 90, 160).finished();
}

class WorkedCell {
 public:
  WorkedCell(const sim::SceneSettings& settings, const sim::WorkingTool& tool, bool moves)
      : placed_{sim::place_shoe(settings)},
        head_{sim::draw_head(settings.head_seed, sim::Holder::Bracket)},
        way_{placed_.shoe.outline(), head_, {.target_z_mm = 0.55 * settings.shoe.upper.top_z_mm}},
        arm_{*sim::ArmKinematics::named("ur10e"), parked_rad()},
        trace_{placed_, tool},
        seen_{placed_.shoe},
        moves_{moves} {}

  Result<void> open(bool presses, std::optional<sim::TurretFacts> turret) {
    sim::UrController::Config config;
    config.model = "UR10E";
    config.turret = std::move(turret);
    if (presses) {
      config.force = sim::common_force_facts(1);
      config.touch = [this](const SE3& T_base_tcp, double) { return wall_newton(T_base_tcp.translation()); };
    }
    BITELINE_ASSIGN(controller_,
                    sim::UrController::open(config, arm_,
                                            [this](SensorClock::time_point, const sim::ArmState& state,
                                                   const sim::ArmReal& real) {
                                              const std::lock_guard lock{mutex_};
                                              trace_.step(state, real.T_base_flange, 0.002);
                                            }));
    return {};
  }
  [[nodiscard]] wire::SensorHello identity() const {
    wire::SensorHello hello;
    hello.name = "worked";
    hello.simulated = true;
    hello.model = head_.model;
    hello.model.camera_state = hello.camera_state = geometry::plain_state();
    for (geometry::CameraState* state : {&hello.model.camera_state, &hello.camera_state}) {
      (*state)[geometry::StateKey::SensorWidth] = head_.sensor_width_px;
      (*state)[geometry::StateKey::SensorHeight] = head_.sensor_height_px;
    }
    return hello;
  }
  void tell() const {
    const auto ports = controller_->ports();
    std::printf(
        "{\"rtde\":%d,\"script\":%d,\"dashboard\":%d,\"fixture_z_mm\":%.3f,\"fixture_beyond_mm\":%.1f}\n",
        int{ports.rtde}, int{ports.primary}, int{ports.dashboard}, placed_.T_base_shoe.translation().z(),
        sim::plate_beyond_line_mm(placed_.shoe.outline(), placed_.line));
    std::fflush(stdout);
  }
  std::vector<profile::Profile> scan(std::uint64_t number, const std::filesystem::path& folder) {
    {
      const std::lock_guard lock{mutex_};
      if (trace_.due()) seen_ = trace_.lay();
    }
    SE3 T_base_shoe = placed_.T_base_shoe;
    if (moves_ && number > 1) T_base_shoe.translation().x() += k_moved_mm;
    static_cast<void>(sim::write_line_truth(
        folder, {.shoe = seen_, .T_base_shoe = placed_.T_base_shoe, .line = placed_.line}));
    const sim::ScannedCloud cloud = sim::scan_quickly(
        seen_,
        {.profile_step_mm = k_profile_step_mm,
         .begin_s_mm = 0.3 * static_cast<double>(number - 1),  // profiles never stand where they stood
         .seed = number,
         .stripe = true},
        T_base_shoe);
    return profiles_of(cloud);
  }

 private:
  /// Of springs behind the line's place that is nearest, along the wall's normal there.
  [[nodiscard]] Vec3 wall_newton(const Vec3& tip_base) const {
    const Vec3 tip_shoe = placed_.T_base_shoe.inverse() * tip_base;
    const auto& near = *std::ranges::min_element(
        placed_.line, {}, [&](const auto& place) { return (place.point_shoe - tip_shoe).squaredNorm(); });
    const double depth_mm = (near.point_shoe - tip_shoe).dot(near.normal_shoe);
    return std::max(0.0, depth_mm) * k_wall_newton_per_mm * (placed_.T_base_shoe.linear() * near.normal_shoe);
  }
  [[nodiscard]] std::vector<profile::Profile> profiles_of(const sim::ScannedCloud& cloud) const {
    std::vector<profile::Profile> profiles;
    // As an arm goes round at 100 mm/s, which has just ended.
    constexpr std::chrono::milliseconds k_apart{10};
    const SensorClock::time_point begin = test::now_of_sensor() - (cloud.profile.back() + 1) * k_apart;
    SE3 T_cam_base = SE3::Identity();
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (i == 0 || cloud.profile[i] != cloud.profile[i - 1]) {
        profile::Profile next;
        next.header.sequence = next.header.frame_sequence = profiles.size();
        next.header.exposure_mid = begin + profiles.size() * k_apart;
        const SE3 T_base_cam = placed_.T_base_shoe * way_.T_shoe_cam_at(way_.settings().lead_mm +
                                                                        k_profile_step_mm * cloud.profile[i]);
        next.header.T_base_flange = T_base_cam * head_.model.T_flange_cam.inverse(Eigen::Isometry);
        T_cam_base = T_base_cam.inverse(Eigen::Isometry);
        profiles.push_back(std::move(next));
      }
      profile::ProfilePoint point;
      point.point_cam = (T_cam_base * cloud.points[i].cast<double>()).cast<float>();
      point.sigma_mm = 0.02F;
      point.amplitude = cloud.amplitude[i];
      point.width_px = cloud.width_px[i];
      point.column = cloud.column[i];
      point.peak_count = 1;
      profiles.back().points.push_back(point);
    }
    return profiles;
  }

  sim::PlacedShoe placed_;
  sim::MadeHead head_;
  sim::ScanPath way_;
  sim::Arm arm_;
  std::mutex mutex_;
  sim::WorkTrace trace_;
  sim::MadeShoe seen_;
  bool moves_;
  std::unique_ptr<sim::UrController> controller_;  // last: its thread uses the rest
};

}  // namespace
}  // namespace biteline

int main(int argc, char** argv) {
  using namespace biteline;
  const bool presses = argc == 3 && std::string_view{argv[2]} == "presses";
  const std::string_view turret{argc == 3 ? argv[2] : ""};
  const bool turns = turret == "turret" || turret == "turret-stuck";
  const bool gun = argc == 5 && std::string_view{argv[2]} == "gun";
  const bool moved = argc == 5 && std::string_view{argv[4]} == "moved";
  if (argc != 2 && !presses && !turns && argc != 4 && !gun && !moved) {
    std::fprintf(stderr,
                 "usage: biteline-worked-cell FOLDER [presses | turret | turret-stuck | gun GOOD_FOR_S "
                 "THEN_RATIO | GAP_MM GAP_PROGRAMS [moved]]\n");
    return 2;
  }
  sim::WorkingTool tool{.work = sim::Work::WetGlue,
                        .film_seed = 1,
                        .digital_output = k_output,
                        .width_mm = k_width_mm,
                        .gun = {.opens_s = 0, .closes_s = 0, .metered = false}};
  if (gun) {
    tool.gun.good_for_s = std::atof(argv[3]);
    tool.gun.then_ratio = std::atof(argv[4]);
  } else if (argc > 3) {
    const double gap_mm = std::atof(argv[2]);
    tool.gap = sim::OutlinePart{.from_s_mm = k_gap_middle_mm - gap_mm / 2, .length_mm = gap_mm};
    tool.gap_programs = std::atoi(argv[3]);
  }
  sim::SceneSettings settings{
      .shoe = sim::draw_shoe(sim::ShoeClass::Shallow, 4101, sim::length_of_size_mm(36)),
      .places = sim::places_within_reach_of("ur10e"),
      .holder = sim::Holder::Bracket};
  const std::filesystem::path folder{argv[1]};
  WorkedCell cell{settings, tool, moved};
  return test::run_scan_server("biteline-worked-cell", [&]() -> Result<test::ScanServer> {
    BITELINE_TRY(
        cell.open(presses, turns ? std::optional{two_tools(turret == "turret-stuck")} : std::nullopt));
    cell.tell();
    return test::ScanServer{.identity = cell.identity(),
                            .make = [&](std::uint64_t number) { return cell.scan(number, folder); },
                            .between_profiles = std::chrono::milliseconds{1}};
  });
}
