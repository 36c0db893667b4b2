// SPDX-License-Identifier: MIT
#include "host/intake/recorded_scan.hpp"

#include <utility>

#include "common/session/recording_facts.hpp"
#include "common/wire/scan_file.hpp"

namespace biteline::intake {
namespace {

/// What the messages say, one after the other.
struct Intake {
  RecordedScan scan;
  std::optional<CloudBuilder> builder;
  std::uint64_t next_sequence{0};
  std::uint64_t missing{0};
  std::optional<wire::EndOfScan> end;

  void note_sequence(std::uint64_t sequence) {
    if (sequence > next_sequence) missing += sequence - next_sequence;
    next_sequence = sequence + 1;
  }
};

std::optional<std::string> what_lacks(const Intake& intake, const wire::ScanFileEnd& file) {
  if (file.bytes_left != 0) {
    return "the file is cut or damaged: " + std::to_string(file.bytes_left) +
           " bytes behind the last whole message are left out";
  }
  if (!intake.end) return "the scan has no end: whoever recorded it was stopped";
  if (intake.end->errc != 0) return "the scan ended early: " + intake.end->where;
  if (intake.missing != 0) return std::to_string(intake.missing) + " messages are missing";
  return std::nullopt;
}

}  // namespace

Result<std::optional<ProfileSource>> choose_profiles(const std::filesystem::path& input) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(input, ignored)) {
    return ProfileSource{.file = input, .why = "the input is a recorded scan"};
  }
  const std::filesystem::path facts_file = input / "recording.yaml";
  if (!std::filesystem::exists(facts_file, ignored)) return std::optional<ProfileSource>{};
  BITELINE_ASSIGN(const session::RecordingFacts facts, session::read_recording_facts(facts_file));
  if (facts.complete) return std::optional<ProfileSource>{};
  return ProfileSource{
      .file = input / "scan.btln",
      .why = "the recording's pictures do not repeat the scan (" + std::to_string(facts.pictures_left_out) +
             " pictures and " + std::to_string(facts.poses_left_out) + " poses left out, " +
             std::to_string(facts.unrepeatable) + " profiles made otherwise, or it was cut)"};
}

Result<RecordedScan> read_recorded_scan(const std::filesystem::path& file, const OnProfile& on_profile) {
  Intake intake;
  BITELINE_ASSIGN(
      const wire::ScanFileEnd end,
      wire::read_scan_file(file, [&](wire::Message message, std::span<const std::uint8_t>) -> Result<void> {
        if (auto* hello = std::get_if<wire::SensorHello>(&message.body)) {
          if (intake.builder) return {};  // said again
          intake.builder.emplace(hello->model);
          intake.scan.run.sensor = std::move(*hello);
        } else if (auto* profile = std::get_if<profile::Profile>(&message.body)) {
          intake.note_sequence(message.sequence);
          const std::span<const Eigen::Vector3f> points = intake.builder->add(*profile);
          if (on_profile) on_profile(*profile, points, intake.builder->stripe_of_last());
        } else if (auto* over = std::get_if<wire::EndOfScan>(&message.body)) {
          intake.note_sequence(message.sequence);
          intake.end = std::move(*over);
        }
        return {};
      }));
  if (intake.scan.run.sensor.test_pattern) {
    return fail(Errc::BadValue,
                "%s: the sensor showed its test pattern, and no shoe; scan with camera.test_pattern off",
                file.c_str());
  }
  const wire::SensorHello& sensor = intake.scan.run.sensor;
  if (const auto state = geometry::expect_state(sensor.model.camera_state, sensor.camera_state); !state)
    return fail(Errc::Refused, "%.80s: %.160s", file.c_str(), state.error().where.c_str());
  intake.scan.lacks = what_lacks(intake, end);
  SessionRun& run = intake.scan.run;
  if (intake.end) {
    run.sensor_counters = intake.end->counters;
    run.sensor_stages = intake.end->stages;
  }
  run.counts = intake.builder->counts();
  run.cloud = intake.builder->take();
  return std::move(intake.scan);
}

}  // namespace biteline::intake
