// SPDX-License-Identifier: MIT
// The wizard outside the virtual machine: `biteline capture camera|laser|hand-eye` with the sensor program in
// it, on real kernel interfaces and made pictures, then `biteline calibrate`: from a head of which nothing is
// known to one whose points lie where the truth puts them.
//
// What the kernel does not have: its video driver has no exposure control, so the pictures are made with the
// exposures that the wizard asks for.  The laser's line lights nothing: the lit picture is shown when the
// wizard orders it, and the guest's half (tests/hal/kernel/stills_test.cpp) compares orders and line.
#include <CppUTest/TestHarness.h>

#include <cstdio>
#include <fstream>

#include "common/config/sensor_yaml.hpp"
#include "common/session/session.hpp"
#include "hal/sim/live/target_show.hpp"
#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/head_points.hpp"
#include "tests/support/said.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/transforms.hpp"
#include "tests/vm/emulated_machine.hpp"

namespace biteline {
namespace {

namespace fs = std::filesystem;
using intake::ChildProcess;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// One of the driver's standard timings: the published head's camera with two by two pixels as one, less a
/// few at the edge.  Whole ones are as good, and take twice the time.
constexpr int k_width_px = 800, k_height_px = 600;
constexpr double k_pixel_ratio = 0.5;
/// What the wizard asks for unless told otherwise.
constexpr Nanoseconds k_lamp_exposure = milliseconds{20}, k_laser_exposure = std::chrono::microseconds{400};
/// One picture in software emulation, beside whatever else this machine does.
constexpr seconds k_picture_patience{60};
/// What the pose bus rounds to: 0.1 um, and quaternions in 32 bits.
constexpr double k_pose_step_mm = 1e-4, k_pose_step_rad = 1e-8;

sim::MadeHead made_head() {
  sim::MadeHead head = sim::draw_head(33, sim::Holder::Bracket);
  geometry::Camera& camera = head.model.camera;
  camera.fu_px *= k_pixel_ratio;
  camera.fv_px *= k_pixel_ratio;
  camera.cu_px = (camera.cu_px + 0.5) * k_pixel_ratio - 0.5;
  camera.cv_px = (camera.cv_px + 0.5) * k_pixel_ratio - 0.5;
  head.sensor_width_px = k_width_px;
  head.sensor_height_px = k_height_px;
  return head;
}

}  // namespace

TEST_GROUP(CommissionFromOutside) {
  test::TemporaryFolder folder;
  fs::path share{folder.path() / "share"}, calib{share / "calib"}, tool{folder.path() / "bin" / "biteline"};
  sim::MadeHead head{made_head()};
  sim::TargetShowSettings places{.camera_places = 8, .laser_places = 5, .hand_eye_places = 9};
  sim::TargetShow targets{head, places};
  test::EmulatedMachine machine;
  std::string said;

  [[nodiscard]] static fs::path file_of(const fs::path& in, std::size_t place, const char* kind) {
    char name[40];
    std::snprintf(name, sizeof name, "%02zu_%s.png", place, kind);
    return in / name;
  }
  /// The same bits as a live camera of the simulated cell would show.
  void make_picture(std::size_t place, bool lit) {
    image::GreyImage picture{.width_px = k_width_px, .height_px = k_height_px, .pixels = {}};
    picture.pixels.resize(static_cast<std::size_t>(k_width_px) * k_height_px);
    sim::GvExposure exposure;
    exposure.region = {.width_px = k_width_px, .height_px = k_height_px};
    exposure.exposure = lit ? k_laser_exposure : k_lamp_exposure;
    targets.paint(place, exposure, lit, picture.pixels);
    SUCCEEDS(image::write_png(file_of(share, place, lit ? "laser" : "lamp"), picture));
  }
  [[nodiscard]] bool is_for_laser(std::size_t place) const {
    const auto first = static_cast<std::size_t>(places.camera_places);
    return place >= first && place < first + static_cast<std::size_t>(places.laser_places);
  }
  void make_pictures(std::size_t from, std::size_t until) {
    for (std::size_t place = from; place < until; ++place) {
      make_picture(place, false);
      if (is_for_laser(place)) make_picture(place, true);
    }
  }
  void write_places() const {
    std::vector<session::StampedPose> poses;
    for (std::size_t place = 0; place < targets.count(); ++place) {
      poses.push_back({.stamp = RobotClock::time_point{Nanoseconds{static_cast<std::int64_t>(place)}},
                       .T_base_flange = targets.place(place).T_base_flange});
    }
    SUCCEEDS(session::write_pose_table(share / "places.csv", poses));
  }
  /// -1: it is over.
  void go_to(int place) const {
    std::ofstream{share / "place.part"} << place << "\n";
    fs::rename(share / "place.part", share / "place");
  }

  void boot() {
    const std::string in = share.string();
    machine.boot({.modules = "9pnet_virtio 9p",
                  .devices = "-virtfs local,path=" + in + ",mount_tag=share,security_model=none",
                  .guest = "mkdir -p " + in +
                           " && mount -t 9p -o trans=virtio,version=9p2000.L,msize=262144 share " + in +
                           " && BITELINE_BOARD=/test/board.yaml BITELINE_SHARE=" + in +
                           " BITELINE_SENSOR=/test/biteline-sensor /test/kernel_stills_test -v",
                  .program = "tests/kernel_stills_test"});
  }

  /// The tool as it is, and beside it, where it looks for the sensor program, a wire to the one in the
  /// machine.
  void make_tool() const {
    fs::create_directories(tool.parent_path());
    fs::copy_file(BITELINE_TOOL, tool);
    const fs::path wire = tool.parent_path() / "biteline-sensor";
    std::ofstream{wire} << "#!/bin/bash\nexec 3<>/dev/tcp/127.0.0.1/" << machine.port()
                        << " 4<&0\ncat <&4 >&3 &\nexec cat <&3\n";
    fs::permissions(wire, fs::perms::owner_all);
  }

  /// The wizard, and the arm goes to the next place when a picture was taken.  What each kept picture shows.
  std::vector<std::size_t> capture(const std::string& part, const char* target, std::size_t first,
                                   int count) {
    go_to(static_cast<int>(first));
    auto wizard = ChildProcess::start({.program = tool,
                                       .arguments = {"capture", part, calib.string(), "--auto", "--target",
                                                     (folder.path() / target).string(), "--pictures",
                                                     std::to_string(count), "--rt", "ignore"},
                                       .pass_stderr = true});
    SUCCEEDS(wizard);
    std::vector<std::size_t> kept;
    std::size_t place = first;
    for (;;) {
      const auto line = wizard->next_line(k_picture_patience);
      if (!line) break;
      std::printf("%s\n", line->c_str());
      said += *line + "\n";
      if (line->starts_with("kept")) kept.push_back(place);
      const bool taken = line->starts_with("kept") || line->starts_with("not kept");
      if (taken && place + 1 < targets.count()) go_to(static_cast<int>(++place));
    }
    const auto status = wizard->wait(k_picture_patience);
    SUCCEEDS(status);
    if (*status != 0) machine.tell_the_rest(seconds{1});
    LONGS_EQUAL_TEXT(0, *status, wizard->last_words().c_str());
    LONGS_EQUAL(count, kept.size());
    return kept;
  }
  /// Through driver, sensor program and wizard: not one bit is another.
  void check_pictures(const std::vector<std::size_t>& kept, const char* part, const char* ending,
                      const char* kind) const {
    for (std::size_t number = 0; number < kept.size(); ++number) {
      char name[40];
      std::snprintf(name, sizeof name, "%02zu%s", number, ending);
      const auto taken = image::read_png(calib / part / name),
                 made = image::read_png(file_of(share, kept[number], kind));
      SUCCEEDS(taken);
      SUCCEEDS(made);
      CHECK_TRUE_TEXT(taken->pixels == made->pixels, name);
    }
  }
};

TEST(CommissionFromOutside, AnUncalibratedHeadIsCalibratedThroughKernelDevices) {
  if (test::nothing_to_boot()) return;
  fs::create_directories(calib);
  folder.write("target.yaml", sim::grid_text(sim::RingGrid{}));
  folder.write("two.yaml", "planes: 2\n" + sim::grid_text(sim::plane_grid()));
  write_places();
  go_to(0);
  make_pictures(0, 1);
  make_tool();
  boot();
  make_pictures(1, targets.count());  // while it boots
  std::printf("pictures made\n");
  const bool up = machine.says("stills: ready");
  if (!up && machine.cannot_run_here()) return;
  test::note_ran();
  CHECK_TEXT(up, "the machine does not come up");

  const auto first_laser = static_cast<std::size_t>(places.camera_places),
             first_hand_eye = first_laser + static_cast<std::size_t>(places.laser_places);
  const auto camera = capture("camera", "target.yaml", 0, places.camera_places),
             laser = capture("laser", "two.yaml", first_laser, places.laser_places),
             hand_eye = capture("hand-eye", "target.yaml", first_hand_eye, places.hand_eye_places);
  STRCMP_CONTAINS("no exposure control", said.c_str());
  go_to(-1);
  machine.tell_the_rest(k_picture_patience);
  machine.ends_well(k_picture_patience);

  check_pictures(camera, "camera", ".png", "lamp");
  check_pictures(laser, "laser", "_rings.png", "lamp");
  check_pictures(laser, "laser", "_laser.png", "laser");
  check_pictures(hand_eye, "handeye", ".png", "lamp");
  const auto poses = session::read_pose_table(calib / "handeye/poses.csv");
  SUCCEEDS(poses);
  LONGS_EQUAL(hand_eye.size(), poses->size());
  for (std::size_t i = 0; i < poses->size(); ++i) {
    TRANSFORMS_EQUAL(targets.place(hand_eye[i]).T_base_flange, (*poses)[i].T_base_flange, 2 * k_pose_step_mm,
                     2 * k_pose_step_rad);
  }

  const fs::path out = folder.path() / "result";
  const test::Said calibrated =
      test::said_by(BITELINE_TOOL, {"calibrate", calib.string(), "--out", out.string()}, seconds{180});
  LONGS_EQUAL_TEXT(0, calibrated.status, calibrated.last_error.c_str());
  CHECK(calibrated.out.find("calibration: bad") == std::string::npos);
  const auto found = config::read_sensor_yaml(out / "sensor.yaml");
  SUCCEEDS(found);
  const double farthest_mm = test::farthest_mm(head.model, *found, k_pixel_ratio);
  std::printf("%sthe head's points are within %.3f mm of the truth\n", calibrated.out.c_str(), farthest_mm);
  // As good as the accuracy of a line, over the working region.
  CHECK_COMPARE(farthest_mm, <, 0.1);
}

}  // namespace biteline
