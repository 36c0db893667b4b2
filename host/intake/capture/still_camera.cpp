// SPDX-License-Identifier: MIT
#include "host/intake/capture/still_camera.hpp"

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/config/camera_state_yaml.hpp"
#include "common/core/numbers.hpp"
#include "host/intake/sensor_process.hpp"

namespace biteline::capture {
namespace {

constexpr std::chrono::seconds k_patience{20};
constexpr NumberRange k_quaternion{-1.0001, 1.0001};
constexpr double k_unit_tolerance = 1e-3;
constexpr NumberRange k_exposure_us{0, 2e6};
constexpr int k_most_poses = 1'000'000;

/// From another program: nothing in it is believed before it was looked at.
Result<ArmRest> parse(const std::string& line) {
  const auto bad = [&] {
    return fail(Errc::ProtocolError, "biteline-sensor --stills said '%.80s'", line.c_str());
  };
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object() || !json.contains("ok") || !json["ok"].is_boolean()) return bad();
  if (!json["ok"].get<bool>()) {
    const std::string words = json.value("error", std::string{"no reason told"});
    return fail(Errc::DeviceError, "%s", words.c_str());
  }
  const auto number = [&](const char* key, NumberRange range) -> std::optional<double> {
    if (!json.contains(key) || !json[key].is_number() || !range.holds(json[key].get<double>()))
      return std::nullopt;
    return json[key].get<double>();
  };
  const auto poses = number("poses", {0, k_most_poses}), mm = number("moved_mm", {0, 2 * k_far_mm}),
             deg = number("moved_deg", {0, 360});
  const auto exposure_us = number("exposure_us", k_exposure_us);
  if (!poses || !mm || !deg || !json.contains("pose") || !json["pose"].is_array() || json["pose"].size() != 7)
    return bad();
  std::array<double, 7> p{};
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!json["pose"][i].is_number()) return bad();
    p[i] = json["pose"][i].get<double>();
    if (!(i < 3 ? k_plausible_mm : k_quaternion).holds(p[i])) return bad();
  }
  const Eigen::Quaterniond q{p[3], p[4], p[5], p[6]};
  if (std::abs(q.norm() - 1) > k_unit_tolerance) return bad();
  return ArmRest{.poses = static_cast<int>(*poses),
                 .T_base_flange = geometry::make_se3(q.normalized(), {p[0], p[1], p[2]}),
                 .moved_mm = *mm,
                 .moved_deg = *deg,
                 .exposure_us = exposure_us};
}

}  // namespace

Result<StillCamera> StillCamera::start(const std::filesystem::path& board, const std::string& rt) {
  BITELINE_ASSIGN(const std::filesystem::path program, intake::find_sensor_program());
  BITELINE_ASSIGN(
      intake::ChildProcess sensor,
      intake::ChildProcess::start(
          {.program = program,
           .arguments = {"--stills", "--source", "board:" + board.string(), "--rt", rt, "--exit-with-parent"},
           .give_stdin = true}));
  BITELINE_TRY(sensor.next_line(k_patience));
  return StillCamera{std::move(sensor)};
}

Result<ArmRest> StillCamera::ask(const std::string& order) {
  BITELINE_TRY(sensor_.write_line(order));
  BITELINE_ASSIGN(const std::string line, sensor_.next_line(k_patience));
  return parse(line);
}

Result<geometry::CameraState> StillCamera::state() {
  BITELINE_TRY(sensor_.write_line("state"));
  BITELINE_ASSIGN(const std::string line, sensor_.next_line(k_patience));
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object() || !json.contains("state") || !json["state"].is_string())
    return fail(Errc::ProtocolError, "biteline-sensor --stills said '%.80s'", line.c_str());
  const std::string text = json["state"].get<std::string>();
  if (text.empty()) return geometry::CameraState{};
  BITELINE_ASSIGN(config::YamlReader reader, config::YamlReader::parse(text, "the camera's state"));
  geometry::CameraState state = config::read_camera_state(reader);
  BITELINE_TRY(reader.finish());
  return state;
}

Result<ArmRest> StillCamera::rest() {
  return ask("pose");
}

Result<ArmRest> StillCamera::take(const StillOrder& order, const std::filesystem::path& file) {
  char words[60];
  std::snprintf(words, sizeof words, "take %s %.3f ", order.laser ? "laser" : "dark", order.exposure_us);
  return ask(words + std::filesystem::absolute(file).string());
}

}  // namespace biteline::capture
