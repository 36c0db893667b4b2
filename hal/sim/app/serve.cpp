// SPDX-License-Identifier: MIT
#include <sys/prctl.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>

#include "common/config/sensor_yaml.hpp"
#include "common/options/command.hpp"
#include "hal/sim/app/command.hpp"
#include "hal/sim/app/target_options.hpp"
#include "hal/sim/app/tool_options.hpp"
#include "hal/sim/app/world_options.hpp"
#include "hal/sim/bus/board_file.hpp"
#include "hal/sim/live/live_cell.hpp"
#include "hal/sim/record/files.hpp"
#include "hal/sim/robot/program_text.hpp"

namespace biteline::cell {

namespace {

struct ServeOptions {
  SceneOptions scene{.size = 42, .straight_holder = false, .speed_mm_s = 50, .rate_hz = 50};
  WorldOptions world;
  ToolOptions tool;
  TargetOptions targets;
  std::string out;
  std::string wires;
  std::string camera{"127.0.0.1"};
  std::string arm{"ur10e"};
  std::uint16_t rtde_port{0}, script_port{0}, dashboard_port{0}, robot_api_port{0}, primary_port{0};
  std::string controller{"e-series"};
  std::string remote_control{"on"};
  std::string programs;
  int robot_rate_hz{500};
  double speed_slider{1};
  std::uint64_t arm_seed{1};
  double robot_clock_ms{0};
  double lost_packet_ratio{0};
  bool camera_free_clock{false};
  std::optional<double> time_ratio;
  double monostable_ms{0};
  bool stay_at_end{false};
  bool anywhere{false};
  bool exit_with_parent{false};
};

/// For whoever started this program: one line, then nothing more on stdout before the end.
void print_endpoints(const sim::LiveCell& cell, const ServeOptions& options) {
  const auto ports = cell.robot_ports();
  const sim::LiveCell::Stand stand = cell.stand();
  std::printf(
      "{\"simulated\":true,\"world\":\"%s\",\"wires\":\"%s\",\"camera\":\"%s\",\"rtde\":\"127.0.0.1:%d\","
      "\"script\":\"127.0.0.1:%d\",\"primary\":\"127.0.0.1:%d\","
      "\"dashboard\":\"127.0.0.1:%d\",\"robot_api\":\"127.0.0.1:%d\",\"arm\":\"%s\",\"out\":\"%s\","
      "\"sensor\":\"%s/"
      "sensor.yaml\",\"board\":\"%s/board.yaml\",\"scan_s\":%.3f,\"pose_sigma_mm\":%.4g,"
      "\"pose_sigma_rad\":%.4g,\"time_ratio\":%.2f,\"table_z_mm\":%.2f,\"fixture_z_mm\":%.2f,"
      "\"fixture_beyond_mm\":%.1f}\n",
      options.world.world.c_str(), cell.settings().wires.c_str(), cell.settings().camera_address.c_str(),
      int{ports.rtde}, int{ports.script}, int{ports.primary}, int{ports.dashboard}, int{ports.robot_api},
      options.arm.c_str(), options.out.c_str(), options.out.c_str(), options.out.c_str(),
      cell.scan_duration_s(), cell.settings().pose_noise_mm, cell.settings().pose_noise_rad,
      cell.time_ratio(), stand.table_z_mm, stand.fixture_z_mm, stand.fixture_beyond_mm);
  std::fflush(stdout);
}

void print_counts(const sim::LiveCounts& counts) {
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf(
      "{\"simulated\":true,\"exposures\":%llu,\"exposures_lit\":%llu,\"triggers\":%llu,\"triggers_missed\":%"
      "llu,\"scans\":%llu,"
      "\"scripts_run\":%llu,\"scripts_refused\":%llu,\"bus_messages_dropped\":%llu}\n",
      number(counts.exposures), number(counts.exposures_lit), number(counts.triggers),
      number(counts.triggers_missed), number(counts.scans), number(counts.scripts_run),
      number(counts.scripts_refused), number(counts.bus_messages_dropped));
}

/// Each `name.script` of `folder`, as "name.urp" to a dashboard and as "name" to the Robot API.
Result<std::map<std::string, std::string>> read_programs(const std::filesystem::path& folder) {
  std::map<std::string, std::string> programs;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".script") continue;
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto program = sim::parse_program(text);
    if (!program) {
      return fail(Errc::BadFormat, "%s: %s", entry.path().filename().c_str(),
                  to_line(program.error()).c_str());
    }
    const std::string name = entry.path().stem();
    programs[name] = programs[name + ".urp"] = text;
  }
  if (error) return fail_errno(Errc::FileNotFound, error.value(), "%s", folder.c_str());
  return programs;
}

Result<void> serve(const ServeOptions& options) {
  // Before any thread exists, so that the signals arrive at sigwait() below and nowhere else.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  if (options.exit_with_parent) {
    const pid_t parent = getppid();
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) return {};  // it died before the kernel knew
  }

  BITELINE_ASSIGN(sim::SceneSettings scene, scene_settings(options.scene));
  if (!options.anywhere) scene.places = sim::places_within_reach_of(options.arm);
  set_surroundings(scene, options.world);
  sim::LiveSettings settings;
  settings.disturbances = disturbances_of(options.world);
  settings.tool = working_tool(options.tool);
  scene.will_be_worked = settings.tool.has_value();
  settings.scene = scene;
  settings.targets = target_show(options.targets);
  settings.wires = options.wires.empty() ? "biteline-cell-" + std::to_string(getpid()) : options.wires;
  settings.camera_address = options.camera;
  settings.arm = options.arm;
  settings.lost_packet_ratio = options.lost_packet_ratio;
  settings.camera_ptp = !options.camera_free_clock;
  settings.time_ratio = options.time_ratio;
  settings.stay_at_end = options.stay_at_end;
  settings.monostable = Nanoseconds{std::llround(1e6 * options.monostable_ms)};
  settings.on_slower = [](double time_ratio) {
    std::fprintf(stderr,
                 "biteline-cell: the last scan's pictures came late: this one goes at %.2f of real time\n",
                 time_ratio);
  };
  settings.robot.rtde_port = options.rtde_port;
  settings.robot.script_port = options.script_port;
  settings.robot.dashboard_port = options.dashboard_port;
  settings.robot.robot_api_port = options.robot_api_port;
  settings.robot.primary_port = options.primary_port;
  if (options.controller == "cb3") settings.robot.version = {3, 15, 8};
  if (options.controller == "x") settings.robot.version = {10, 14, 0};
  settings.robot.remote_control_enabled = options.remote_control != "disabled";
  if (!options.programs.empty()) {
    BITELINE_ASSIGN(settings.robot.programs, read_programs(options.programs));
  }
  settings.robot.rate_hz = options.robot_rate_hz;
  settings.robot.speed_slider_ratio = options.speed_slider;
  settings.arm_seed = options.arm_seed;
  settings.robot.model = options.arm;
  for (char& c : settings.robot.model) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  settings.robot.clock_offset = Nanoseconds{std::llround(options.robot_clock_ms * 1e6)};
  BITELINE_ASSIGN(const auto cell, sim::LiveCell::open(settings));
  if (!cell->moved_because().empty()) {
    std::fprintf(stderr,
                 "biteline-cell: the arm does not get round the shoe at its place (%s): it stands at another "
                 "one, or the head goes higher\n",
                 cell->moved_because().c_str());
  }
  if (options.remote_control == "local") cell->robot().set_remote_control(false);
  const std::filesystem::path out(options.out);
  BITELINE_TRY(sim::write_truth(out / "truth", cell->scene()));
  BITELINE_TRY(sim::write_file(
      out / "sensor.yaml",
      config::sensor_yaml_text(cell->scene().head.model,
                               "made head " + std::to_string(scene.head_seed) + ", simulated")));
  BITELINE_TRY(sim::write_file(out / "board.yaml",
                               sim::board_yaml_text({.wires = settings.wires,
                                                     .camera = settings.camera_address,
                                                     .monostable = settings.monostable > Nanoseconds{0}})));
  if (cell->targets() != nullptr) BITELINE_TRY(write_targets(out));
  print_endpoints(*cell, options);

  wait_for_end(signals, *cell);
  BITELINE_TRY(cell->write_track(out / "track.csv"));
  BITELINE_TRY(cell->write_work(out / "truth"));
  print_counts(cell->counts());
  return {};
}

}  // namespace

void add_serve(options::Command& app, Context& context) {
  auto options = std::make_shared<ServeOptions>();
  options::Command* command = app.add_subcommand(
      "serve", "Run the cell until SIGTERM: camera, wires, pose bus and robot, all simulated");
  add_scene_options(*command, options->scene);
  add_light_options(*command, options->scene.light);
  add_way_round_options(*command, options->scene);
  add_world_options(*command, options->world);
  add_tool_options(*command, options->tool);
  add_target_options(*command, options->targets);
  command
      ->add_option("--out", options->out,
                   "Folder for board.yaml, sensor.yaml, truth/ and, at the end, track.csv")
      ->required();
  command->add_option("--wires", options->wires,
                      "Name of the simulated wires (default: made from the process number)");
  command
      ->add_option("--camera", options->camera, "Address of the GigE Vision camera; its port, 3956, is fixed")
      ->capture_default_str();
  command->add_option("--arm", options->arm, "ur3e, ur5e or ur10e")->capture_default_str();
  options::Option* straight = command->add_flag(
      "--straight-holder", options->scene.straight_holder,
      "The head hangs on the flange as published; the arm then scans as if it had no links, since "
      "none reaches all the way round");
  command
      ->add_flag("--stay-at-end", options->stay_at_end,
                 "The arm waits for scripts where the scan ends; else it goes upright above the table first")
      ->excludes(straight);
  straight->excludes(command->get_option("--scan-clockwise"));
  command->add_option("--rtde-port", options->rtde_port, "0: a free one; a real controller has 30004")
      ->capture_default_str();
  command->add_option("--script-port", options->script_port, "0: a free one; a real controller has 30002")
      ->capture_default_str();
  command
      ->add_option("--dashboard-port", options->dashboard_port, "0: a free one; a real controller has 29999")
      ->capture_default_str();
  command->add_option("--robot-api-port", options->robot_api_port, "0: a free one; a PolyScope X has 80")
      ->capture_default_str();
  command
      ->add_option("--controller", options->controller,
                   "cb3, e-series or x: a PolyScope X has the Robot API in the dashboard's place")
      ->capture_default_str()
      ->check(options::one_of({"cb3", "e-series", "x"}));
  command
      ->add_option("--remote-control", options->remote_control,
                   "on, local: it takes no programs, or disabled: it says that it is not in remote control, "
                   "and takes them")
      ->capture_default_str()
      ->check(options::one_of({"on", "local", "disabled"}));
  command->add_option("--programs", options->programs,
                      "Folder of programs, name.script each, that clients may load as name.urp or name");
  command->add_option("--primary-port", options->primary_port, "0: a free one; a real controller has 30001")
      ->default_str("0");
  command->add_option("--robot-rate-hz", options->robot_rate_hz, "500: e series, 125: CB3")
      ->capture_default_str()
      ->check(options::one_of_numbers({125, 500}));
  command
      ->add_option("--arm-seed", options->arm_seed,
                   "Of the arm's own kinematics, some 2 mm off the nominal ones, which its controller tells; "
                   "0: the nominal arm")
      ->capture_default_str();
  command
      ->add_option("--speed-slider", options->speed_slider,
                   "Where the pendant's speed slider stands: programs go at that share of their speed; the "
                   "scan's way does not")
      ->capture_default_str()
      ->check(options::number({.minimum = 0.0, .maximum = 1.0}, ""));
  command->add_option("--robot-clock-ms", options->robot_clock_ms, "Robot clock minus camera clock")
      ->check(options::number({.minimum = -1e6, .maximum = 1e6}, "ms"));
  command->add_option("--lost-packet-ratio", options->lost_packet_ratio, "Of the camera's packets")
      ->check(options::number({.minimum = 0.0, .maximum = 0.5}, ""));
  command->add_flag("--camera-free-clock", options->camera_free_clock, "The camera's clock follows no PTP");
  command
      ->add_option(
          "--time-ratio", options->time_ratio,
          "Scans go at this share of real time, arm and trigger together (default: as much of it as this "
          "machine can)")
      ->check(options::number({.minimum = 0.05, .maximum = 1}, ""));
  command
      ->add_option("--monostable-ms", options->monostable_ms,
                   "The laser goes dark so long after the sensor's last heartbeat, as on a board (60); 0: no "
                   "monostable. A late "
                   "machine then darkens scans")
      ->capture_default_str()
      ->check(options::number({.minimum = 0, .maximum = 1000}, "ms"));
  command->add_flag("--anywhere", options->anywhere,
                    "The shoe may stand where the arm's tool does not get round it");
  command->add_flag("--exit-with-parent", options->exit_with_parent,
                    "End when the process that started this one ends");
  command->callback([options, &context] { context.run = [options] { return serve(*options); }; });
}

}  // namespace biteline::cell
