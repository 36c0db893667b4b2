// SPDX-License-Identifier: MIT
// biteline_soak: cell, sensor and host service for minutes or hours, with faults of both tables at random.
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <random>

#include "common/options/command.hpp"
#include "tests/soak/soak.hpp"

namespace {

namespace fs = std::filesystem;
using namespace biteline;

constexpr int k_wrong = 3;  // as a refusal

int run(const soak::SoakSettings& settings, const soak::StandSettings& place) {
  std::printf("soak of %.3g minutes, seed %llu (--seed repeats its faults)\n", settings.minutes,
              static_cast<unsigned long long>(settings.seed));
  std::fflush(stdout);
  auto stand = soak::Stand::open(place);
  if (!stand) {
    std::fprintf(stderr, "biteline_soak: %s\n", to_line(stand.error()).c_str());
    return static_cast<int>(error_row(stand.error().code).exit_status);
  }
  soak::Soak soak{**stand, settings};
  soak.run();
  soak.print_tables();
  for (const std::string& wrong : soak.wrong()) std::printf("WRONG %s\n", wrong.c_str());
  std::printf(soak.wrong().empty() ? "the books are even\n" : "the books are not even\n");
  return soak.wrong().empty() ? 0 : k_wrong;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  options::Command app{
      "The whole cell with faults at random, and the books of every scan.  Exit 0: even, 3: not.",
      "biteline_soak"};
  soak::SoakSettings settings{.minutes = 2, .seed = std::random_device{}()};
  // A folder of its own: two runs beside each other would exchange their boards.
  soak::StandSettings place{.out =
                                fs::temp_directory_path() / ("biteline-soak-" + std::to_string(::getpid()))};
  app.add_option("minutes", settings.minutes, "How long")
      ->check(options::number({.minimum = 0.1, .maximum = 1e4}, "minutes"))
      ->capture_default_str();
  app.add_option("--seed", settings.seed, "Of the faults and of the shoe; default: another each time");
  app.add_option("--out", place.out, "Folder of what did not come out even; emptied first")
      ->capture_default_str();
  app.add_flag("--verbose", place.verbose, "Show what the programs say");
  if (const std::optional<options::Leave> leave = app.parse(argc, argv)) {
    if (leave->fault.empty()) return 0;
    std::fprintf(stderr, "biteline_soak: %s (see --help)\n", leave->fault.c_str());
    return static_cast<int>(ExitStatus::BadInput);
  }
  std::error_code error;
  fs::remove_all(place.out, error);
  place.seed = 1 + settings.seed % 1000;
  return run(settings, place);
}
