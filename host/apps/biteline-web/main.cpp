// SPDX-License-Identifier: MIT
// biteline-web: the page and the API of a cell.
#include <sys/prctl.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <thread>

#include "common/system/last_words.hpp"
#include "host/apps/biteline-web/options.hpp"
#include "host/apps/biteline-web/sensor_watch.hpp"
#include "host/interfaces/accounts/metrics_token.hpp"

namespace {

using namespace biteline;

Result<std::unique_ptr<web::ServiceDoor>> open_door(const web::WebOptions& options, const char* name) {
  if (!options.control) return web::closed_service_door();
  control::ClientConfig config{.endpoint = *options.control, .keys = {}, .door = name};
  if (options.control_keys) {
    BITELINE_ASSIGN(config.keys, wire::read_host_keys(*options.control_keys));
  }
  return web::open_service_door(config);
}

/// The doors of the line's control, where they are asked for.
Result<std::unique_ptr<web::LineDoors>> open_line_doors(const web::WebOptions& options) {
  if (!options.line.modbus && !options.line.text) return std::unique_ptr<web::LineDoors>{};
  BITELINE_ASSIGN(auto door, open_door(options, "line"));
  BITELINE_ASSIGN(auto doors, web::LineDoors::open(options.line, std::move(door)));
  const auto say = [](const char* name, const std::optional<web::LineListener>& at, std::uint16_t port) {
    if (!at) return;
    std::printf("biteline-web: %s without login at %s port %u\n", name, at->address.c_str(), unsigned{port});
  };
  say("Modbus TCP", options.line.modbus, doors->modbus_port());
  say("text", options.line.text, doors->text_port());
  return doors;
}

/// Waits for SIGTERM or SIGINT on a thread of its own: no handler runs in the middle of anything.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGTERM);
    sigaddset(&set_, SIGINT);
    // Before any thread is made: all of them leave these signals to the one that waits.
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
  }
  void wait() const {
    int signal = 0;
    sigwait(&set_, &signal);
  }

 private:
  sigset_t set_{};
};

Result<void> run(const web::WebOptions& options, const StopSignals& signals) {
  if (options.add_user) {
    BITELINE_ASSIGN(const std::string password, web::read_password(stdin));
    return web::add_user(*options.add_user, password);
  }
  if (options.drop_metrics_token) return accounts::drop_metrics_token(options.accounts);
  if (!options.metrics_token.empty())
    return accounts::use_metrics_token(options.accounts, options.metrics_token);
  if (options.exit_with_parent) prctl(PR_SET_PDEATHSIG, SIGTERM);
  web::SensorWatchConfig watched{.sensor = options.sensor, .keys = {}};
  if (options.sensor_keys) {
    BITELINE_ASSIGN(watched.keys, wire::read_host_keys(*options.sensor_keys));
  }
  BITELINE_ASSIGN(auto door, open_door(options, "web"));
  BITELINE_ASSIGN(const auto line_doors, open_line_doors(options));
  std::unique_ptr<web::SensorWatch> watch;
  BITELINE_ASSIGN(const auto server, web::WebServer::open(options.server, std::move(door),
                                                          [&watch](const control::Event& event) {
                                                            if (watch) watch->hear(event);
                                                          }));
  watch = std::make_unique<web::SensorWatch>(
      watched,
      web::LiveSink{.publish = [&server](web::LiveKind kind,
                                         web::LiveBytes bytes) { server->publish(kind, std::move(bytes)); },
                    .forget_scan = [&server] { server->forget_scan(); },
                    .watchers = [&server] { return server->watchers(); }});
  std::printf("biteline-web: %s\n", server->address().c_str());
  std::fflush(stdout);
  std::thread stopper{[&] {
    signals.wait();
    server->stop();
  }};
  server->run();
  stopper.join();
  watch.reset();
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  biteline::install_last_words("biteline-web");
  const StopSignals signals;
  try {
    const web::ParsedWebOptions parsed = web::parse_web_options(argc, argv);
    if (parsed.leave_with) return *parsed.leave_with;
    const Result<void> done = run(parsed.options, signals);
    if (done) return static_cast<int>(ExitStatus::Done);
    std::fprintf(stderr, "biteline-web: %s\n", to_line(done.error()).c_str());
    return static_cast<int>(error_row(done.error().code).exit_status);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "biteline-web: out of memory: raise the limit or free some, then start again\n");
    return static_cast<int>(ExitStatus::Connection);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "biteline-web: internal failure: %s\n", error.what());
    return static_cast<int>(ExitStatus::Connection);
  }
}
