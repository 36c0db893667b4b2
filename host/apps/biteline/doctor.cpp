// SPDX-License-Identifier: MIT
// biteline doctor: what of this machine and board is ready, and the one step for each thing that is not.
#include <fcntl.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "host/apps/biteline/command.hpp"
#include "host/apps/biteline/doctor_abilities.hpp"
#include "host/apps/biteline/doctor_light.hpp"
#include "host/intake/child_process.hpp"
#include "host/intake/sensor_process.hpp"
#include "host/report/json_text.hpp"
#include "host/robot/link/ur/controller_door.hpp"

namespace biteline::app {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

/// Names in `folder` that begin with `prefix`.
std::vector<fs::path> entries(const fs::path& folder, const std::string& prefix) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator it{folder, error}, end; !error && it != end; it.increment(error)) {
    if (it->path().filename().string().starts_with(prefix)) found.push_back(it->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

Finding check_program(const std::string& name) {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path() / name;
  const bool there = ::access(program.c_str(), X_OK) == 0;
  return {"program " + name, there, there ? program.string() : "not beside this program",
          there ? "" : "run ./run build"};
}

Finding check_processors() {
  const unsigned count = std::thread::hardware_concurrency();
  return {"processors", count >= 2, std::to_string(count),
          count >= 2 ? "" : "use a machine with two cores or more: scan and host share them"};
}

Finding check_realtime_kernel() {
  const bool rt = first_line("/sys/kernel/realtime") == "1";
  utsname name{};
  ::uname(&name);
  return {"real-time kernel", rt, name.release,
          rt ? ""
             : "on the sensor: apt-get install linux-image-rt-$(dpkg --print-architecture); elsewhere start "
               "biteline-sensor with --rt=ignore"};
}

Finding check_limit(const std::string& what, __rlimit_resource resource, rlim_t wanted,
                    const std::string& systemd_name) {
  rlimit limit{};
  ::getrlimit(resource, &limit);
  const bool ready = ::geteuid() == 0 || limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= wanted;
  const std::string seen = limit.rlim_cur == RLIM_INFINITY ? "unlimited" : std::to_string(limit.rlim_cur);
  return {what, ready, ::geteuid() == 0 ? seen + " (root)" : seen,
          ready
              ? ""
              : "set " + systemd_name + " in the unit, or the limit in /etc/security/limits.d/biteline.conf"};
}

/// Device files of one kind, and whether this user may open them.
Finding check_device(const std::string& what, const fs::path& folder, const std::string& prefix,
                     const std::string& step) {
  const auto found = entries(folder, prefix);
  if (found.empty()) return {what, false, "none", step};
  for (const fs::path& device : found) {
    if (::access(device.c_str(), R_OK | W_OK) == 0) return {what, true, device.string(), ""};
  }
  return {what, false, found.front().string() + ": no permission",
          "install the board's udev rules and join the group biteline"};
}

Finding check_can() {
  for (const fs::path& interface : entries("/sys/class/net", "")) {
    // 280: ARPHRD_CAN of linux/if_arp.h.
    if (first_line(interface / "type") != "280") continue;
    const std::string name = interface.filename();
    const bool up = first_line(interface / "operstate") != "down";
    return {"CAN interface", up, name + (up ? "" : " is down"),
            up ? "" : "ip link set " + name + " up type can bitrate 500000 restart-ms 100"};
  }
  return {"CAN interface", false, "none", "enable the board's overlay, or take poses over RTDE"};
}

Finding check_receive_buffer() {
  // Two frames of 1626 x 1236 in packets with their headers; below that GigE Vision loses packets at the
  // first hiccup.
  constexpr long k_wanted_bytes = 5'000'000;
  const std::string seen = first_line("/proc/sys/net/core/rmem_max");
  const bool ready = std::strtol(seen.c_str(), nullptr, 10) >= k_wanted_bytes;
  return {"network receive buffer", ready, seen + " bytes",
          ready ? "" : "sysctl -w net.core.rmem_max=8388608 (GigE Vision)"};
}

Finding check_clock_source() {
  const std::string source = first_line("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  const bool ready = !source.empty() && source != "jiffies" && source != "refined-jiffies";
  return {"clock source", ready, source, ready ? "" : "boot without clocksource=jiffies"};
}

std::vector<Finding> examine() {
  return {
      check_program("biteline-sensor"),
      check_program("biteline-host"),
      check_program("biteline-cell"),
      check_processors(),
      check_clock_source(),
      check_receive_buffer(),
      check_realtime_kernel(),
      check_limit("real-time priority", RLIMIT_RTPRIO, 80, "LimitRTPRIO=80"),
      check_limit("locked memory", RLIMIT_MEMLOCK, RLIM_INFINITY, "LimitMEMLOCK=infinity"),
      check_device("V4L2 camera", "/dev", "video",
                   "connect the camera and enable the board's overlay, or use a GigE camera"),
      check_device("GPIO (laser enable, interlock)", "/dev", "gpiochip", "enable the board's overlay"),
      check_device("PWM (hardware trigger)", "/sys/class/pwm", "pwmchip",
                   "enable the board's overlay; without it the trigger is timed by software"),
      check_can(),
      check_device(
          "PTP clock", "/dev", "ptp",
          "use a network controller with a hardware clock; without one the camera's clock is fitted"),
      check_device("watchdog", "/dev", "watchdog", "enable the board's watchdog; systemd's own still works"),
  };
}

/// The sensor program's own look at each device that the board names.
Result<std::vector<Finding>> examine_board(const std::string& board_file) {
  constexpr std::chrono::seconds k_patience{30};  // a camera that does not answer takes some seconds
  BITELINE_ASSIGN(const fs::path program, intake::find_sensor_program());
  BITELINE_ASSIGN(intake::ChildProcess sensor,
                  intake::ChildProcess::start(
                      {.program = program, .arguments = {"--check", "--source", "board:" + board_file}}));
  std::vector<Finding> findings;
  while (const Result<std::string> line = sensor.next_line(k_patience)) {
    std::istringstream row{*line};
    std::string ready;
    Finding finding;
    std::getline(row, ready, '\t');
    std::getline(row, finding.what, '\t');
    std::getline(row, finding.seen, '\t');
    std::getline(row, finding.step);
    finding.ready = ready == "ready";
    finding.what = "board: " + finding.what;
    findings.push_back(std::move(finding));
  }
  BITELINE_TRY(sensor.wait(k_patience));
  if (findings.empty()) return fail(Errc::BadFormat, "%s", sensor.last_words().c_str());
  return findings;
}

/// What the arm's controller says about itself.
Finding ask_robot(const std::string& address) {
  constexpr Nanoseconds k_patience{3'000'000'000};
  const bool told = address.rfind(':') != std::string::npos;
  const Result<wire::Endpoint> at = wire::parse_endpoint(
      "tcp://" + address + (told ? "" : ":" + std::to_string(robot::ur::k_dashboard_port)));
  const auto words = at ? robot::ur::ask_controller(
                              {.dashboard = {at->host, at->port},
                               .robot_api = {at->host, told ? std::uint16_t{0} : robot::ur::k_robot_api_port},
                               .script = {at->host, robot::ur::k_primary_port}},
                              k_patience)
                        : Result<robot::ur::ControllerWords>{tl::unexpected<Error>{at.error()}};
  const std::string what = "robot at " + address;
  if (!words) {
    // Refused: a machine is there, and nothing listens on that port.
    const bool refused = words.error().sys_errno == ECONNREFUSED;
    return {
        what, false, to_line(words.error()),
        refused
            ? "take a controller with PolyScope 3.12.3, 5.5.1 or X 10.12 at least; on such a one, switch the "
              "dashboard server on, on PolyScope X HTTP (Settings, Security, Services)"
            : "switch the controller on, check cable and address, allow the dashboard in its settings"};
  }
  const std::string seen = robot::ur::summary(*words);
  if (const std::optional<std::string> why = robot::ur::unsupported(*words))
    return {what, false, seen + "; " + *why,
            "update the controller's software: PolyScope 3.12.3, 5.5.1 or X 10.12 at least"};
  if (words->remote == false)
    return {
        what, false, seen,
        "switch on remote control at the teach pendant (Settings, System, Remote Control; PolyScope X: Mode "
        "Selection, Automatic, Remote)"};
  if (words->robot_mode.value_or("RUNNING") != "RUNNING")
    return {what, false, seen, "switch the arm on and release its brakes at the teach pendant"};
  return {what, true, seen, ""};
}

void print(const std::vector<Finding>& findings, const std::vector<Ability>& abilities) {
  for (const Finding& f : findings) {
    std::printf("%-7s %-44s %s\n", f.ready ? "ready" : "missing", f.what.c_str(), f.seen.c_str());
    if (!f.ready) std::printf("        %-44s -> %s\n", "", f.step.c_str());
  }
  std::printf("\n");
  for (const Ability& ability : abilities) {
    if (ability.can()) std::printf("you can:    %s\n", ability.what.c_str());
  }
  for (const Ability& ability : abilities) {
    if (!ability.can())
      std::printf("you cannot: %s, because: %s\n", ability.what.c_str(), ability.because().c_str());
  }
}

nlohmann::ordered_json findings_json(const std::vector<Finding>& findings,
                                     const std::vector<Ability>& abilities) {
  nlohmann::ordered_json json{{"findings", nlohmann::ordered_json::array()},
                              {"abilities", nlohmann::ordered_json::array()}};
  for (const Finding& f : findings)
    json["findings"].push_back({{"what", f.what}, {"ready", f.ready}, {"seen", f.seen}, {"step", f.step}});
  for (const Ability& ability : abilities)
    json["abilities"].push_back(
        {{"what", ability.what}, {"can", ability.can()}, {"missing", ability.missing}});
  return json;
}

}  // namespace

void add_doctor(options::Command& app, Context& context) {
  static constexpr const char* k_unit_board = "/etc/biteline/board.yaml";
  options::Command* command = app.add_subcommand(
      "doctor", "Say what of this machine and board is ready, and the one step for what is not");
  auto board = std::make_shared<std::string>(fs::exists(k_unit_board) ? k_unit_board : "");
  command
      ->add_option("--board", *board,
                   "Open each device of this board.yaml too; a unit's own is looked at anyway")
      ->check(options::existing_file());
  auto robot = std::make_shared<std::string>();
  command->add_option("--robot", *robot,
                      "Ask the arm's controller, too: HOST, or HOST:PORT of its dashboard");
  auto light = std::make_shared<LightQuestion>();
  add_light_options(*command, *light);
  command->callback([board, robot, light, &context] {
    if (light->asked) {
      context.run = [light, &context]() -> Result<ExitStatus> {
        BITELINE_ASSIGN(const MeasuredLight measured, read_measured_light(*light));
        const std::vector<LightChoice> choices = light_choices(light->light);
        if (context.options.json)
          std::printf("%s\n", report::to_text(light_json(choices, measured)).c_str());
        else
          print_light(choices, measured);
        return ExitStatus::Done;
      };
      return;
    }
    context.run = [board, robot, &context]() -> Result<ExitStatus> {
      std::vector<Finding> findings = examine();
      if (!board->empty()) {
        BITELINE_ASSIGN(std::vector<Finding> devices, examine_board(*board));
        findings.insert(findings.end(), std::make_move_iterator(devices.begin()),
                        std::make_move_iterator(devices.end()));
      }
      if (!robot->empty()) findings.push_back(ask_robot(*robot));
      const std::vector<Ability> abilities = abilities_of(findings);
      if (context.options.json) {
        std::printf("%s\n", report::to_text(findings_json(findings, abilities)).c_str());
      } else {
        print(findings, abilities);
      }
      return ExitStatus::Done;
    };
  });
}

}  // namespace biteline::app
