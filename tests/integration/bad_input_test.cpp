// SPDX-License-Identifier: MIT
// Every kind of bad input ends the tool with exit status 2 and one line that names file and place.
#include <CppUTest/TestHarness.h>
#include <sys/stat.h>

#include <algorithm>

#include "common/config/sensor_yaml.hpp"
#include "common/image/grey_image.hpp"
#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

TEST_GROUP(BadInput) {
  test::TemporaryFolder folder;

  /// A session of two dark frames that is good until a test spoils it.
  void setup() override {
    geometry::SensorModel sensor;
    sensor.camera = {.fu_px = 1000, .fv_px = 1000, .cu_px = 16, .cv_px = 8};
    sensor.laser_plane = {.normal_cam = Vec3(0, 0.7, -0.7).normalized(), .distance_mm = -100};
    sensor.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 32, .height_px = 24};
    folder.write("cam0/sensor.yaml", config::sensor_yaml_text(sensor, "made"));
    folder.write("cam0/data.csv", "#timestamp [ns],filename\n10000000,a.png\n20000000,b.png\n");
    std::string poses = "#timestamp [ns],p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z []\n";
    for (int i = 0; i <= 20; ++i) poses += std::to_string(2'000'000 * i) + ",1,2,3,1,0,0,0\n";
    folder.write("pose0/data.csv", poses);
    for (const char* name : {"a.png", "b.png"}) {
      fs::create_directories(folder.path() / "cam0/data");
      picture(name, 32, 24);
    }
  }

  void picture(const char* name, int width_px, int height_px) const {
    SUCCEEDS(image::write_png(
        folder.path() / "cam0/data" / name,
        {.width_px = width_px,
         .height_px = height_px,
         .pixels = std::vector<std::uint8_t>(static_cast<std::size_t>(width_px * height_px))}));
  }

  void replace(const char* file, const std::string& from, const std::string& to) const {
    std::ifstream in(folder.path() / file);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto at = text.find(from);
    CHECK(at != std::string::npos);
    folder.write(file, text.replace(at, from.size(), to));
  }

  void ends_with(int expected_status, const std::vector<std::string>& arguments,
                 const std::string& expected_words) const {
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = arguments});
    SUCCEEDS(child);
    const auto status = child->wait(60s);
    SUCCEEDS(status);
    STRCMP_CONTAINS(expected_words.c_str(), child->last_words().c_str());
    LONGS_EQUAL(expected_status, *status);
    LONGS_EQUAL(1, child->stderr_lines());
    CHECK(!fs::exists(folder.path() / "out/line.csv"));
  }

  void replay_ends_with(int status, const std::string& words) const {
    ends_with(status, {"replay", folder.path().string(), "--out", (folder.path() / "out").string()}, words);
  }
  void extract_ends_with(int status, const std::string& text, const std::string& words) const {
    const fs::path file = folder.write("cloud.ply", text);
    ends_with(status, {"extract", file.string(), "--out", (folder.path() / "out").string()}, words);
  }
};

TEST(BadInput, UnspoiledSessionIsReadableButRefused) {
  // The base of all other cases: without the spoiling there is no exit 2.  Dark frames hold no shoe.
  replay_ends_with(3, "refused");
}

TEST(BadInput, MistypedCommandIsToldWithTheOneItMayBeMeantFor) {
  ends_with(2, {"replya", "--out", "x"}, "no command 'replya'; did you mean replay?");
  ends_with(2, {"polish"}, "no command 'polish'; there are doctor, demo");
}

TEST(BadInput, MissingSession) {
  ends_with(2, {"replay", (folder.path() / "none").string(), "--out", (folder.path() / "out").string()},
            "none: a session folder expected");
}

TEST(BadInput, PoseRowCutOff) {
  replace("pose0/data.csv", "\n4000000,1,2,3,1,0,0,0\n", "\n4000000,1,2,3,1\n");
  replay_ends_with(2, "pose0/data.csv row 4: 8 fields expected, found 5");
}

TEST(BadInput, PoseThatIsNoNumber) {
  replace("pose0/data.csv", "\n4000000,1,", "\n4000000,nan,");
  replay_ends_with(2, "pose0/data.csv row 4, field 2: a finite number from -100000 to 100000 expected");
}

TEST(BadInput, PosesThatDoNotCoverTheFrames) {
  replace("cam0/data.csv", "20000000,b.png", "90000000,b.png");
  replay_ends_with(2, "poses do not cover frame b.png");
}

TEST(BadInput, PictureOfAnotherSize) {
  picture("b.png", 32, 23);
  replay_ends_with(2, "b.png: 32 x 24 px expected, found 32 x 23");
}

TEST(BadInput, PictureCutOff) {
  fs::resize_file(folder.path() / "cam0/data/b.png", 50);
  replay_ends_with(2, "b.png");
}

TEST(BadInput, PictureMissing) {
  fs::remove(folder.path() / "cam0/data/a.png");
  replay_ends_with(2, "a.png (named in data.csv row 2): not found");
}

/// Opening a pipe that nobody writes to would wait for ever.
TEST(BadInput, PipesAndDevicesInPlaceOfFiles) {
  for (const char* file : {"cam0/sensor.yaml", "cam0/data.csv", "pose0/data.csv", "cam0/data/a.png"}) {
    const fs::path place = folder.path() / file, aside = folder.path() / "aside";
    fs::rename(place, aside);
    LONGS_EQUAL(0, ::mkfifo(place.c_str(), 0600));
    replay_ends_with(2, fs::path{file}.filename().string());
    fs::remove(place);
    fs::create_symlink("/dev/zero", place);
    replay_ends_with(2, fs::path{file}.filename().string());
    fs::remove(place);
    fs::rename(aside, place);
  }
  const fs::path cloud = folder.path() / "pipe.ply";
  LONGS_EQUAL(0, ::mkfifo(cloud.c_str(), 0600));
  ends_with(2, {"extract", cloud.string(), "--out", (folder.path() / "out").string()},
            "pipe.ply: a regular file expected");
  replay_ends_with(3, "refused");  // all is as it was
}

TEST(BadInput, UnreadableYaml) {
  folder.write("cam0/sensor.yaml", "resolution: [1626, 320\n");
  replay_ends_with(2, "sensor.yaml line 2");
}

TEST(BadInput, UnknownYamlKey) {
  replace("cam0/sensor.yaml", "intrinsics:", "focus: 3\nintrinsics:");
  replay_ends_with(2, "focus: not a key of this file");
}

TEST(BadInput, CloudsThatAreNone) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex ";
  const std::string xyz = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  extract_ends_with(2, head + "0" + xyz, "at least one point expected");
  extract_ends_with(2, head + "1\nproperty float y\nproperty float z\nend_header\n1 2\n",
                    "property x expected");
  extract_ends_with(2, head + "3" + xyz + "1 2 3\n", "cloud.ply line 9: more values expected");
  extract_ends_with(2, "solid shoe\n", "a PLY file expected");
  ends_with(2, {"extract", "/nowhere.ply", "--out", (folder.path() / "out").string()},
            "/nowhere.ply: not found");
}

TEST(BadInput, ReadableCloudWithoutShoeIsRefused) {
  std::string points;
  for (int i = 0; i < 300; ++i) points += std::to_string(i % 20) + " " + std::to_string(i / 20) + " 0\n";
  extract_ends_with(3,
                    "ply\nformat ascii 1.0\nelement vertex 300\nproperty float x\nproperty float y\nproperty "
                    "float z\nend_header\n" +
                        points,
                    "refused");
}

TEST(BadInput, WrongUse) {
  ends_with(2, {"extract"}, "see --help");
  ends_with(2, {"conjure"}, "see --help");
  ends_with(2, {"evaluate", "--cloud", "a.ply"}, "--cloud needs --surface");
}

}  // namespace biteline
