// SPDX-License-Identifier: MIT
#include "tests/bench/line/sweep_options.hpp"

#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <sstream>

namespace biteline::bench {

void SweepOptions::add_to(options::Command& command) {
  command.add_option("--count", count, "so many cells")->capture_default_str();
  command.add_option("--seed", seed, "of the sweep")->capture_default_str();
  command.add_option("--from", from, "the first cell's index")->capture_default_str();
  command.add_option("--only", only, "these indices alone, I,J,..");
  command.add_option("--class", shoe_class, "shoes of this class alone");
}

std::vector<std::uint64_t> SweepOptions::indices() const {
  std::vector<std::uint64_t> chosen;
  if (only.empty()) {
    chosen.resize(count);
    std::iota(chosen.begin(), chosen.end(), from);
  }
  std::istringstream words{only};
  for (std::string word; std::getline(words, word, ',');)
    chosen.push_back(std::strtoull(word.c_str(), nullptr, 10));
  return chosen;
}

bool SweepOptions::asks_for(const test::SweepCell& cell) const {
  return shoe_class.empty() || shoe_class == sim::name_of(cell.shoe.shoe_class);
}

std::optional<int> read_options(options::Command& command, int argc, char** argv) {
  const std::optional<options::Leave> leave = command.parse(argc, argv);
  if (!leave) return std::nullopt;
  if (leave->fault.empty()) return 0;
  std::fprintf(stderr, "%s\n", leave->fault.c_str());
  return 2;
}

const char* word_for(test::Judged judged) {
  switch (judged) {
    case test::Judged::Right:
      return "right";
    case test::Judged::Refused:
      return "REFUSED";
    case test::Judged::Wrong:
      return "WRONG";
  }
  return "";
}

void SweepTally::add(const test::SweepVerdict& verdict, bool plain_to_see) {
  ++scans;
  right += verdict.judged == test::Judged::Right ? 1 : 0;
  refused += verdict.judged == test::Judged::Refused ? 1 : 0;
  wrong += verdict.judged == test::Judged::Wrong ? 1 : 0;
  plain += plain_to_see ? 1 : 0;
  plain_refused += plain_to_see && verdict.judged == test::Judged::Refused ? 1 : 0;
}

std::string SweepTally::row(const char* unit) const {
  char text[256];
  std::snprintf(text, sizeof text,
                "\"ours\":%d,\"unit\":\"%s\",\"right\":%d,\"refused\":%d,\"upper_95\":%.5f,"
                "\"plain_to_see\":%d,\"plain_refused\":%d",
                wrong, unit, right, refused, test::upper_bound_95(wrong, scans), plain, plain_refused);
  return text;
}

}  // namespace biteline::bench
