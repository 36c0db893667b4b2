// SPDX-License-Identifier: MIT
#include "firmware/app/source.hpp"

#include <string_view>
#include <utility>

#include "hal/replay/recording.hpp"
#include "hal/replay/replay_camera.hpp"
#include "hal/replay/replay_poses.hpp"

namespace biteline::sensor {
namespace {

Result<Source> open_replay(const std::filesystem::path& folder, const SourceOptions& options) {
  BITELINE_ASSIGN(std::shared_ptr<const session::Session> recording,
                  hal::replay::open_recording(folder, options.sensor_file));
  Source source;
  BITELINE_ASSIGN(source.camera, hal::replay::ReplayCamera::open(recording, {}));
  source.poses = std::make_unique<hal::replay::ReplayPoses>(recording);
  source.model = recording->sensor;
  source.scan_name = folder.lexically_normal().filename().string();
  source.frames_expected = recording->frames.size();
  source.lossless = true;
  BITELINE_TRY(source.camera->configure({.region = source.model.region}));
  return source;
}

}  // namespace

Result<Source> open_source(const SourceOptions& options) {
  const std::string_view text{options.source};
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  const std::string_view rest = colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  if (kind == "replay" && !rest.empty()) return open_replay(std::filesystem::path{rest}, options);
  return fail(Errc::InvalidArgument, "source '%s': replay:SESSION expected", options.source.c_str());
}

}  // namespace biteline::sensor
