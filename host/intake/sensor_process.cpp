// SPDX-License-Identifier: MIT
#include "host/intake/sensor_process.hpp"

#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

namespace biteline::intake {
namespace {

namespace fs = std::filesystem;

/// A program whose stdout has ended is about to end itself.
constexpr std::chrono::seconds k_ending{5};
/// What a shell and host/intake add to the number of the signal that ended a program.
constexpr int k_signal_base = 128;

Result<wire::Endpoint> parse_announcement(const std::string& line) {
  const nlohmann::json announced = nlohmann::json::parse(line, nullptr, false);
  if (!announced.is_object() || !announced.contains("endpoint") || !announced["endpoint"].is_string()) {
    return fail(Errc::ProtocolError, "biteline-sensor said '%.80s' instead of where it listens",
                line.c_str());
  }
  return wire::parse_endpoint(announced["endpoint"].get<std::string>());
}

/// The code for an exit status: the program's own words are the text.
Errc code_of(int exit_status) {
  switch (static_cast<ExitStatus>(exit_status)) {
    case ExitStatus::BadInput:
      return Errc::BadFormat;
    case ExitStatus::Refused:
      return Errc::Refused;
    case ExitStatus::Connection:
    case ExitStatus::Done:
      break;
  }
  return Errc::ProcessDied;
}

}  // namespace

Result<fs::path> find_sensor_program() {
  const fs::path here = intake::program_folder();
  std::error_code error;
  for (const fs::path& candidate :
       {here / "biteline-sensor", here.parent_path() / "bin" / "biteline-sensor"}) {
    if (fs::exists(candidate, error)) return candidate;
  }
  return fail(Errc::FileNotFound, "biteline-sensor, expected beside this program in %s", here.c_str());
}

Result<SensorProcess> SensorProcess::start(const fs::path& program, const std::vector<std::string>& arguments,
                                           intake::ChildProcess::Duration timeout) {
  BITELINE_ASSIGN(intake::ChildProcess child,
                  intake::ChildProcess::start({.program = program, .arguments = arguments}));
  SensorProcess sensor{std::move(child)};
  const Result<std::string> line = sensor.child_.next_line(timeout);
  if (!line)
    return tl::unexpected<Error>{line.error().code == Errc::ProcessDied ? sensor.death() : line.error()};
  BITELINE_ASSIGN(sensor.endpoint_, parse_announcement(*line));
  return sensor;
}

Error SensorProcess::death() {
  const Result<int> status = child_.wait(k_ending);
  if (!status) return status.error();
  const std::string words = child_.last_words();
  const char* separator = words.empty() ? "" : ": ";
  if (*status > k_signal_base) {
    return fail(Errc::ProcessDied, "biteline-sensor was ended by a signal (%s)%s%s",
                strsignal(*status - k_signal_base), separator, words.c_str())
        .value();
  }
  return fail(code_of(*status), "biteline-sensor ended with status %d%s%s", *status, separator, words.c_str())
      .value();
}

}  // namespace biteline::intake
