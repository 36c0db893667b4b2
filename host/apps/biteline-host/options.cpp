// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/options.hpp"

#include <cstdio>

#include "common/options/command.hpp"
#include "host/cloud/uncertainty/uncertainty_file.hpp"
#include "host/robot/kinematics/arm_model.hpp"
#include "host/transfer/library.hpp"

namespace biteline::service {
namespace {

int usage_fault(const std::string& line) {
  std::fprintf(stderr, "biteline-host: %s\n", line.c_str());
  return static_cast<int>(ExitStatus::BadInput);
}

}  // namespace

ParsedOptions parse_options(int argc, char** argv) {
  ParsedOptions parsed;
  Options& options = parsed.options;
  RobotOptions robot;
  SampleOptions carry{.sample = {}, .library = transfer::Library::default_folder(), .transfer = {}};
  std::string sensor;
  std::string day_begin = options.day.begin();
  options::Command app{
      "Biteline's service: takes scans in, finds the bite line, plans the path, lets the arm follow it.",
      "biteline-host"};
  app.set_version_flag("--version", BITELINE_VERSION);
  app.add_option("--sensor", sensor, "Where the sensor listens: tcp://HOST:PORT; compulsory to scan");
  app.add_option("--keys", options.keys, "Folder of keys; compulsory beyond loopback");
  app.add_option("--out", options.out, "Folder of the results: scan-0001, scan-0002, ...")->required();
  std::filesystem::path uncertainty;
  app.add_option("--uncertainty", uncertainty,
                 "How well the sensor's head is known: uncertainty.yaml of `biteline calibrate`");
  auto* sample = app.add_option("--sample", carry.sample,
                                "The scans are uppers without a sole: carry the line over from this sample "
                                "(the folder of a finished scan, or "
                                "a saved model's name)");
  app.add_option("--library", carry.library, "Folder of the saved models")->capture_default_str();
  app.add_flag("--mirror", carry.transfer.align.mirror, "The sample is of the other foot")->needs(sample);
  app.add_flag("--grade", carry.transfer.align.grade, "The sample is of another size")->needs(sample);
  app.add_flag("--models", options.models,
               "Recognise each scan's model in the library and use that model's line and process")
      ->excludes(sample);
  app.add_option(
         "--releases", options.releases,
         "Folder of the factory's releases (biteline-uplink's): once one is in force, each scan takes models "
         "and processes from it alone")
      ->excludes(sample);
  auto* arm =
      app.add_option("--robot", robot.arm, kinematics::known_arms() + ": plan its path along the line");
  app.add_option("--process", robot.process, "Process YAML: tool, placement, motion")->needs(arm);
  app.add_option("--natural-hz", robot.natural_hz,
                 "The softest joint's own frequency with the tool, where it was measured [Hz]; else 8")
      ->check(options::number({.minimum = 1, .maximum = 100}, "Hz"))
      ->needs(arm);
  app.add_option("--table-z", robot.table_z_mm, "Height of the table in the robot's base [mm]")
      ->check(options::number(k_plausible_mm, "mm"))
      ->needs(arm);
  auto* fixture =
      app.add_option(
             "--fixture-z", robot.fixture_z_mm,
             "Where the shoe stands on a fixture: its top in the robot's base [mm]; else on the table")
          ->check(options::number(k_plausible_mm, "mm"))
          ->needs(arm);
  app.add_option("--fixture-beyond", robot.fixture_beyond_mm,
                 "How far the fixture stands out beyond the line, all round [mm]")
      ->check(options::number({.minimum = 0, .maximum = 500}, "mm"))
      ->needs(fixture)
      ->capture_default_str();
  auto* arm_link =
      app.add_option("--arm-link", robot.arm_link,
                     "An arm of another make, built as --robot: HOST:PORT of its program of the generic arm "
                     "protocol (usual port: 30400); the ports below are a Universal Robots' arm's")
          ->needs(arm);
  app.add_option("--kinematics", robot.kinematics,
                 "With --arm-link: the arm's own calibration (YAML of the ROS extractor)")
      ->needs(arm_link);
  app.add_option("--rtde", robot.rtde, "The controller's real-time port, HOST:PORT")
      ->capture_default_str()
      ->excludes(arm_link);
  app.add_option(
         "--script", robot.script,
         "The controller's script port, HOST:PORT; 30001 says why it does not run a program, 30002 does not")
      ->capture_default_str()
      ->excludes(arm_link);
  app.add_option("--dashboard", robot.dashboard,
                 "The controller's dashboard port, HOST:PORT; without: port 29999 beside --script")
      ->excludes(arm_link);
  app.add_option("--robot-api", robot.robot_api,
                 "The Robot API of a PolyScope X, which has no dashboard, HOST:PORT; without: port 80 beside "
                 "--script, where no dashboard answers")
      ->excludes(arm_link);
  app.add_option("--serial", robot.serial, "The arm's serial number: no other one is sent a path")
      ->needs(arm);
  auto* send =
      app.add_flag("--send", robot.send, "Send a path that passed every check, and watch the arm follow it")
          ->needs(arm);
  app.add_option("--hold-register", robot.hold_register,
                 "With --send this service keeps the controller's input_int_register_N, which one client can "
                 "have: a service on another machine is refused; -1: keeps none")
      ->check(options::whole_number(-1, 47))
      ->capture_default_str()
      ->excludes(arm_link);
  app.add_option(
         "--clamp-input", robot.clamp_input,
         "The controller's standard digital input, 0 to 7, that is true while the clamp holds the shoe: a "
         "scan stays fresh as long as it has been so without a break")
      ->check(options::whole_number(0, 7))
      ->needs(arm)
      ->excludes(arm_link);
  app.add_option(
         "--confirm", robot.confirm,
         "A scan's folder, e.g. scan-0007: its path may be sent though the scan was recovered or is of "
         "a recording; you vouch that the shoe still stands as it was scanned")
      ->needs(send);
  std::string control;
  app.add_option("--control", control,
                 "Where pages and other doors come in: tcp://HOST:PORT; without: nowhere");
  app.add_option("--control-keys", options.doors.keys,
                 "Folder of the control end's keys (sensor.public, sensor.secret, hosts.allowed); compulsory "
                 "beyond loopback");
  auto* web = app.add_option("--web", options.doors.web_address,
                             "Start biteline-web beside this service; ADDRESS: where it listens")
                  ->expected(0, 1);
  app.add_option("--guest-token", options.doors.guest,
                 "Write a one-time token into this file: it lets one viewer look on");
  app.add_option(
      "--jobs", options.doors.jobs,
      "YAML of the jobs that the line's control may choose through biteline-web --modbus or --text, "
      "without a login; with it each start is one scan");
  app.add_option(
      "--time-zone", options.time_zone,
      "Of the factory's day in filters, trends and tables, such as Asia/Shanghai; else the machine's own");
  app.add_option("--day-begin", day_begin, "When the factory's day begins: hh:mm of its first shift")
      ->capture_default_str();
  app.add_option("--keep-days", options.keep_days,
                 "Remove the folders of scans that are older, but for marked ones; their rows stay")
      ->check(options::number({.minimum = 1, .maximum = 36500}, "days"));
  app.add_option("--keep-gb", options.keep_gb,
                 "Remove the oldest folders beyond so many gigabytes, but for marked ones; their rows stay")
      ->check(options::number({.minimum = 0.1, .maximum = 1e6}, "GB"));
  auto* backup = app.add_option(
      "--backup", options.backup,
      "Write memory, accounts, settings, models and saved processes into this file, and leave; also while "
      "a service runs");
  app.add_option("--restore", options.restore,
                 "Put back what such a file holds, and leave; --out must have no memory yet")
      ->excludes(backup);
  std::string on_drift{"warn"};
  app.add_option(
         "--on-drift", on_drift,
         "When scans show that the head's calibration has drifted: warn, or stop (no path is sent without a "
         "person's word)")
      ->check(options::one_of({"warn", "stop"}))
      ->capture_default_str();
  app.add_flag("--calibration-anew", options.calibration_anew,
               "Forget what the scans so far said about the calibration, and learn anew what is usual");
  app.add_flag("--once", options.once, "One scan, then leave");
  std::string kept{"refused"};
  auto* keep =
      app.add_option(
             "--keep-recordings", kept,
             "Keep the messages beside the result: all, refused (line or path, or rejected by a person), "
             "none, or a "
             "number N for each Nth scan")
          ->capture_default_str();
  app.add_option("--keep-refused-gb", options.keep_refused_gb,
                 "With --keep-recordings refused: the oldest messages go beyond so many gigabytes, but those "
                 "of marked scans; the results stay")
      ->check(options::number({.minimum = 0.01, .maximum = 1e6}, "GB"))
      ->capture_default_str();
  app.add_flag_callback(
         "--keep-recording", [&kept] { kept = "all"; }, "The same as --keep-recordings all")
      ->excludes(keep);
  app.add_flag("--exit-with-parent", options.exit_with_parent,
               "Stop when the program that started this one ends");
  if (const std::optional<options::Leave> leave = app.parse(argc, argv)) {
    parsed.leave_with = leave->fault.empty() ? 0 : usage_fault(leave->fault + " (see --help)");
    return parsed;
  }
  const std::optional<memory::FactoryDay> day = memory::FactoryDay::from(day_begin);
  if (!day) {
    parsed.leave_with = usage_fault("--day-begin: a time of day such as 06:00 expected");
    return parsed;
  }
  options.day = *day;
  const Result<KeptRecordings> which = KeptRecordings::parse(kept);
  if (!which) {
    parsed.leave_with = usage_fault(to_line(which.error()));
    return parsed;
  }
  options.kept = *which;
  options.stop_on_drift = on_drift == "stop";
  if (!uncertainty.empty()) {
    const Result<uncertainty::HeadUncertainty> known = uncertainty::read_uncertainty(uncertainty);
    if (!known) {
      parsed.leave_with = usage_fault(to_line(known.error()));
      return parsed;
    }
    options.uncertainty = *known;
  }
  if (!options.backup.empty() || !options.restore.empty()) {
    options.library = carry.library;
    return parsed;
  }
  if (sensor.empty()) {
    parsed.leave_with = usage_fault("--sensor is required (see --help)");
    return parsed;
  }
  const Result<wire::Endpoint> endpoint = wire::parse_endpoint(sensor);
  if (!endpoint) {
    parsed.leave_with = usage_fault(to_line(endpoint.error()));
    return parsed;
  }
  options.sensor = *endpoint;
  options.library = carry.library;
  options.doors.web = web->count() > 0;
  if (options.doors.web && control.empty()) control = "tcp://127.0.0.1:0";
  if (!control.empty()) {
    const Result<wire::Endpoint> at = wire::parse_endpoint(control);
    if (!at) {
      parsed.leave_with = usage_fault("--control: " + to_line(at.error()));
      return parsed;
    }
    options.doors.control = *at;
  }
  if (options.doors.jobs && !options.doors.control) {
    parsed.leave_with = usage_fault("--jobs needs --control or --web (see --help)");
    return parsed;
  }
  if (!carry.sample.empty()) options.sample = carry;
  if (!robot.arm.empty()) {
    if (robot.process.empty()) {
      parsed.leave_with = usage_fault("--robot needs --process (see --help)");
      return parsed;
    }
    options.robot = robot;
  }
  return parsed;
}

}  // namespace biteline::service
