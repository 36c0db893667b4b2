// SPDX-License-Identifier: MIT
#include "tests/soak/stand.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/config/sensor_yaml.hpp"
#include "common/settings/settings.hpp"
#include "hal/sim/bus/board_file.hpp"
#include "hal/sim/record/files.hpp"
#include "tests/support/json.hpp"

namespace biteline::soak {
namespace {

namespace fs = std::filesystem;
using intake::ChildProcess;
using namespace std::chrono_literals;

constexpr const char* k_arm = "ur5e";
constexpr auto k_start_patience = 60s;

/// Parts of the line with work of their own; one is left out, so the tool lifts and comes down again.
constexpr const char* k_zones = R"(
zones:
  - {name: heel, where: heel, outward_by_mm: 0.2, speed_ratio: 0.9}
  - {name: buckle, where: stretch, from_percent: 30, to_percent: 36, work: left_out}
)";

/// Grinding that takes what a quick, coarse scan is good to, and is quick itself.
Result<std::string> process_text() {
  std::ifstream stream{fs::path{BITELINE_PROCESSES} / "grind.yaml"};
  std::string text{std::istreambuf_iterator<char>{stream}, {}};
  for (const auto& [asked, instead] : {std::pair{"tolerance_mm: 1 ", "tolerance_mm: 20 "},
                                       std::pair{"\n  speed_mm_s: 60\n", "\n  speed_mm_s: 120\n"}}) {
    const std::size_t at = text.find(asked);
    if (at == std::string::npos) return fail(Errc::BadValue, "grind.yaml has no '%s'", asked);
    text.replace(at, std::string_view{asked}.size(), instead);
  }
  return text + k_zones;
}

/// Of loopback; free a moment ago.
std::uint16_t free_port() {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  const bool bound = ::bind(fd, reinterpret_cast<const sockaddr*>(&address), length) == 0 &&
                     ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &length) == 0;
  ::close(fd);
  return bound ? ntohs(address.sin_port) : std::uint16_t{0};
}

std::string loopback(std::uint16_t port) {
  return "127.0.0.1:" + std::to_string(port);
}

HostWord word_of(std::string line) {
  HostWord word{.line = std::move(line), .scan = {}};
  const std::string found = "found ";
  if (word.line == "asks for a scan") {
    word.kind = HostWord::Kind::Asks;
  } else if (word.line.starts_with("takes in scan ")) {
    word.kind = HostWord::Kind::TakesIn;
    word.scan = word.line.substr(word.line.rfind('/') + 1);
  } else if (word.line.starts_with(found) && word.line.find(" unfinished, ") != std::string::npos) {
    word.kind = HostWord::Kind::Found;
    word.scan = word.line.substr(found.size(), word.line.find(' ', found.size()) - found.size());
  } else if (word.line.starts_with("sends the path to ")) {
    word.kind = HostWord::Kind::Sends;
  }
  return word;
}

}  // namespace

double resident_mb(int pid) {
  std::ifstream stream{"/proc/" + std::to_string(pid) + "/statm"};
  double all_pages = 0, resident_pages = 0;
  if (!(stream >> all_pages >> resident_pages)) return 0;
  return resident_pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

Result<std::unique_ptr<Stand>> Stand::open(const StandSettings& settings) {
  std::unique_ptr<Stand> stand{new Stand{settings}};
  sim::LiveSettings live;
  live.scene = {.shoe = sim::draw_shoe(sim::ShoeClass::Deep, settings.seed),
                .place_seed = settings.seed,
                .places = sim::places_within_reach_of(k_arm),
                .holder = sim::Holder::Bracket,
                .scan_speed_mm_s = 100,
                .rate_hz = 50};
  live.wires = "biteline-soak-" + std::to_string(::getpid());
  live.arm = k_arm;
  live.arm_seed = settings.seed;
  live.keep_track = false;
  live.robot.model = "UR5E";
  live.monostable = std::chrono::milliseconds{60};
  BITELINE_ASSIGN(stand->cell_, sim::LiveCell::open(live));
  BITELINE_ASSIGN(stand->between_, ControllerBetween::open(stand->cell_->robot_ports()));
  BITELINE_TRY(stand->write_files());
  BITELINE_TRY(Page::make_viewer(BITELINE_PROGRAMS, stand->results()));
  BITELINE_TRY(stand->start_sensor());
  stand->control_ = "tcp://" + loopback(free_port());
  BITELINE_TRY(stand->start_host());
  stand->page_ = std::make_unique<Page>(BITELINE_PROGRAMS, stand->control_, stand->endpoint_);
  BITELINE_TRY(stand->page_->start());
  return stand;
}

Result<void> Stand::write_files() const {
  const fs::path& out = settings_.out;
  std::error_code error;
  fs::create_directories(results(), error);
  const sim::LiveSettings& live = cell_->settings();
  BITELINE_TRY(
      sim::write_file(out / "sensor.yaml",
                      config::sensor_yaml_text(cell_->scene().head.model, "made for a soak run, simulated")));
  BITELINE_TRY(sim::write_file(
      out / "board.yaml",
      sim::board_yaml_text({.wires = live.wires, .camera = live.camera_address, .monostable = true})));
  settings::SettingsSet set;
  set.set(settings::Key::RateHz, {.number = live.scene.rate_hz});
  BITELINE_TRY(sim::write_file(out / "settings.yaml", settings::settings_text(set)));
  BITELINE_ASSIGN(const std::string process, process_text());
  return sim::write_file(out / "process.yaml", process);
}

Result<void> Stand::start_sensor() {
  std::vector<std::string> arguments{"--source",
                                     "board:" + (settings_.out / "board.yaml").string(),
                                     "--sensor",
                                     (settings_.out / "sensor.yaml").string(),
                                     "--listen",
                                     endpoint_,
                                     "--settings",
                                     (settings_.out / "settings.yaml").string(),
                                     "--exit-with-parent",
                                     "--rt",
                                     "required"};
  for (const char* rights : {"required", "ignore"}) {
    arguments.back() = rights;
    BITELINE_ASSIGN(ChildProcess child,
                    ChildProcess::start({.program = fs::path{BITELINE_PROGRAMS} / "biteline-sensor",
                                         .arguments = arguments,
                                         .pass_stderr = settings_.verbose}));
    const Result<std::string> line = child.next_line(k_start_patience);
    if (!line) {
      if (std::string{rights} == "required") continue;  // no such rights here
      return tl::unexpected<Error>{line.error()};
    }
    const auto told = test::read_json(*line);
    endpoint_ = told.is_object() ? told.value("endpoint", endpoint_) : endpoint_;
    sensor_.emplace(std::move(child));
    return {};
  }
  return {};
}

Result<void> Stand::start_host() {
  // What an integrator measures in his cell.
  const sim::LiveCell::Stand measured = cell_->stand();
  BITELINE_ASSIGN(ChildProcess child,
                  ChildProcess::start({.program = fs::path{BITELINE_PROGRAMS} / "biteline-host",
                                       .arguments = {"--sensor",
                                                     endpoint_,
                                                     "--out",
                                                     results().string(),
                                                     "--robot",
                                                     k_arm,
                                                     "--process",
                                                     (settings_.out / "process.yaml").string(),
                                                     "--table-z",
                                                     std::to_string(measured.table_z_mm),
                                                     "--fixture-z",
                                                     std::to_string(measured.fixture_z_mm),
                                                     "--fixture-beyond",
                                                     std::to_string(measured.fixture_beyond_mm),
                                                     "--rtde",
                                                     loopback(between_->rtde_port()),
                                                     "--script",
                                                     loopback(between_->script_port()),
                                                     "--dashboard",
                                                     loopback(between_->dashboard_port()),
                                                     "--control",
                                                     control_,
                                                     "--send",
                                                     "--exit-with-parent"},
                                       .pass_stderr = settings_.verbose}));
  host_.emplace(std::move(child));
  return {};
}

Result<int> Stand::revive() {
  int revived = 0;
  if (!sensor_->running()) {
    BITELINE_TRY(start_sensor());
    ++revived;
  }
  if (!host_->running()) {
    BITELINE_TRY(start_host());
    ++revived;
  }
  if (!page_->program().running()) {
    BITELINE_TRY(page_->start());
    ++revived;
  }
  return revived;
}

std::optional<HostWord> Stand::hear_host(std::chrono::milliseconds patience) {
  Result<std::string> line = host_->next_line(patience);
  if (!line) {
    // An ended program answers at once.
    if (line.error().code == Errc::ProcessDied) ::usleep(10'000);
    return std::nullopt;
  }
  if (settings_.verbose) std::printf("    host: %s\n", line->c_str());
  return word_of(std::move(*line));
}

std::vector<HostWord> Stand::last_host_words() {
  std::vector<HostWord> words;
  while (Result<std::string> line = host_->next_line(0ms)) {
    if (std::optional<HostWord> word = word_of(std::move(*line))) words.push_back(std::move(*word));
  }
  return words;
}

}  // namespace biteline::soak
