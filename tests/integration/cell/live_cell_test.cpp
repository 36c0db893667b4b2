// SPDX-License-Identifier: MIT
/// \file The simulated cell as the sensor meets it: camera packets, wires, pose bus; the truth beside.
#include "hal/sim/live/live_cell.hpp"

#include <CppUTest/TestHarness.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <fstream>
#include <thread>

#include "hal/linux/aravis/aravis_camera.hpp"
#include "hal/linux/socketcan/can_pose_source.hpp"
#include "hal/sim/bus/bus_devices.hpp"
#include "hal/sim/shoe/surface_distance.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::sim {

namespace {

constexpr Nanoseconds k_second{1'000'000'000};

LiveSettings quick_cell() {
  LiveSettings settings;
  settings.scene = {.shoe = draw_shoe(ShoeClass::Deep, 4),
                    .scan_speed_mm_s = 300,
                    .rate_hz = 25,
                    .fineness = {.column_mm = 1.0, .coarse_row_mm = 0.5}};
  settings.wires = "biteline-live-test-" + std::to_string(getpid());
  settings.scan_after_laser = Nanoseconds{100'000'000};
  return settings;
}

/// The standard fixes the camera's port, so one camera at a time lives on an address; another test may just
/// be using it.
std::unique_ptr<LiveCell> open_cell(const LiveSettings& settings) {
  const auto patience_ends = hal::monotonic_now() + 15 * k_second;
  do {
    if (auto cell = LiveCell::open(settings)) {
      test::note_ran();
      return std::move(*cell);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{100});  // until the other test gives the port back
  } while (hal::monotonic_now() < patience_ends);
  test::note_skipped("GigE Vision port 3956 on 127.0.0.1 is not free");
  return nullptr;
}

hal::Descriptor connect_to(std::uint16_t port) {
  hal::Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  CHECK(connect(socket.number(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  return socket;
}

struct Picture {
  SensorClock::time_point exposure_mid;
  int width_px, height_px;
  std::vector<std::uint8_t> pixels;
};

/// The sensor's devices, opened as biteline-sensor opens them.
struct Devices {
  std::unique_ptr<hal::AravisCamera> camera;
  hal::MonotonicClock clock;
  std::unique_ptr<hal::CanPoseSource> poses;
  std::unique_ptr<hal::PwmOut> trigger;
  std::unique_ptr<hal::GpioOut> laser;
  std::unique_ptr<hal::EdgeIn> scan_active;

  explicit Devices(const LiveCell& cell) {
    const auto& name = cell.settings().wires;
    const auto& model = cell.scene().head.model;
    camera = *hal::AravisCamera::open({.address = "127.0.0.1", .packet_bytes = 16000});
    CHECK(camera
              ->configure({.region = model.region,
                           .exposure = *model.exposure,
                           .rate_hz = *model.rate_hz,
                           .trigger = hal::Trigger::Hardware})
              .has_value());
    poses = std::make_unique<hal::CanPoseSource>(*SimCanBus::open(name), clock, hal::CanPoseSource::Config{});
    trigger = *SimPwmOut::open(name);
    CHECK(trigger
              ->configure({.period = Nanoseconds{static_cast<std::int64_t>(1e9 / *model.rate_hz)},
                           .pulse = *model.exposure})
              .has_value());
    laser = *SimGpioOut::open(name, Line::LaserEnable);
    scan_active = *SimEdgeIn::open(name, Line::ScanActive);
    CHECK(poses->start().has_value());
    CHECK(camera->start().has_value());
    CHECK(trigger->start().has_value());
  }
};

struct Scan {
  std::vector<Picture> pictures;
  std::vector<hal::RobotPose> poses;
  bool complete{false};
};

/// Laser on, until the arm says that it is round.  Poses have a thread of their own, as in the sensor.
Scan take_scan(Devices& devices) {
  Scan scan;
  std::atomic<bool> over{false};
  std::thread pose_thread([&] {
    while (!over) {
      if (const auto pose = devices.poses->next_pose(Nanoseconds{20'000'000})) scan.poses.push_back(*pose);
    }
  });
  CHECK(devices.laser->set(true).has_value());
  bool active = false;
  const auto until = hal::monotonic_now() + 30 * k_second;
  while (!scan.complete && hal::monotonic_now() < until) {
    if (const auto edge = devices.scan_active->next_edge(Nanoseconds{0})) {
      scan.complete = active && !edge->rising;
      active = edge->rising;
    }
    if (const auto frame = devices.camera->next_frame(Nanoseconds{10'000'000})) {
      if (active)
        scan.pictures.push_back({frame->exposure_mid,
                                 frame->width_px,
                                 frame->height_px,
                                 {frame->pixels.begin(), frame->pixels.end()}});
      devices.camera->release(*frame);
    }
  }
  over = true;
  pose_thread.join();
  return scan;
}

std::optional<SE3> pose_at(const Scan& scan, SensorClock::time_point instant) {
  const auto after = std::find_if(scan.poses.begin(), scan.poses.end(),
                                  [&](const auto& pose) { return *pose.stamp_sensor >= instant; });
  if (after == scan.poses.begin() || after == scan.poses.end()) return std::nullopt;
  const auto before = after - 1;
  const double part = static_cast<double>((instant - *before->stamp_sensor).count()) /
                      static_cast<double>((*after->stamp_sensor - *before->stamp_sensor).count());
  return geometry::interpolate(before->T_base_flange, after->T_base_flange, part);
}

/// Distances from the made shoe's wall of every seventh column's centre of gravity.
std::vector<double> distances_mm(const Scan& scan, const MadeScene& scene) {
  const SurfaceDistance distance(scene.shoe);
  const auto& model = scene.head.model;
  std::vector<double> found;
  for (const Picture& picture : scan.pictures) {
    const auto T_base_flange = pose_at(scan, picture.exposure_mid);
    if (!T_base_flange) continue;
    const SE3 T_shoe_cam = scene.T_base_shoe.inverse() * *T_base_flange * model.T_flange_cam;
    for (int column = 0; column < picture.width_px; column += 7) {
      double sum = 0, moment = 0;
      for (int row = 0; row < picture.height_px; ++row) {
        const double value = picture.pixels[static_cast<std::size_t>(row * picture.width_px + column)];
        if (value < 6) continue;
        sum += value;
        moment += value * row;
      }
      if (sum < 300) continue;
      const Vec2 pixel_px(column + model.region.offset_u_px, moment / sum + model.region.offset_v_px);
      const Vec3 point = T_shoe_cam * geometry::triangulate(model.camera, model.laser_plane, pixel_px);
      if (point.z() > 1 && point.z() < scene.settings.shoe.upper.top_z_mm - 2)
        found.push_back(distance.signed_distance_mm(point));
    }
  }
  return found;
}

}  // namespace

TEST_GROUP(LiveCell){};

LONG_GROUP(LiveCell){};

/// As for a recorded session: poses 0.010 mm, plain peaks 0.01 to 0.02 mm, facets; and 0.030 mm of the
/// laser's speckle at f/5.6.  A stamp wrong by 1 ms would add 0.1 mm at the toe.
void lies_on_shoe(const Scan& scan, const LiveCell& cell) {
  const auto distances = distances_mm(scan, cell.scene());
  CHECK(distances.size() > 3000);
  double square_sum = 0;
  for (const double d : distances) square_sum += std::min(0.25, d * d);
  CHECK(std::sqrt(square_sum / static_cast<double>(distances.size())) < std::hypot(0.03, 0.03));
}

TIMED_TEST(LiveCell, AScanThroughAllItsProtocolsLiesOnTheMadeShoe) {
  const auto cell = open_cell(quick_cell());
  if (!cell) return;
  Devices devices(*cell);
  const Scan scan = take_scan(devices);
  CHECK(scan.complete);
  CHECK(scan.pictures.size() > 30);
  lies_on_shoe(scan, *cell);
  LONGS_EQUAL(1, cell->counts().scans);
}

TIMED_TEST(LiveCellLong, AtHalfOfRealTimeTheSamePicturesComeLater) {
  LiveSettings settings = quick_cell();
  settings.scene.rate_hz = 50;
  settings.time_ratio = 0.5;
  const auto cell = open_cell(settings);
  if (!cell) return;
  Devices devices(*cell);
  const Scan scan = take_scan(devices);
  CHECK(scan.complete);
  // Twice or half as many where way and trigger did not slow down together; the ends are told a little late.
  const double expected = cell->scan_duration_s() * settings.scene.rate_hz;
  DOUBLES_EQUAL(expected, static_cast<double>(scan.pictures.size()), 0.1 * expected);
  lies_on_shoe(scan, *cell);
}

TIMED_TEST(LiveCell, AnArmThatStaysWaitsWhereItsScanEndsAndScansAgainFromThere) {
  LiveSettings settings = quick_cell();
  settings.arm = "ur10e";
  settings.stay_at_end = true;
  settings.scene.shoe = draw_shoe(ShoeClass::Deep, 5, length_of_size_mm(42));
  settings.scene.places = places_within_reach_of("ur10e");
  settings.scene.holder = Holder::Bracket;
  settings.scene.scan_begin_ratio = 0.25;
  settings.scene.scan_clockwise = true;
  const auto cell = open_cell(settings);
  if (!cell) return;
  Devices devices(*cell);
  const ArmScan& scan = *cell->arm_scan();
  const JointVector end_rad = scan.q_rad_at(scan.duration_s());
  CHECK(take_scan(devices).complete);
  CHECK(devices.laser->set(false).has_value());
  std::this_thread::sleep_for(std::chrono::milliseconds{800});  // it comes to rest within 0.4 s
  const ArmState waits = cell->arm_at(hal::monotonic_now());
  CHECK(!waits.moving);
  DOUBLES_EQUAL(0, (*waits.q_rad - end_rad).cwiseAbs().maxCoeff(), 1e-6);
  CHECK(take_scan(devices).complete);
  LONGS_EQUAL(2, cell->counts().scans);
}

TIMED_TEST(LiveCell, WithoutLaserThereIsNoLightAndNoScan) {
  const auto cell = open_cell(quick_cell());
  if (!cell) return;
  Devices devices(*cell);
  for (int i = 0; i < 10; ++i) {
    const auto frame = devices.camera->next_frame(k_second);
    CHECK(frame.has_value());
    CHECK(*std::max_element(frame->pixels.begin(), frame->pixels.end()) < 10);
    devices.camera->release(*frame);
  }
  LONGS_EQUAL(0, cell->counts().exposures_lit);
  LONGS_EQUAL(0, cell->counts().scans);
}

TIMED_TEST(LiveCell, AnOpenDoorDarkensTheLaserWhateverTheSensorDrives) {
  const auto cell = open_cell(quick_cell());
  if (!cell) return;
  Devices devices(*cell);
  const auto door = *SimGpioOut::open(cell->settings().wires, Line::Interlock);  // open
  CHECK(devices.laser->set(true).has_value());
  for (int i = 0; i < 5; ++i) devices.camera->release(*devices.camera->next_frame(k_second));
  LONGS_EQUAL(0, cell->counts().exposures_lit);
}

TEST(LiveCell, LaserIsDarkOnceTheMonostableHasRunOutWhateverItsLineDoes) {
  constexpr Nanoseconds k_monostable = std::chrono::milliseconds{60};
  LiveSettings settings = quick_cell();
  settings.monostable = k_monostable;
  const auto cell = open_cell(settings);
  if (!cell) return;
  const auto laser = *SimGpioOut::open(cell->settings().wires, Line::LaserEnable);
  const auto heart = *SimGpioOut::open(cell->settings().wires, Line::Heartbeat);
  SUCCEEDS(laser->set(true));
  CHECK_FALSE(cell->enabled(hal::monotonic_now()));  // never fed
  const SensorClock::time_point before = hal::monotonic_now();
  SUCCEEDS(heart->set(true));
  const SensorClock::time_point after = hal::monotonic_now();
  SUCCEEDS(heart->set(false));  // rising edges feed it
  CHECK(cell->enabled(before + k_monostable - Nanoseconds{1}));
  CHECK_FALSE(cell->enabled(after + k_monostable));
  CHECK(cell->disabled_since() >= before + k_monostable);
  CHECK(cell->disabled_since() <= after + k_monostable);
  SUCCEEDS(laser->set(false));
  CHECK_FALSE(cell->enabled(before));
}

// The arm goes where no ray tracer's numbers reach, and pictures are drawn there.
TEST(LiveCellLong, GoalsBeyondAllBoundsEndNothing) {
  const auto cell = open_cell(quick_cell());
  if (!cell) return;
  Devices devices(*cell);
  CHECK(devices.laser->set(true).has_value());
  int pictures = 0;
  for (const char* script :
       {"def far():\n  set_tcp(p[1e308,0,0,0,0,0])\n  movel(p[1e9,0,0,0,0,0], a=1e9, v=1e9)\nend\n",
        "def far():\n  set_tcp(p[0,0,0.1,0,0,0])\n  movel(p[1e9,0,0,0,0,0], a=1e12, v=1e12)\nend\n",
        "def far():\n  movep(p[1e30,1e30,0,0,0,0], a=1e300, v=1e300, r=0.001)\nend\n",
        "def far():\n  movej([1e9,0,0,0,0,0], a=1e9, v=1e9)\nend\n",
        "def far():\n  movel(p[9000,9000,9000,0,0,0], a=9000, v=9000)\nend\n",
        "def far():\n  movel(p[nan,inf,0,0,0,0], a=1, v=1)\nend\n"}) {
    const hal::Descriptor socket = connect_to(cell->robot_ports().script);
    CHECK(send(socket.number(), script, std::strlen(script), 0) > 0);
    const auto until = hal::monotonic_now() + k_second;
    while (hal::monotonic_now() < until) {
      if (const auto seen = devices.camera->next_frame(Nanoseconds{50'000'000})) {
        devices.camera->release(*seen);
        ++pictures;
      }
      CHECK(cell->arm_at(hal::monotonic_now()).T_base_flange.translation().allFinite());
    }
  }
  CHECK(pictures > 0);
}

TIMED_TEST(LiveCell, TheTrackOfARunScriptIsWritten) {
  const auto cell = open_cell(quick_cell());
  if (!cell) return;
  Devices devices(*cell);
  const auto before = *devices.poses->next_pose(k_second);
  const hal::Descriptor socket = connect_to(cell->robot_ports().script);
  const Vec3 p = before.T_base_flange.translation() / 1000,
             r = geometry::log_so3(before.T_base_flange.linear());
  char script[200];
  const int size =
      std::snprintf(script, sizeof script, "movel(p[%.7f,%.7f,%.7f,%.8f,%.8f,%.8f], a=2, v=0.2)\n", p.x(),
                    p.y(), p.z() + 0.03, r.x(), r.y(), r.z());
  LONGS_EQUAL(size, send(socket.number(), script, static_cast<std::size_t>(size), 0));
  double height_mm = 0;
  const auto until = hal::monotonic_now() + 20 * k_second;
  while (std::abs(height_mm - 30) > 0.1 && hal::monotonic_now() < until) {
    height_mm = devices.poses->next_pose(k_second)->T_base_flange.translation().z() -
                before.T_base_flange.translation().z();
  }
  DOUBLES_EQUAL(30, height_mm, 0.1);
  const auto file =
      std::filesystem::temp_directory_path() / ("biteline-track-" + std::to_string(getpid()) + ".csv");
  CHECK(cell->write_track(file).has_value());
  std::ifstream in(file);
  std::string row, last;
  int rows = 0;
  while (std::getline(in, row)) {
    last = row;
    ++rows;
  }
  std::filesystem::remove(file);
  CHECK(rows > 20);
  CHECK(last.ends_with(",1,0,0,1"));
}

}  // namespace biteline::sim
