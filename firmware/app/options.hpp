// SPDX-License-Identifier: MIT
#pragma once
/// \file The command line of biteline-sensor.

#include <filesystem>
#include <optional>
#include <string>

#include "common/core/result.hpp"
#include "common/wire/endpoint.hpp"
#include "firmware/app/peak_wishes.hpp"
#include "firmware/app/source.hpp"
#include "firmware/runtime/realtime.hpp"

namespace biteline::sensor {

struct Options {
  SourceOptions source;
  PeakWishes peaks;       ///< what this command line says, and beneath it what the set says
  PeakWishes told_peaks;  ///< what this command line says
  wire::Endpoint listen;
  std::optional<std::filesystem::path> record;
  std::uint32_t record_pictures_every{1};
  double record_keep_gb{0};  ///< 0: all recordings stay
  std::uint32_t record_every{1};
  bool record_asked{false};
  std::optional<std::string> keep;  ///< "last" or "next": only ask for that scan, and leave
  std::optional<std::filesystem::path> keys;
  std::optional<std::filesystem::path> make_keys;
  std::string name{"biteline-sensor"};
  std::optional<runtime::RealtimeDemand> realtime;  ///< not told: required, but for recordings
  std::size_t store_megabytes{256};
  bool exit_with_parent{false};
  bool stay_after_scan{false};
  bool stills{false};                           ///< single pictures on demand, no scans
  std::optional<std::filesystem::path> upkeep;  ///< folder in which upkeep.yaml is kept; none: nothing is
  bool check{false};                            ///< only say what of the board answers
  bool check_rate{false};                       ///< only say whether the head's rate is reached
};

/// What to do after parsing: run, or leave at once (help, version) with a status.
struct ParsedOptions {
  Options options;
  std::optional<int> leave_with;
};

[[nodiscard]] ParsedOptions parse_options(int argc, char** argv);

}  // namespace biteline::sensor
