// SPDX-License-Identifier: MIT
// biteline-host: the service.
#include <sys/prctl.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "common/system/last_words.hpp"
#include "host/apps/biteline-host/backup.hpp"
#include "host/apps/biteline-host/options.hpp"
#include "host/apps/biteline-host/service.hpp"

namespace {

using namespace biteline;

std::atomic<bool> g_stop{false};
robot::Stops g_stops;
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

void heed_stop_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) {
    g_stops.stop();
    g_stop = true;
  };
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

Result<ExitStatus> save_or_restore(const service::Options& options) {
  const service::BackupPlaces places{.results = options.out, .library = options.library};
  const bool saves = !options.backup.empty();
  const std::filesystem::path& file = saves ? options.backup : options.restore;
  BITELINE_ASSIGN(const service::BackupCounts counts,
                  saves ? service::write_backup(places, file) : service::restore_backup(places, file));
  std::printf("%s %s: memory, %zu models, %zu processes\n", saves ? "wrote" : "restored", file.c_str(),
              counts.models, counts.processes);
  return ExitStatus::Done;
}

Result<ExitStatus> run(const service::Options& options) {
  if (!options.backup.empty() || !options.restore.empty()) return save_or_restore(options);
  if (options.exit_with_parent) prctl(PR_SET_PDEATHSIG, SIGTERM);
  BITELINE_TRY(memory::use_time_zone(options.time_zone));
  BITELINE_ASSIGN(service::Service host, service::Service::create(options, g_stops));
  return host.run(g_stop);
}

}  // namespace

int main(int argc, char** argv) {
  biteline::install_last_words("biteline-host");
  heed_stop_signals();
  try {
    const service::ParsedOptions parsed = service::parse_options(argc, argv);
    if (parsed.leave_with) return *parsed.leave_with;
    const Result<ExitStatus> status = run(parsed.options);
    if (status) return static_cast<int>(*status);
    std::fprintf(stderr, "biteline-host: %s\n", to_line(status.error()).c_str());
    return static_cast<int>(error_row(status.error().code).exit_status);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "biteline-host: out of memory: raise the limit or free some, then start again\n");
    return static_cast<int>(biteline::ExitStatus::Connection);
  } catch (const std::exception& error) {
    // No exception is meant to arrive here; should one do so, the operator still gets one line.
    std::fprintf(stderr, "biteline-host: internal failure: %s\n", error.what());
    return static_cast<int>(ExitStatus::Connection);
  }
}
