// SPDX-License-Identifier: MIT
// biteline capture: calibration pictures with poses from the real devices, as `biteline calibrate` reads
// them.
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>
#include <utility>

#include "common/config/camera_state_yaml.hpp"
#include "common/options/command.hpp"
#include "common/session/session.hpp"
#include "common/system/file.hpp"
#include "host/apps/biteline/capture_accept.hpp"
#include "host/apps/biteline/capture_check.hpp"
#include "host/apps/biteline/capture_scan.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/calibration/head/camera_state.hpp"
#include "host/calibration/head/folder.hpp"
#include "host/calibration/head/pose_file.hpp"
#include "host/calibration/head/verdict.hpp"
#include "host/calibration/laser/stripe.hpp"
#include "host/calibration/rings/picture.hpp"
#include "host/intake/capture/advice.hpp"
#include "host/intake/capture/picture_judge.hpp"
#include "host/intake/capture/still_camera.hpp"
#include "host/report/json_text.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;
using capture::ArmRest;

enum class Part { Camera, Laser, HandEye };

struct CaptureOptions {
  fs::path calib, board{"/etc/biteline/board.yaml"}, target, poses;
  std::string rt{"required"};
  double exposure_us{20'000}, laser_exposure_us{400};
  int pictures{0};
  bool by_itself{false};
};

/// An arm at rest: a common controller's poses scatter by 0.02 mm; the picture's rings are good to as much.
constexpr double k_still_mm = 0.1, k_still_deg = 0.02;
/// Another place than the last picture's.
constexpr double k_new_place_mm = 3, k_new_place_deg = 1;
constexpr std::chrono::milliseconds k_look{150};
constexpr std::chrono::minutes k_longest_wait{10};
/// A link that is lost comes back within this.
constexpr std::chrono::seconds k_pose_patience{30};
constexpr int k_most_attempts = 3;
/// Names that no reader takes for pictures.
constexpr const char* k_taken = "taken.part";
constexpr const char* k_taken_laser = "taken_laser.part";

const char* folder_of(Part part) {
  return part == Part::Camera ? "camera" : part == Part::Laser ? "laser" : "handeye";
}

/// Pictures that make a good calibration (docs/calibration.md).
int usual_count(Part part) {
  return part == Part::Laser ? 10 : 12;
}

bool is_new_place(const SE3& T, const SE3& T_last) {
  const Eigen::AngleAxisd turn{T_last.linear().transpose() * T.linear()};
  return (T.translation() - T_last.translation()).norm() > k_new_place_mm ||
         std::abs(turn.angle()) * 180 / std::numbers::pi > k_new_place_deg;
}

std::string number_name(int number, const char* ending) {
  char text[40];
  std::snprintf(text, sizeof text, "%02d%s", number, ending);
  return text;
}

/// CALIB/target.yaml, or CALIB/laser/target.yaml: there already, or a copy of --target.
Result<calibration::RingTarget> target_of(const CaptureOptions& options, Part part) {
  const fs::path file = options.calib / (part == Part::Laser ? "laser/target.yaml" : "target.yaml");
  std::error_code error;
  if (!options.target.empty()) {
    BITELINE_TRY(calibration::read_target(options.target));
    BITELINE_ASSIGN(const std::string told, read_regular_file(options.target, k_most_settings_bytes));
    if (!fs::exists(file, error)) {
      BITELINE_TRY(report::prepare_folder(file.parent_path()));
      BITELINE_TRY(report::write_file_atomically(file, told));
    }
    BITELINE_ASSIGN(const std::string there, read_regular_file(file, k_most_settings_bytes));
    if (there != told)
      return fail(Errc::BadValue, "%s: differs from %s; mend it there, or take a new folder", file.c_str(),
                  options.target.c_str());
  }
  if (!fs::exists(file, error))
    return fail(Errc::FileNotFound, "%s: --target FILE with the numbers on the print expected", file.c_str());
  BITELINE_ASSIGN(const calibration::RingTarget target, calibration::read_target(file));
  if ((target.planes == 2) != (part == Part::Laser))
    return fail(Errc::BadValue, "%s: planes: %d expected", file.c_str(), part == Part::Laser ? 2 : 1);
  return target;
}

/// One part of the wizard, from the pictures that are there to the verdict.
class Session {
 public:
  Session(const CaptureOptions& options, const GlobalOptions& global, Part part, capture::StillCamera& camera,
          const calibration::RingTarget& target)
      : options_{options}, global_{global}, part_{part}, camera_{camera}, target_{target} {}

  Result<void> run() {
    folder_ = options_.calib / folder_of(part_);
    BITELINE_TRY(report::prepare_folder(folder_));
    BITELINE_ASSIGN(const geometry::CameraState state, camera_.state());
    BITELINE_TRY(calibration::expect_folder_state(options_.calib, state));
    if (state.told()) {
      BITELINE_TRY(report::write_file_atomically(
          folder_ / config::k_camera_state_file,
          "# What the camera did to these pictures.\n" + config::camera_state_text(state, "")));
    }
    BITELINE_TRY(take_up());
    const int wanted = options_.pictures > 0 ? options_.pictures : usual_count(part_);
    while (kept_ < wanted) {
      say((wanted - kept_ == 1 ? "one more picture" : std::to_string(wanted - kept_) + " more pictures") +
          (next_.empty() ? "" : "; wanted next: " + next_));
      BITELINE_ASSIGN(const bool goes_on, wait_for_place());
      if (!goes_on) break;
      BITELINE_TRY(take_picture());
    }
    std::error_code ignored;
    for (const char* left : {k_taken, k_taken_laser}) fs::remove(folder_ / left, ignored);
    return {};
  }

 private:
  void say(const std::string& line) const {
    if (global_.quiet || global_.json) return;
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  }

  /// What an earlier run left: counted, and weighed for what is wanted next.
  Result<void> take_up() {
    const char* ending = part_ == Part::Laser ? "_rings.png" : ".png";
    const auto files = calibration::numbered_pictures(folder_, ending);
    if (files) {
      for (const calibration::NumberedPicture& file : *files) {
        number_ = std::max(number_, file.number + 1);
        BITELINE_ASSIGN(const image::GreyImage picture, calibration::read_picture(file.file));
        note(picture, find_grids(picture, target_, target_.planes));
        if (part_ == Part::Laser) {
          if (const auto lit = calibration::read_picture(folder_ / number_name(file.number, "_laser.png")))
            note_stripe(*lit);
        }
        ++kept_;
      }
    }
    const fs::path table = folder_ / "poses.csv";
    if (part_ == Part::HandEye && options_.poses.empty() && fs::exists(table)) {
      BITELINE_ASSIGN(poses_, calibration::read_hand_eye_poses(table));
    }
    if (!options_.poses.empty()) {
      BITELINE_ASSIGN(poses_, calibration::read_hand_eye_poses(options_.poses));
    }
    for (const session::StampedPose& pose : poses_) places_.push_back(pose.T_base_flange);
    advise();
    return {};
  }

  /// Until the arm rests at a new place, or Enter; false: the person has had enough.
  Result<bool> wait_for_place() {
    if (!options_.by_itself) {
      say("move there, then press Enter (q: enough)");
      std::string line;
      return static_cast<bool>(std::getline(std::cin, line)) && line != "q";
    }
    const auto until = std::chrono::steady_clock::now() + k_longest_wait;
    auto heard = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() < until) {
      BITELINE_ASSIGN(const ArmRest rest, camera_.rest());
      if (rest.poses > 0) heard = std::chrono::steady_clock::now();
      if (std::chrono::steady_clock::now() - heard > k_pose_patience) {
        return fail(Errc::Timeout,
                    "no pose came from the robot for %d s: check the link, or leave out --auto",
                    static_cast<int>(k_pose_patience.count()));
      }
      const bool still = rest.poses > 0 && rest.moved_mm < k_still_mm && rest.moved_deg < k_still_deg;
      if (still && (!T_last_ || is_new_place(rest.T_base_flange, *T_last_))) return true;
      std::this_thread::sleep_for(k_look);
    }
    return fail(Errc::Timeout, "the arm did not come to rest at a new place for %d minutes",
                static_cast<int>(k_longest_wait.count()));
  }

  struct Taken {
    ArmRest rest;
    image::GreyImage picture;
    fs::path file;
  };
  Result<Taken> take(bool laser) {
    Taken taken;
    taken.file = folder_ / (laser ? k_taken_laser : k_taken);
    for (int attempt = 1;; ++attempt) {
      const Result<ArmRest> rest = camera_.take(
          {.laser = laser, .exposure_us = laser ? options_.laser_exposure_us : options_.exposure_us},
          taken.file);
      if (rest) {
        taken.rest = *rest;
        break;
      }
      // The laser's guard goes dark on a machine that is late: that is over a moment later.
      if (rest.error().code != Errc::DeviceError || attempt == k_most_attempts)
        return tl::unexpected<Error>{rest.error()};
    }
    if (taken.rest.exposure_us == 0.0 && !std::exchange(told_of_exposure_, true))
      say("the camera's driver has no exposure control: its pictures are as bright as it makes them");
    BITELINE_ASSIGN(taken.picture, calibration::read_picture(taken.file));
    return taken;
  }

  Result<void> take_picture() {
    BITELINE_ASSIGN(const Taken rings, take(false));
    T_last_ = rings.rest.T_base_flange;
    const auto grids = find_grids(rings.picture, target_, target_.planes);
    capture::PictureVerdict verdict = capture::judge_rings(rings.picture, grids, target_);
    if (verdict.refused.empty()) verdict.refused = moved(rings.rest);
    std::optional<Taken> laser;
    if (verdict.refused.empty() && part_ == Part::Laser) {
      BITELINE_ASSIGN(laser, take(true));
      capture::PictureVerdict stripe = capture::judge_stripe(laser->picture);
      verdict.refused = stripe.refused.empty() ? moved(laser->rest) : stripe.refused;
      if (verdict.refused.empty() && laser->rest.poses > 0 &&
          is_new_place(laser->rest.T_base_flange, rings.rest.T_base_flange))
        verdict.refused = "the arm moved between the two pictures";
      verdict.warnings.insert(verdict.warnings.end(), stripe.warnings.begin(), stripe.warnings.end());
    }
    if (!verdict.refused.empty()) {
      say("not kept: " + verdict.refused);
      return {};
    }
    BITELINE_TRY(keep(rings, laser));
    note(rings.picture, grids);
    if (laser) note_stripe(laser->picture);
    advise();
    std::string line =
        "kept " + number_name(number_ - 1, "") + ": " + std::to_string(verdict.rings) + " rings";
    for (const std::string& warning : verdict.warnings) line += "; " + warning;
    say(line);
    return {};
  }

  [[nodiscard]] std::string moved(const ArmRest& rest) const {
    const bool by_hand = !options_.poses.empty();
    if (rest.poses == 0) {
      return part_ == Part::HandEye && !by_hand
                 ? "no pose came from the robot: check the link, or --poses FILE"
                 : "";
    }
    if (rest.moved_mm < k_still_mm && rest.moved_deg < k_still_deg) return {};
    char text[120];
    std::snprintf(text, sizeof text, "the arm moved by %.2f mm and %.3f degrees: wait for it to rest",
                  rest.moved_mm, rest.moved_deg);
    return text;
  }

  /// The pose before its picture: a row without picture is in nobody's way.
  Result<void> keep(const Taken& rings, const std::optional<Taken>& laser) {
    const auto rename = [](const fs::path& from, const fs::path& to) -> Result<void> {
      std::error_code error;
      fs::rename(from, to, error);
      if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", to.c_str());
      return {};
    };
    if (part_ == Part::HandEye) BITELINE_TRY(keep_pose(rings.rest));
    if (laser) BITELINE_TRY(rename(laser->file, folder_ / number_name(number_, "_laser.png")));
    BITELINE_TRY(
        rename(rings.file, folder_ / number_name(number_, part_ == Part::Laser ? "_rings.png" : ".png")));
    ++number_;
    ++kept_;
    return {};
  }

  Result<void> keep_pose(const ArmRest& rest) {
    const RobotClock::time_point stamp{Nanoseconds{number_}};
    if (options_.poses.empty()) {
      std::erase_if(poses_, [&](const session::StampedPose& pose) { return pose.stamp == stamp; });
      poses_.push_back({.stamp = stamp, .T_base_flange = rest.T_base_flange});
      places_.push_back(rest.T_base_flange);
    }
    const fs::path table = folder_ / "poses.csv", beside = folder_ / "poses.csv.part";
    BITELINE_TRY(session::write_pose_table(beside, poses_));
    std::error_code error;
    fs::rename(beside, table, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", table.c_str());
    return {};
  }

  void note(const image::GreyImage& picture, const std::vector<calibration::GridView>& grids) {
    size_ = {.width_px = picture.width_px, .height_px = picture.height_px};
    for (const calibration::GridView& grid : grids)
      views_.push_back(calibration::make_plane_view(number_name(number_, ""), grid, target_));
  }

  void note_stripe(const image::GreyImage& picture) {
    const auto stripe = calibration::find_stripe(picture);
    if (!stripe || stripe->points.empty()) return;
    double sum = 0;
    for (const calibration::StripePoint& point : stripe->points) sum += point.pixel_px.y();
    stripe_rows_px_.push_back(sum / static_cast<double>(stripe->points.size()));
  }

  void advise() {
    next_.clear();
    if (part_ == Part::Laser) {
      next_ = capture::missing_depth(stripe_rows_px_, std::max(size_.height_px, 3));
    } else if (part_ == Part::HandEye) {
      next_ = capture::missing_turn(places_);
    } else if (kept_ > 0) {
      const capture::Coverage coverage = capture::coverage_of(views_, size_);
      if (const std::string field = capture::missing_field(coverage); !field.empty())
        next_ = "the target in the " + field;
      if (next_.empty()) next_ = capture::missing_tilt(tilts());
    }
  }

  /// Of the views so far, by a calibration with them alone.
  [[nodiscard]] std::vector<SE3> tilts() const {
    constexpr std::size_t k_least_views = 4;
    std::vector<SE3> out;
    if (views_.size() < k_least_views) return out;
    if (const auto camera = calibration::calibrate_camera(views_, size_)) {
      for (const calibration::CameraView& view : camera->views) out.push_back(view.T_cam_target);
    }
    return out;
  }

  const CaptureOptions& options_;
  const GlobalOptions& global_;
  Part part_;
  capture::StillCamera& camera_;
  calibration::RingTarget target_;
  fs::path folder_;
  int number_{0}, kept_{0};
  bool told_of_exposure_{false};
  std::optional<SE3> T_last_;
  calibration::PictureSize size_;
  std::vector<calibration::PlaneView> views_;
  std::vector<double> stripe_rows_px_;
  std::vector<session::StampedPose> poses_;
  std::vector<SE3> places_;
  std::string next_;
};

/// All that the folder holds so far, calibrated: what the pictures are worth.
Result<calibration::Verdict> verdict_of(const fs::path& calib, Part part) {
  calibration::HeadInput input;
  BITELINE_ASSIGN(input.camera, calibration::read_camera_folder(calib));
  if (part == Part::Laser) {
    BITELINE_ASSIGN(input.laser, calibration::read_laser_folder(calib));
  }
  if (part == Part::HandEye) {
    BITELINE_ASSIGN(input.hand_eye, calibration::read_hand_eye_folder(calib));
  }
  return calibration::judge(calibration::calibrate_head(input));
}

Result<ExitStatus> run(const CaptureOptions& options, const GlobalOptions& global, Part part) {
  std::signal(SIGPIPE, SIG_IGN);  // a sensor program that died is an error, not our death
  BITELINE_ASSIGN(const calibration::RingTarget target, target_of(options, part));
  {
    BITELINE_ASSIGN(capture::StillCamera camera, capture::StillCamera::start(options.board, options.rt));
    BITELINE_TRY(Session(options, global, part, camera, target).run());
  }
  std::error_code error;
  if (!fs::exists(options.calib / "camera", error)) {
    if (global.json) {
      const nlohmann::ordered_json none{{"part", folder_of(part)}, {"grade", nullptr}};
      std::printf("%s\n", report::to_text(none).c_str());
    } else if (!global.quiet) {
      std::printf("the verdict comes with the camera's pictures: biteline capture camera\n");
    }
    return ExitStatus::Done;
  }
  BITELINE_ASSIGN(const calibration::Verdict verdict, verdict_of(options.calib, part));
  if (global.json) {
    std::printf("%s\n", report::to_text(nlohmann::ordered_json{{"part", folder_of(part)},
                                                               {"grade", calibration::name_of(verdict.grade)},
                                                               {"reasons", verdict.reasons},
                                                               {"retake", verdict.retake}})
                            .c_str());
  } else if (!global.quiet) {
    std::printf("%s: %s\n", folder_of(part), calibration::name_of(verdict.grade));
    for (const std::string& reason : verdict.reasons) std::printf("  %s\n", reason.c_str());
    for (const std::string& picture : verdict.retake) std::printf("  retake %s\n", picture.c_str());
  }
  return verdict.grade == calibration::Grade::Bad ? ExitStatus::Refused : ExitStatus::Done;
}

}  // namespace

void add_capture(options::Command& app, Context& context) {
  auto options = std::make_shared<CaptureOptions>();
  options::Command* command = app.add_subcommand(
      "capture", "Calibration pictures with poses from the sensor's own devices, into a calibration folder");
  command->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, Part part) {
    options::Command* sub = command->add_subcommand(name, what);
    sub->add_option("CALIB", options->calib, "The calibration folder; pictures are added to what is there")
        ->required();
    sub->add_option("--board", options->board, "The unit's board.yaml; its sensor program must be off")
        ->capture_default_str();
    sub->add_option("--target", options->target, "target.yaml of the print, copied into the folder");
    sub->add_option("--pictures", options->pictures, "How many in the end; those there already count")
        ->check(options::number({.minimum = 1, .maximum = 99}, "pictures"))
        ->default_str(std::to_string(usual_count(part)));
    sub->add_option("--exposure-us", options->exposure_us, "With the lamp on")
        ->check(options::number({.minimum = 1, .maximum = 1e6}, "us"))
        ->capture_default_str();
    sub->add_flag("--auto", options->by_itself,
                  "A picture whenever the arm has come to rest at a new place, in place of Enter");
    sub->add_option("--rt", options->rt, "As of biteline-sensor: required or ignore")
        ->check(options::one_of({"required", "ignore"}))
        ->capture_default_str();
    sub->callback([options, part, &context] {
      context.run = [options, part, &context] { return run(*options, context.options, part); };
    });
    return sub;
  };
  add_capture_check(*command, context);
  add_capture_accept(*command, context);
  add_capture_scan(*command, context);
  add("camera", "Views of the target: lens and sensor", Part::Camera);
  add("laser", "The two-plane target, each place with lamp and with laser: the laser's plane", Part::Laser)
      ->add_option("--laser-exposure-us", options->laser_exposure_us, "With the laser on")
      ->check(options::number({.minimum = 1, .maximum = 1e6}, "us"))
      ->capture_default_str();
  add("hand-eye", "The fixed target from many poses of the arm: the head's place on the flange",
      Part::HandEye)
      ->add_option("--poses", options->poses, "Poses read by hand, numbered as the pictures (poses.csv)");
}

}  // namespace biteline::app
