// SPDX-License-Identifier: MIT
// made_cell FOLDER FIRST COUNT EACH_MS: the shoes FIRST to FIRST + COUNT - 1 into a memory, as the service
// puts them there. Every seventh is decided a second time.  Made time: a shoe each 20 s.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "host/records/memory/memory.hpp"

namespace {

using namespace biteline;

Result<void> put(memory::Memory& memory, int number, const char* decision) {
  char name[32];
  std::snprintf(name, sizeof name, "scan-%04d", number);
  memory::Scan scan;
  scan.name = name;
  scan.time = 1'795'000'000'000 + 20'000LL * number;
  scan.model = number % 2 == 0 ? "boot" : "runner";
  scan.verdict = number % 5 == 0 ? "refused" : "ok";
  scan.reason = number % 5 == 0 ? "a hole at the toe" : "";
  scan.length_mm = 800 + 0.01 * number;
  scan.cycle_s = 12.5;
  scan.decision = decision;
  memory::Places places{};
  places.fill(0.001F * static_cast<float>(number));
  return memory.put_scan(scan,
                         {.id = 0,
                          .time = scan.time,
                          .who = "service",
                          .door = {},
                          .action = "result",
                          .subject = scan.name,
                          .before = {},
                          .after = scan.verdict},
                         places);
}

Result<void> run(char** argv) {
  const int first = std::atoi(argv[2]);
  const int count = std::atoi(argv[3]);
  const std::chrono::milliseconds each{std::atoi(argv[4])};
  BITELINE_ASSIGN(memory::Memory memory,
                  memory::Memory::open(std::filesystem::path{argv[1]} / memory::k_memory_file));
  double longest_ms = 0;
  for (int number = first; number < first + count; ++number) {
    const auto begin = std::chrono::steady_clock::now();
    BITELINE_TRY(put(memory, number, "open"));
    if (number % 7 == 0) BITELINE_TRY(put(memory, number, "accepted"));
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    longest_ms = std::max(longest_ms, took.count());
    std::this_thread::sleep_for(each);
  }
  std::printf("%.3f\n", longest_ms);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  const biteline::Result<void> done = run(argv);
  if (done) return 0;
  std::fprintf(stderr, "made_cell: %s\n", biteline::to_line(done.error()).c_str());
  return 4;
}
