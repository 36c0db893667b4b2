// SPDX-License-Identifier: MIT
#include "firmware/app/source.hpp"

#include <string_view>
#include <utility>

#include "firmware/app/board_devices.hpp"
#include "firmware/app/live_head.hpp"
#include "hal/replay/recording.hpp"
#include "hal/replay/replay_camera.hpp"
#include "hal/replay/replay_poses.hpp"

namespace biteline::sensor {
namespace {

/// How many profiles the frames make: a laser-off frame none, a bracket's two one.
std::uint64_t profiles_in(const session::Session& session) {
  const bool pairs = session.recorded && session.recorded->second_exposures;
  std::uint64_t profiles = 0;
  bool first_waits = false;
  for (const session::FrameEntry& frame : session.frames) {
    if ((frame.flags & hal::k_frame_laser_off) != 0) continue;
    const bool second = (frame.flags & hal::k_frame_second_exposure) != 0;
    // As ProfilePipeline::rt_process(): a first goes out with its second, or when the next first comes.
    if (!pairs || second || first_waits) ++profiles;
    first_waits = pairs && !second;
  }
  return profiles;
}

class Recording final : public SourceKind {
 public:
  explicit Recording(std::shared_ptr<const session::Session> session) : session_{std::move(session)} {
    model = session_->sensor;
    camera_state = model.camera_state;
    recording = true;
    recorded = session_->recorded;
    if (recorded) {
      capture.laser_off_frames = recorded->laser_off_frames;
      // Its length is the camera's affair; that there is one tells the pipeline of the pairs.
      if (recorded->second_exposures) capture.second_exposure = Nanoseconds{1};
    }
  }

  Result<Source> open() override {
    Source source;
    BITELINE_ASSIGN(source.camera, hal::replay::ReplayCamera::open(session_, {}));
    BITELINE_TRY(source.camera->configure({.region = model.region}));
    source.poses = std::make_unique<hal::replay::ReplayPoses>(session_);
    source.scan_name = session_->root.lexically_normal().filename().string();
    source.frames_expected = profiles_in(*session_);
    return source;
  }

  Result<std::optional<LaserDevices>> open_laser() override { return std::optional<LaserDevices>{}; }

 private:
  std::shared_ptr<const session::Session> session_;
};

Result<std::unique_ptr<SourceKind>> with_capture(Result<std::unique_ptr<SourceKind>> kind,
                                                 const Capture& capture) {
  if (!kind) return kind;
  if (const Result<void> good = check(capture, (*kind)->model); !good) {
    if (!(*kind)->set) return tl::unexpected<Error>{good.error()};
    const std::string words{good.error().where.view()};
    return fail(good.error().code, "%s: %s", (*kind)->set->file.c_str(), words.c_str());
  }
  (*kind)->capture = capture;
  return kind;
}

}  // namespace

Result<void> SourceKind::adopt(const geometry::SensorModel&, const Capture&, const settings::SettingsSet&) {
  return fail(Errc::NotSupported, "this source's settings stand");
}

Result<std::unique_ptr<SourceKind>> choose_source(const SourceOptions& options) {
  const std::string_view text{options.source};
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  const std::string_view rest = colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  if (kind == "replay" && !rest.empty()) {
    if (options.set) {
      return fail(Errc::InvalidArgument, "--settings: a live source expected, '%s' is a recording",
                  options.source.c_str());
    }
    if (options.capture.any()) {
      return fail(Errc::InvalidArgument,
                  "source '%s': a recording is exposed already; --auto-exposure, --follow-stripe, "
                  "--laser-off-frames and --second-exposure-us need a camera",
                  options.source.c_str());
    }
    BITELINE_ASSIGN(std::shared_ptr<const session::Session> session,
                    hal::replay::open_recording(std::filesystem::path{rest}, options.sensor_file));
    return std::make_unique<Recording>(std::move(session));
  }
  if (kind == "board" && !rest.empty()) {
    if (!options.sensor_file)
      return fail(Errc::InvalidArgument, "source '%s': --sensor FILE is needed", options.source.c_str());
    return with_capture(open_board(std::filesystem::path{rest}, *options.sensor_file, options.set),
                        options.set ? put_over(options.capture, *options.set) : options.capture);
  }
  return fail(Errc::InvalidArgument, "source '%s': replay:SESSION or board:FILE expected",
              options.source.c_str());
}

}  // namespace biteline::sensor
