// SPDX-License-Identifier: MIT
// bench_live_view [SECONDS [ROUNDS]]: sensor, service and web program with twenty clients on the live view
// and without any, in turns of one run: the sensor's stages, the service's answers and results, the processor
// time of each, and how late a profile comes to a client.  One client decodes pictures as a page does, one is
// slow.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>

#include "common/wire/observer.hpp"
#include "host/intake/sensor_process.hpp"
#include "tests/bench/web/watchers.hpp"
#include "tests/support/picture_cell/picture_cell.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/web_client.hpp"

namespace biteline::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds k_patience{60};
constexpr int k_clients = 20;

/// Of a process, user and system (proc(5), stat, fields 14 and 15).
double processor_s(int pid) {
  std::ifstream stat{"/proc/" + std::to_string(pid) + "/stat"};
  std::string text{std::istreambuf_iterator<char>{stat}, {}};
  text.erase(0, text.rfind(')') + 1);  // the name may hold blanks
  std::istringstream fields{text};
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

double ms_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

/// Sums over all rounds of one kind.
struct Times {
  std::map<std::string, std::vector<double>> stages_ms;  ///< the sensor's, a scan's means
  std::vector<double> result_ms, answer_ms;
  double sensor_s{0}, host_s{0}, web_s{0}, wall_s{0};
  std::uint64_t lost{0};
};

/// The three programs on a cell of ready-made pictures.
class Cell {
 public:
  Result<void> begin() {
    BITELINE_ASSIGN(cell_, test::PictureCell::open({.width_px = 1626, .height_px = 320, .rate_hz = 100}));
    const std::string board = folder_.write("board.yaml", cell_->board_file_text());
    const std::string head = folder_.write("sensor.yaml", cell_->sensor_file_text());
    BITELINE_ASSIGN(const auto program, intake::find_sensor_program());
    std::vector<std::string> arguments{"--source", "board:" + board, "--sensor", head, "--rt=required"};
    auto sensor = intake::SensorProcess::start(program, arguments, k_patience);
    if (!sensor) {
      arguments.back() = "--rt=ignore";
      sensor = intake::SensorProcess::start(program, arguments, k_patience);
    }
    if (!sensor) return tl::unexpected<Error>{sensor.error()};
    sensor_.emplace(std::move(*sensor));
    wire::ObserverConfig watched{.sensor = sensor_->endpoint(), .keys = {}, .wish = {}};
    watched.wish.name = "bench";
    BITELINE_ASSIGN(observer_, wire::Observer::open(watched));
    const std::filesystem::path programs = program.parent_path();
    const std::string sensor_at = sensor_->endpoint().text();
    BITELINE_ASSIGN(auto host, intake::ChildProcess::start(
                                   {.program = programs / "biteline-host",
                                    .arguments = {"--sensor", sensor_at, "--out", folder_.path() / "results",
                                                  "--control", "tcp://127.0.0.1:0", "--exit-with-parent"}}));
    host_.emplace(std::move(host));
    BITELINE_ASSIGN(const std::string control, word_behind(*host_, "doors come in at "));
    BITELINE_ASSIGN(
        auto web, intake::ChildProcess::start({.program = programs / "biteline-web",
                                               .arguments = {"--listen", "127.0.0.1:0", "--control", control,
                                                             "--sensor", sensor_at, "--exit-with-parent"}}));
    web_.emplace(std::move(web));
    BITELINE_ASSIGN(const std::string address, word_behind(*web_, "biteline-web: "));
    port_ = static_cast<std::uint16_t>(std::atoi(address.substr(address.rfind(':') + 1).c_str()));
    return log_in();
  }

  /// One scan of `duration`, watched by `clients`.
  Result<void> scan(seconds duration, std::vector<std::unique_ptr<Watcher>>& clients, int wanted,
                    Times& times) {
    // The first one the service asks for by itself.
    if (std::exchange(scanned_, true)) static_cast<void>(ask("POST", "/commands/start", "{}"));
    BITELINE_TRY(wait_for([this] { return ask("GET", "/state")["phase"] == "scanning"; }, "no scan began"));
    for (int i = 0; i < wanted; ++i) {
      const Reading reading = i == 0 ? Reading::Page : i == 1 ? Reading::Slow : Reading::All;
      clients.push_back(std::make_unique<Watcher>(port_, token_, reading));
    }
    const std::string name = ask("GET", "/state").value("scan", "");
    std::this_thread::sleep_for(seconds{1});
    const double sensor_s = processor_s(sensor_->child().pid()), host_s = processor_s(host_->pid()),
                 web_s = processor_s(web_->pid());
    const Clock::time_point begin = Clock::now();
    while (Clock::now() - begin < duration) {
      const Clock::time_point asked = Clock::now();
      static_cast<void>(ask("GET", "/state"));
      times.answer_ms.push_back(ms_since(asked));
      std::this_thread::sleep_for(milliseconds{100});
    }
    times.wall_s += 1e-3 * ms_since(begin);
    times.sensor_s += processor_s(sensor_->child().pid()) - sensor_s;
    times.host_s += processor_s(host_->pid()) - host_s;
    times.web_s += processor_s(web_->pid()) - web_s;
    static_cast<void>(ask("POST", "/commands/stop", "{}"));
    BITELINE_TRY(take_end(times));
    const Clock::time_point ended = Clock::now();
    BITELINE_TRY(
        wait_for([&] { return ask("GET", "/scans/" + name).value("verdict", "working") != "working"; },
                 "the scan's row never came"));
    times.result_ms.push_back(ms_since(ended));
    for (const auto& client : clients) client->stop();
    return {};
  }

 private:
  static Result<std::string> word_behind(intake::ChildProcess& child, const std::string& words) {
    for (;;) {
      BITELINE_ASSIGN(const std::string line, child.next_line(k_patience));
      if (const std::size_t at = line.find(words); at != std::string::npos)
        return line.substr(at + words.size());
    }
  }
  Json ask(const std::string& method, const std::string& path, const std::string& body = "") {
    const std::string headers = token_.empty() ? "" : "Authorization: Bearer " + token_ + "\r\n";
    const test::WebReply reply = test::WebClient{port_}.ask(method, "/api/v1" + path, headers, body);
    Json json = Json::parse(reply.body, nullptr, false);
    return json.is_object() ? json : Json::object();
  }
  Result<void> log_in() {
    // The service may not have answered the web program's first call yet.
    BITELINE_TRY(wait_for(
        [this] {
          return ask("POST", "/users",
                     R"({"name":"ada","role":"administrator","password":"a long password"})")
              .contains("name");
        },
        "no account could be made"));
    token_ = ask("POST", "/sessions", R"({"name":"ada","password":"a long password"})").value("token", "");
    static_cast<void>(ask("POST", "/control", R"({"action":"take"})"));
    return token_.empty() ? fail(Errc::AuthenticationFailed, "no session") : Result<void>{};
  }
  template <class Done>
  static Result<void> wait_for(Done&& done, const char* else_words) {
    const Clock::time_point give_up = Clock::now() + k_patience;
    while (!done()) {
      if (Clock::now() > give_up) return fail(Errc::Timeout, "%s", else_words);
      std::this_thread::sleep_for(milliseconds{5});
    }
    return {};
  }
  /// The scan's end with its stages' times, as the sensor tells them.
  Result<void> take_end(Times& times) {
    const Clock::time_point give_up = Clock::now() + k_patience;
    while (Clock::now() < give_up) {
      BITELINE_ASSIGN(const auto message, observer_->next(milliseconds{50}));
      if (!message) continue;
      const auto* end = std::get_if<wire::EndOfScan>(&message->body);
      if (end == nullptr) continue;
      for (const wire::StageTime& stage : end->stages)
        times.stages_ms[stage.name].push_back(1e-6 * static_cast<double>(stage.mean.count()));
      times.lost += end->counters.frames_lost + end->counters.profiles_dropped + end->counters.messages_lost;
      return {};
    }
    return fail(Errc::Timeout, "the scan's end never came");
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<test::PictureCell> cell_;
  std::optional<intake::SensorProcess> sensor_;
  std::unique_ptr<wire::Observer> observer_;
  std::optional<intake::ChildProcess> host_, web_;
  std::uint16_t port_{0};
  std::string token_;
  bool scanned_{false};
};

void row(const char* what, double ours, const char* unit, double without) {
  std::printf(
      "{\"bench\":\"web.live_view\",\"what\":\"%s\",\"ours\":%.4g,\"unit\":\"%s\",\"peer\":\"without "
      "clients\",\"peer_value\":%.4g,\"ratio\":%.4g}\n",
      what, ours, unit, without, without > 0 ? ours / without : 0);
}
void row(const char* what, double ours, const char* unit) {
  std::printf("{\"bench\":\"web.live_view\",\"what\":\"%s\",\"ours\":%.4g,\"unit\":\"%s\"}\n", what, ours,
              unit);
}

struct Seen {
  std::vector<double> late_ms;
  std::uint64_t least_pictures{~std::uint64_t{0}}, least_profiles{~std::uint64_t{0}}, slow_pictures{0};
  int older{0}, broken{0}, away{0};

  void add(const std::vector<std::unique_ptr<Watcher>>& clients) {
    for (std::size_t i = 0; i < clients.size(); ++i) {
      const Watcher& one = *clients[i];
      older += one.older;
      broken += one.broken;
      away += one.connected ? 0 : 1;
      if (i == 1) {
        slow_pictures += one.pictures;
        continue;
      }
      least_pictures = std::min(least_pictures, one.pictures);
      least_profiles = std::min(least_profiles, one.profiles);
      late_ms.insert(late_ms.end(), one.late_ms.begin(), one.late_ms.end());
    }
  }
};

Result<bool> bench(seconds duration, int rounds) {
  Cell cell;
  BITELINE_TRY(cell.begin());
  Times alone, watched;
  Seen seen;
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::unique_ptr<Watcher>> nobody, clients;
    BITELINE_TRY(cell.scan(duration, nobody, 0, alone));
    BITELINE_TRY(cell.scan(duration, clients, k_clients, watched));
    seen.add(clients);
  }
  for (const auto& [name, values_ms] : watched.stages_ms) {
    row(("sensor's stage '" + name + "', mean").c_str(), quantile(values_ms, 0.5), "ms",
        quantile(alone.stages_ms[name], 0.5));
  }
  row("end of a scan to its row, median", quantile(watched.result_ms, 0.5), "ms",
      quantile(alone.result_ms, 0.5));
  row("the service's answer to GET state, median", quantile(watched.answer_ms, 0.5), "ms",
      quantile(alone.answer_ms, 0.5));
  row("the service's answer to GET state, 99 of 100", quantile(watched.answer_ms, 0.99), "ms",
      quantile(alone.answer_ms, 0.99));
  row("processor time of the sensor", watched.sensor_s / watched.wall_s, "s/s",
      alone.sensor_s / alone.wall_s);
  row("processor time of the service", watched.host_s / watched.wall_s, "s/s", alone.host_s / alone.wall_s);
  row("processor time of the web program", watched.web_s / watched.wall_s, "s/s", alone.web_s / alone.wall_s);
  row("frames, profiles and messages lost", static_cast<double>(watched.lost), "1",
      static_cast<double>(alone.lost));
  row("a profile from mid-exposure to a client, median", quantile(seen.late_ms, 0.5), "ms");
  row("a profile from mid-exposure to a client, 99 of 100", quantile(seen.late_ms, 0.99), "ms");
  row("profiles that each client got at least, a scan", static_cast<double>(seen.least_profiles), "1");
  row("pictures that each client got at least, a scan", static_cast<double>(seen.least_pictures), "1");
  row("pictures that the slow client got, a scan", static_cast<double>(seen.slow_pictures) / rounds, "1");
  row("messages older than the one before", seen.older, "1");
  row("pictures that cannot be decoded", seen.broken, "1");
  return seen.older == 0 && seen.broken == 0 && seen.away == 0;
}

}  // namespace
}  // namespace biteline::bench

int main(int argc, char** argv) {
  const std::chrono::seconds duration{argc > 1 ? std::max(1, std::atoi(argv[1])) : 8};
  const biteline::Result<bool> done =
      biteline::bench::bench(duration, argc > 2 ? std::max(1, std::atoi(argv[2])) : 3);
  if (!done) {
    std::fprintf(stderr, "bench_live_view: %s\n", biteline::to_line(done.error()).c_str());
    return done.error().code == biteline::Errc::ConnectFailed ? 77 : 1;
  }
  return *done ? 0 : 1;
}
