// SPDX-License-Identifier: MIT
// biteline calibrate and biteline target as a script sees them: files, exit status, one line on stderr.
#include <CppUTest/TestHarness.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/config/yaml_reader.hpp"
#include "common/image/grey_image.hpp"
#include "host/calibration/rings/target.hpp"
#include "host/intake/child_process.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/json.hpp"
#include "tests/support/made_session.hpp"
#include "tests/support/ring_scene.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

TEST_GROUP(CalibrateTool) {
  test::TemporaryFolder folder;
  test::RingScene scene;
  std::mt19937_64 random{3};

  void setup() override {
    scene.camera = {.fu_px = 1000, .fv_px = 995, .cu_px = 250, .cv_px = 190, .k1 = -0.1, .k2 = 0.1};
    scene.size = {.width_px = 500, .height_px = 380};
    scene.target.rows = 4;
    scene.target.cols = 5;
  }

  void write_target(const char* extra) const {
    folder.write("target.yaml",
                 std::string("rows: 4\ncols: 5\npitch: 14\nouter_diameter: 12\ninner_diameter: 6\n") + extra);
  }

  /// `shake_px`: rows lie beside where they belong, in each picture otherwise, as behind a shutter that
  /// rolls while the head shakes.
  void write_views(int count, double shake_px = 0) {
    fs::create_directories(folder.path() / "camera");
    int number = 0;
    for (const test::ViewPlace& place : test::varied_places(count, random)) {
      const auto shaken = [shake_px, number](const Vec2& at) {
        constexpr double k_wave_px = 25, k_phase_rad = 2.4;
        return Vec2(at.x() + shake_px * std::sin(at.y() / k_wave_px + k_phase_rad * number), at.y());
      };
      const image::GreyImage picture = test::draw_rings(
          scene, {test::T_cam_target_of(scene.target, place)},
          {.noise_grey = 1.5, .blur_px = 0.8, .samples = 2, .sampled_at = shaken, .light = {}, .covered = {}},
          random);
      SUCCEEDS(image::write_png(folder.path() / "camera" / (std::to_string(number++) + ".png"), picture));
    }
  }

  [[nodiscard]] fs::path out() const {
    return folder.path() / "out";
  }

  int run(std::vector<std::string> arguments, const std::string& expected_words) const {
    auto child = intake::ChildProcess::start({.program = BITELINE_TOOL, .arguments = std::move(arguments)});
    SUCCEEDS(child);
    const auto status = child->wait(120s);
    SUCCEEDS(status);
    STRCMP_CONTAINS(expected_words.c_str(), child->last_words().c_str());
    return *status;
  }

  [[nodiscard]] nlohmann::json report() const {
    std::ifstream in(out() / "report.json");
    return test::read_json(in);
  }
};

TEST(CalibrateTool, TheStateOfThePicturesIsTheHeadsAndTwoStatesAreRefusedByName) {
  write_target("");
  write_views(6);
  folder.write("camera/camera_state.yaml", "mirror_y: true\nbinning_x: 1\npixel_format: \"GREY\"\n");
  LONGS_EQUAL(0, run({"calibrate", "camera", folder.path().string(), "--out", out().string()}, ""));
  std::ifstream in(out() / "sensor.yaml");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  STRCMP_CONTAINS("camera_state:", text.c_str());
  STRCMP_CONTAINS("  mirror_y: true\n", text.c_str());
  folder.write("handeye/camera_state.yaml", "mirror_y: false\n");
  LONGS_EQUAL(3, run({"calibrate", "camera", folder.path().string(), "--out", out().string()},
                     "two states of the camera: mirror_y 1 against 0"));
}

TEST(CalibrateTool, CameraAloneGivesItsLinesAndNoMadeUpOnes) {
  write_target("");
  write_views(6);
  LONGS_EQUAL(0, run({"calibrate", "camera", folder.path().string(), "--out", out().string()}, ""));
  auto reader = config::YamlReader::open(out() / "sensor.yaml");
  SUCCEEDS(reader);
  DOUBLES_EQUAL(scene.camera.fu_px, reader->numbers("intrinsics", 4)[0], 1.0);
  CHECK_FALSE(reader->has("laser_plane"));
  CHECK_FALSE(reader->has("T_flange_cam"));
  STRCMP_EQUAL("ok", report()["status"].get<std::string>().c_str());
  CHECK(report()["camera"]["fu_px"]["sigma"].get<double>() > 0);
  CHECK(fs::exists(out() / "stages/coverage.png"));
  CHECK(report()["warnings"].empty());
  std::ifstream page(out() / "index.html");
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  STRCMP_CONTAINS("stages/coverage.png", text.c_str());
  STRCMP_CONTAINS("rings or corners off the camera model", text.c_str());
}

TEST(CalibrateTool, FilesWithoutUseAreNamed) {
  write_target("");
  write_views(6);
  folder.write("camera/IMG_7.png", "");
  folder.write("camera/7.jpg", "");
  // Else the last word is that nothing tells it.
  folder.write("camera/camera_state.yaml", "mirror_x: false\n");
  run({"calibrate", "camera", folder.path().string(), "--out", out().string()},
      "camera/IMG_7.png is not used");
  LONGS_EQUAL(2, report()["warnings"].size());
  STRCMP_CONTAINS("camera/7.jpg", report()["warnings"][0].get<std::string>().c_str());
}

TEST(CalibrateTool, JsonIsExactlyTheReportAlsoOfARefusal) {
  write_target("");
  write_views(2);
  auto child = intake::ChildProcess::start(
      {.program = BITELINE_TOOL,
       .arguments = {"calibrate", "camera", folder.path().string(), "--out", out().string(), "--json"}});
  SUCCEEDS(child);
  std::string told;
  while (const auto line = child->next_line(120s)) told += *line + "\n";
  LONGS_EQUAL(3, *child->wait(10s));
  std::ifstream file(out() / "report.json");
  const std::string written{std::istreambuf_iterator<char>(file), {}};
  STRCMP_EQUAL(written.c_str(), told.c_str());
  STRCMP_EQUAL("camera_not_trusted", report()["reason_code"].get<std::string>().c_str());
  LONGS_EQUAL(1, report()["schema_version"].get<int>());
}

TEST(CalibrateTool, TwoViewsAreRefusedAndAnOlderResultIsGone) {
  write_target("");
  write_views(2);
  folder.write("out/sensor.yaml", "of an earlier run\n");
  LONGS_EQUAL(3, run({"calibrate", folder.path().string(), "--out", out().string(), "--only", "camera"},
                     "refused: camera: 2 usable views"));
  STRCMP_EQUAL("refused", report()["status"].get<std::string>().c_str());
  STRCMP_CONTAINS("at least 3", report()["reason"].get<std::string>().c_str());
  CHECK_FALSE(fs::exists(out() / "sensor.yaml"));
}

TEST(CalibrateTool, BadGradeIsRefusedAndWritesNoCalibration) {
  write_target("");
  write_views(16, 0.25);
  folder.write("out/sensor.yaml", "of an earlier run\n");
  folder.write("out/uncertainty.yaml", "of an earlier run\n");
  LONGS_EQUAL(3, run({"calibrate", "camera", folder.path().string(), "--out", out().string()}, "refused"));
  STRCMP_EQUAL("refused", report()["status"].get<std::string>().c_str());
  STRCMP_EQUAL_TEXT("calibration_bad", report()["reason_code"].get<std::string>().c_str(),
                    report()["reason"].get<std::string>().c_str());
  STRCMP_CONTAINS("rings off by [px]", report()["reason"].get<std::string>().c_str());
  STRCMP_EQUAL("bad", report()["verdict"]["grade"].get<std::string>().c_str());
  CHECK_FALSE(fs::exists(out() / "sensor.yaml"));
  CHECK_FALSE(fs::exists(out() / "uncertainty.yaml"));
  CHECK(fs::exists(out() / "index.html"));
  CHECK(fs::exists(out() / "stages/rings_camera.png"));
  // The step, taken: the same places again, with the head at rest.
  write_views(16);
  LONGS_EQUAL(0, run({"calibrate", "camera", folder.path().string(), "--out", out().string()}, ""));
  CHECK(fs::exists(out() / "sensor.yaml"));
}

TEST(CalibrateTool, ScanThatCannotTellTheClockCostsTheClockOnly) {
  write_target("");
  write_views(6);
  test::write_made_session({}, folder.path() / "clock");  // one way only, nothing is seen twice
  const std::string sensor = (folder.path() / "clock/cam0/sensor.yaml").string();
  LONGS_EQUAL(0, run({"calibrate", folder.path().string(), "--out", out().string(), "--sensor", sensor},
                     "clock offset not determined"));
  STRCMP_EQUAL("ok", report()["status"].get<std::string>().c_str());
  CHECK_FALSE(report()["clock"]["determined"].get<bool>());
  STRCMP_CONTAINS("seen twice", report()["clock"]["reason"].get<std::string>().c_str());
  CHECK(fs::exists(out() / "sensor.yaml"));
  // Asked for by name it is the answer, and there is none.
  LONGS_EQUAL(3,
              run({"calibrate", "clock", folder.path().string(), "--out", out().string(), "--sensor", sensor},
                  "refused: clock"));
  CHECK_FALSE(fs::exists(out() / "sensor.yaml"));
}

TEST(CalibrateTool, BadInputIsNamed) {
  LONGS_EQUAL(2, run({"calibrate", (folder.path() / "none").string(), "--out", out().string()},
                     "a calibration folder expected"));
  LONGS_EQUAL(2, run({"calibrate", folder.path().string(), "--out", out().string()}, "target.yaml"));
  write_target("colour: black\n");
  LONGS_EQUAL(2, run({"calibrate", folder.path().string(), "--out", out().string()},
                     "colour: not a key of this file"));
  write_target("");
  LONGS_EQUAL(2, run({"calibrate", folder.path().string(), "--out", out().string()}, "camera"));
}

TEST(CalibrateTool, TargetIsDrawnToScale) {
  const fs::path file = folder.path() / "target.svg";
  LONGS_EQUAL(0, run({"target", "--out", file.string(), "--rows", "3", "--cols", "4", "--pitch", "20",
                      "--outer-diameter", "15", "--inner-diameter", "7"},
                     ""));
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  int circles = 0;
  for (auto at = text.find("<circle"); at != std::string::npos; at = text.find("<circle", at + 1)) ++circles;
  LONGS_EQUAL(12, circles);
  STRCMP_CONTAINS("width=\"150.000mm\"",
                  text.c_str());  // the caption and a margin of one pitch on either side
  // Its numbers stand beside it, and are not written over.
  const fs::path numbers = folder.path() / "target.yaml";
  LONGS_EQUAL(20, static_cast<int>(calibration::read_target(numbers)->pitch_mm));
  LONGS_EQUAL(2, run({"target", "--out", file.string(), "--pitch", "21"}, "has other numbers"));
  LONGS_EQUAL(2, run({"target", "--out", (folder.path() / "target.png").string()}, ".pdf or .svg"));
  const fs::path two = folder.path() / "two.pdf";
  LONGS_EQUAL(0, run({"target", "--out", two.string(), "--planes", "2"}, ""));
  LONGS_EQUAL(2, calibration::read_target(folder.path() / "two.yaml")->planes);
}

TEST(CalibrateTool, ChessboardIsDrawnAndOptionsOfTheOtherKindAreRefused) {
  const fs::path file = folder.path() / "board.svg";
  LONGS_EQUAL(0, run({"target", "--kind", "chessboard", "--out", file.string(), "--square-rows", "5",
                      "--square-cols", "8"},
                     ""));
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  int squares = 0;
  for (auto at = text.find("<rect x="); at != std::string::npos; at = text.find("<rect x=", at + 1))
    ++squares;
  LONGS_EQUAL(20, squares);
  const auto target = calibration::read_target(folder.path() / "board.yaml");
  SUCCEEDS(target);
  LONGS_EQUAL(4 * 7, target->rings());
  DOUBLES_EQUAL(8, target->pitch_mm, 1e-9);
  LONGS_EQUAL(2, run({"target", "--kind", "chessboard", "--rows", "5", "--out", file.string()},
                     "--rows: not of --kind chessboard"));
  LONGS_EQUAL(
      2, run({"target", "--square-rows", "5", "--out", file.string()}, "--square-rows: not of --kind rings"));
}

}  // namespace biteline
