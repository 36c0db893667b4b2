// SPDX-License-Identifier: MIT
// made_cell FOLDER FIRST COUNT EACH_MS [RELEASES]: the shoes FIRST to FIRST + COUNT - 1 into a memory, as the
// service puts them there. Every seventh is decided a second time.  Made time: a shoe each 20 s.  With
// RELEASES each is worked with the release in force: what its model and its process say of themselves is the
// shoe's process, and the true time of its begin its reason.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "common/system/file.hpp"
#include "host/records/memory/memory.hpp"
#include "host/records/release/shelf.hpp"

namespace {

using namespace biteline;

/// The first line of a release's file.
Result<std::string> first_line(const std::filesystem::path& file) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_settings_bytes));
  return text.substr(0, text.find_first_of("\n"));
}

/// As a scan is worked: the release is looked up once, its files are read one after the other.
Result<void> work_with_release(const std::filesystem::path& releases, std::chrono::milliseconds each,
                               memory::Scan& scan) {
  const memory::UnixMs now_ms = memory::now_ms();
  BITELINE_ASSIGN(const std::optional<release::InForce> release, release::in_force(releases, now_ms));
  scan.reason = std::to_string(now_ms);
  if (!release) return {};
  BITELINE_ASSIGN(const std::string model, first_line(release->models / "boot/process.yaml"));
  std::this_thread::sleep_for(each / 2);
  BITELINE_ASSIGN(const std::string process, first_line(release->processes / "grind.yaml"));
  scan.process = model + "/" + process;
  scan.versions = R"({"program":"made","release":")" + release->hash + R"("})";
  return {};
}

Result<void> put(memory::Memory& memory, int number, const char* decision,
                 const std::filesystem::path& releases, std::chrono::milliseconds each) {
  char name[32];
  std::snprintf(name, sizeof name, "scan-%04d", number);
  memory::Scan scan;
  scan.name = name;
  scan.time = 1'795'000'000'000 + 20'000LL * number;
  scan.model = number % 2 == 0 ? "boot" : "runner";
  scan.part = "A-" + std::to_string(number);
  scan.foot = number % 2 == 0 ? "left" : "right";
  scan.size = "EU 42";
  if (number % 5 == 1) scan.work = {.verdict = "faulty", .reworked = true, .missing_mm = 6.5, .narrow = 2};
  scan.verdict = number % 5 == 0 ? "refused" : "ok";
  scan.reason = number % 5 == 0 ? "a hole at the toe" : "";
  scan.length_mm = 800 + 0.01 * number;
  scan.cycle_s = 12.5;
  scan.decision = decision;
  if (!releases.empty()) BITELINE_TRY(work_with_release(releases, each, scan));
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

Result<void> run(char** argv, const std::filesystem::path& releases) {
  const int first = std::atoi(argv[2]);
  const int count = std::atoi(argv[3]);
  const std::chrono::milliseconds each{std::atoi(argv[4])};
  BITELINE_ASSIGN(memory::Memory memory,
                  memory::Memory::open(std::filesystem::path{argv[1]} / memory::k_memory_file));
  double longest_ms = 0;
  for (int number = first; number < first + count; ++number) {
    const auto begin = std::chrono::steady_clock::now();
    BITELINE_TRY(put(memory, number, "open", releases, each));
    if (number % 7 == 0) BITELINE_TRY(put(memory, number, "accepted", releases, each));
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    longest_ms = std::max(longest_ms, took.count());
    std::this_thread::sleep_for(each);
  }
  std::printf("%.3f\n", longest_ms);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5 && argc != 6) return 2;
  const biteline::Result<void> done = run(argv, argc == 6 ? argv[5] : "");
  if (done) return 0;
  std::fprintf(stderr, "made_cell: %s\n", biteline::to_line(done.error()).c_str());
  return 4;
}
