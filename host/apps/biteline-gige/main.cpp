// SPDX-License-Identifier: MIT
// biteline-gige: a sensor's profiles for software that speaks GenICam.
#include <sys/prctl.h>

#include <csignal>
#include <cstdio>
#include <exception>

#include "common/system/last_words.hpp"
#include "host/apps/biteline-gige/options.hpp"

namespace {

using namespace biteline;

std::atomic<bool> g_stop{false};

int log_error(const std::string& line, ExitStatus status) {
  std::fprintf(stderr, "biteline-gige: %s\n", line.c_str());
  return static_cast<int>(status);
}

Result<void> keep_off_cameras(const gige::Interface& interface) {
  BITELINE_ASSIGN(const std::vector<std::uint32_t> devices, gige::devices_on(interface));
  if (devices.empty()) return {};
  return fail(
      Errc::InvalidArgument,
      "a GigE Vision device answers at %s on %s: the camera's own interface is not for this; where it "
      "is another device, tell the camera's address by --camera",
      gige::address_text(devices.front()).c_str(), interface.name.c_str());
}

Result<void> run(const gige::Options& options) {
  if (options.exit_with_parent) prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (options.ask_for_cameras) BITELINE_TRY(keep_off_cameras(options.server.interface));
  BITELINE_ASSIGN(const auto server, gige::Server::open(options.server));
  std::printf("biteline-gige: GigE Vision device at %s%s\n",
              gige::address_text(options.server.interface.address).c_str(),
              options.feed.allow_control ? ", a client may start scans" : "");
  std::fflush(stdout);
  gige::Feed feed{options.feed, *server,
                  [](const std::string& line) { std::fprintf(stderr, "biteline-gige: %s\n", line.c_str()); }};
  feed.run(g_stop);
  const gige::ServerCounts counts = server->counts();
  std::printf(
      "biteline-gige: %llu frames, %llu packets, %llu asked for again, %llu of them no longer kept, %llu not "
      "taken by the network, %llu pictures of another form left out\n",
      static_cast<unsigned long long>(counts.stream.frames),
      static_cast<unsigned long long>(counts.stream.packets),
      static_cast<unsigned long long>(counts.stream.resent),
      static_cast<unsigned long long>(counts.stream.unavailable),
      static_cast<unsigned long long>(counts.unsent_again),
      static_cast<unsigned long long>(counts.pictures_left_out));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  biteline::install_last_words("biteline-gige");
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = true; };
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    const gige::ParsedOptions parsed = gige::parse_options(argc, argv);
    if (parsed.leave_with) return *parsed.leave_with;
    const Result<void> done = run(parsed.options);
    if (done) return static_cast<int>(ExitStatus::Done);
    return log_error(to_line(done.error()), error_row(done.error().code).exit_status);
  } catch (const std::exception& error) {
    return log_error(std::string{"internal failure: "} + error.what(), ExitStatus::Connection);
  }
}
