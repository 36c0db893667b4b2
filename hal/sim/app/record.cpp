// SPDX-License-Identifier: MIT
#include <unistd.h>

#include <cstdio>
#include <memory>

#include "hal/sim/app/command.hpp"
#include "hal/sim/record/session_recorder.hpp"

namespace biteline::cell {

namespace {

struct RecordOptions {
  SceneOptions scene;
  std::string out;
  double clock_offset_ms{0};
  bool hide_clock_offset{false};
};

Result<void> record(const RecordOptions& options) {
  BITELINE_ASSIGN(const sim::SceneSettings settings, scene_settings(options.scene));
  BITELINE_ASSIGN(const auto scene, sim::make_scene(settings));
  const sim::RecordSettings record_settings{
      .pose_clock_offset = Nanoseconds{std::llround(options.clock_offset_ms * 1e6)},
      .tell_clock_offset = !options.hide_clock_offset,
      .noise_seed = settings.shoe.seed};
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const auto progress = [&](double ratio) {
    if (terminal) std::fprintf(stderr, "\r%3.0f %%", 100 * ratio);
  };
  BITELINE_TRY(sim::record_session(options.out, *scene, record_settings, progress));
  if (terminal) std::fprintf(stderr, "\r      \r");
  std::printf("simulated session of shoe %s %llu: %s\n", std::string(sim::name_of(settings.shoe.shoe_class)).c_str(),
              static_cast<unsigned long long>(settings.shoe.seed), options.out.c_str());
  return {};
}

}  // namespace

void add_record(CLI::App& app, Context& context) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* command = app.add_subcommand("record", "Write a made scan as a session folder, with its truth; no time runs");
  add_scene_options(*command, options->scene);
  command->add_option("--out", options->out, "The session's folder")->required();
  command->add_option("--clock-offset-ms", options->clock_offset_ms, "Pose clock minus camera clock")->check(CLI::Range(-1000.0, 1000.0));
  command->add_flag("--hide-clock-offset", options->hide_clock_offset, "sensor.yaml says 0 instead");
  command->callback([options, &context] { context.run = [options] { return record(*options); }; });
}

}  // namespace biteline::cell
