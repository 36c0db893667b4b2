// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/service_words.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <mutex>

#include "common/system/log_level.hpp"
#include "host/apps/biteline-host/told_once.hpp"

namespace biteline::service {

void log_error(const Error& error) {
  static std::mutex mutex;
  static ToldOnce told;
  const std::string words = to_line(error);
  const std::lock_guard lock{mutex};
  const ToldOnce::Heard heard = told.hear(words, now());
  if (!heard.tells) return;
  std::fprintf(stderr, "%sbiteline-host: %s\n", level_prefix(STDERR_FILENO, LogLevel::Error),
               with_count(words, heard).c_str());
}

HostClock::time_point now() {
  std::timespec time{};
  ::clock_gettime(CLOCK_BOOTTIME, &time);
  return HostClock::time_point{std::chrono::seconds{time.tv_sec} + Nanoseconds{time.tv_nsec}};
}

std::optional<path::Fixture> fixture_of(const RobotOptions& robot) {
  if (!robot.fixture_z_mm) return std::nullopt;
  return path::Fixture{.top_z_mm = *robot.fixture_z_mm, .beyond_mm = robot.fixture_beyond_mm};
}

ControllerAddress controller_of(const RobotOptions& robot) {
  return {
      .rtde = robot.rtde, .script = robot.script, .dashboard = robot.dashboard, .robot_api = robot.robot_api};
}

std::string utc_now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm parts{};
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&seconds, &parts));
  return text;
}

CatalogueFolders catalogue_folders(const Options& options) {
  return {.library = options.library,
          .shipped_processes = intake::program_folder().parent_path() / "share/biteline/processes",
          .saved_processes = options.out / "processes",
          .releases = options.releases};
}

}  // namespace biteline::service
