// SPDX-License-Identifier: MIT
#include "host/fleet/program.hpp"

#include <csignal>
#include <cstdio>
#include <exception>

#include "common/system/last_words.hpp"

namespace biteline::fleet {
namespace {

std::atomic<bool> g_stop{false};

}  // namespace

const std::atomic<bool>& told_to_stop() {
  return g_stop;
}

int log_error(const char* program, const std::string& line, ExitStatus status) {
  std::fprintf(stderr, "%s: %s\n", program, line.c_str());
  return static_cast<int>(status);
}

int run_until_told(const char* program, int argc, char** argv, int (*run)(int, char**)) {
  install_last_words(program);
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = true; };
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGINT, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    return log_error(program, std::string{"internal failure: "} + error.what(), ExitStatus::Connection);
  }
}

}  // namespace biteline::fleet
