// SPDX-License-Identifier: MIT
#pragma once
/// \file The command line of biteline-host.

#include <filesystem>
#include <optional>
#include <string>

#include "common/wire/endpoint.hpp"
#include "host/apps/biteline-host/black_box.hpp"
#include "host/apps/biteline-host/kept_recordings.hpp"
#include "host/cloud/uncertainty/head_uncertainty.hpp"
#include "host/records/memory/factory_day.hpp"
#include "host/robot/path/checks/fixture.hpp"
#include "host/transfer/transfer.hpp"

namespace biteline::service {

struct RobotOptions {
  std::string arm;                ///< UR5e, ...
  std::filesystem::path process;  ///< process YAML
  std::string arm_link;  ///< an arm of another make: HOST:PORT of the generic protocol; empty: a UR's
  std::filesystem::path kinematics;  ///< of that arm; empty: as the model has them
  std::string rtde{"127.0.0.1:30004"};
  std::string script{"127.0.0.1:30001"};
  std::string dashboard;             ///< empty: port 29999 of the script's machine
  std::string robot_api;             ///< of a PolyScope X; empty: port 80 of the script's machine
  std::string serial;                ///< of the one arm that may be meant; empty: any of that model
  std::optional<double> natural_hz;  ///< of the softest joint, measured; none: assumed
  double table_z_mm{0};
  std::optional<double> fixture_z_mm;  ///< its top, where the shoe stands on one
  double fixture_beyond_mm{path::Fixture{}.beyond_mm};
  int hold_register{47};           ///< of the controller's input_int_register_N; below 0: none is held
  std::optional<int> clamp_input;  ///< standard digital input: true while the clamp holds the shoe
  bool send{false};
  std::string confirm;  ///< the one scan that a person lets be sent though nobody saw it come in
};

/// Scans are uppers without a sole: their line comes from a sample.
struct SampleOptions {
  std::string sample;  ///< folder of a finished sample, or a saved model's name
  std::filesystem::path library;
  transfer::TransferOptions transfer;
};

/// Doors: pages, PLCs, tools.
struct DoorOptions {
  std::optional<wire::Endpoint> control;       ///< where they come in; nothing: none do
  std::optional<std::filesystem::path> keys;   ///< folder of the listening end's; compulsory beyond loopback
  bool web{false};                             ///< start biteline-web beside this service
  std::string web_address;                     ///< where it listens; empty: its own default
  std::optional<std::filesystem::path> guest;  ///< file for a one-time token of a viewer
  std::optional<std::filesystem::path> jobs;   ///< of the line's control; nothing: it has no say
};

struct Options {
  std::filesystem::path backup, restore;  ///< a file: only that, then leave
  wire::Endpoint sensor;
  std::optional<std::filesystem::path> keys;
  std::filesystem::path out;
  std::optional<uncertainty::HeadUncertainty> uncertainty;  ///< of the sensor's head, where it is told
  std::optional<SampleOptions> sample;                      ///< without: the line is looked for in the scan
  std::optional<RobotOptions> robot;                        ///< without: the line is the result
  DoorOptions doors;
  std::filesystem::path library;      ///< of models
  std::filesystem::path releases;     ///< of the factory's releases, see release::Shelf; empty: none
  bool models{false};                 ///< each scan's model is recognised in the library
  std::string time_zone;              ///< of the factory's day; empty: the machine's own
  memory::FactoryDay day{};           ///< when it begins
  std::optional<double> keep_days{};  ///< folders of older scans go; their rows stay
  std::optional<double> keep_gb{};    ///< the oldest folders go beyond it
  bool stop_on_drift{false};          ///< of the head's calibration: no path is sent without a person's word
  bool calibration_anew{false};       ///< what was learnt of it is forgotten at the start
  bool once{false};
  KeptRecordings kept;
  double keep_refused_gb{k_default_refused_gb};  ///< of messages of refused scans alone
  bool exit_with_parent{false};
};

struct ParsedOptions {
  Options options;
  std::optional<int> leave_with;
};

[[nodiscard]] ParsedOptions parse_options(int argc, char** argv);

}  // namespace biteline::service
