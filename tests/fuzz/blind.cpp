// SPDX-License-Identifier: MIT
// A fuzz target without libFuzzer: TARGET SEEDS CASES [SEED] takes good inputs from a folder, makes so many
// bad ones of them and ends at the first that breaks something.  Its bytes are then in TARGET-case.  Each
// case has 20 seconds.
#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "tests/fuzz/mutate.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

std::string current;
std::string kept_as;

/// Only what a signal handler may call.
void keep_case(int number) {
  const int file = ::open(kept_as.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file >= 0 && ::write(file, current.data(), current.size()) >= 0) ::close(file);
  constexpr std::string_view k_told = "a case broke something or took 20 s; it is kept beside the program\n";
  (void)!::write(2, k_told.data(), k_told.size());
  std::signal(number, SIG_DFL);
  (void)std::raise(number);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  std::vector<std::string> seeds;
  if (std::filesystem::is_directory(argv[1])) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) files.push_back(entry.path());
    std::ranges::sort(files);
    for (const auto& file : files) {
      std::ifstream in(file, std::ios::binary);
      seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
  }
  if (seeds.empty()) {
    std::fprintf(stderr, "%s: no good inputs in %s\n", argv[0], argv[1]);
    return 2;
  }
  kept_as = std::string{argv[0]} + "-case";
  for (const int number : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGALRM}) std::signal(number, keep_case);
  biteline::fuzz::Mutator mutator{argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1};
  const unsigned long long cases = std::strtoull(argv[2], nullptr, 10);
  for (unsigned long long i = 0; i < cases; ++i) {
    const std::string& good = seeds[mutator.below(seeds.size())];
    // The good ones first: a target that refuses them tries nothing.
    current = i < seeds.size() ? seeds[i] : mutator.mutated(good, seeds[mutator.below(seeds.size())]);
    ::alarm(20);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(current.data()), current.size());
  }
  ::alarm(0);
  std::printf("%llu cases from %zu good inputs\n", cases, seeds.size());
  return cases == 0 ? 1 : 0;
}
