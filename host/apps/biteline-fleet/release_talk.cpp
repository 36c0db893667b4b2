// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/release_talk.hpp"

namespace biteline::fleet {
namespace {

constexpr std::size_t k_most_cells = 5000;
constexpr std::chrono::milliseconds k_between_decisions{1000};

}  // namespace

Result<bool> ReleaseTalk::hear(std::string_view topic, std::string_view text) {
  if (const std::optional<std::string> cell = cell_of(topic, "release")) {
    BITELINE_ASSIGN(ReleaseWord word, read_release_word(text));
    if (words_.size() < k_most_cells) words_.insert_or_assign(*cell, std::move(word));
    return true;
  }
  if (const std::optional<std::string> cell = cell_of(topic, "ask")) {
    BITELINE_ASSIGN(PartAsk ask, read_part_ask(text));
    if (asks_.size() < k_most_cells) asks_.insert_or_assign(*cell, std::move(ask));
    return true;
  }
  return false;
}

Result<void> ReleaseTalk::work(Centre& centre, const Publish& publish, Clock::time_point now) {
  Releases releases{centre};
  const auto tell = [&](const std::string& cell) -> Result<void> {
    BITELINE_ASSIGN(const ReleasePlan plan, releases.plan_of(cell));
    publish(topic_of(cell, "plan"), to_text(plan));
    return {};
  };
  for (const auto& [cell, word] : words_) BITELINE_TRY(releases.note(cell, word));
  for (const auto& [cell, word] : words_) BITELINE_TRY(tell(cell));
  words_.clear();
  for (const auto& [cell, ask] : asks_) {
    BITELINE_ASSIGN(const std::vector<Part> parts, releases.parts(ask));
    for (const Part& part : parts) publish(topic_of(cell, "part"), to_payload(part));
  }
  asks_.clear();
  if (now < decide_at_) return {};
  decide_at_ = now + k_between_decisions;
  BITELINE_ASSIGN(const std::vector<std::string> cells, releases.decide());
  for (const std::string& cell : cells) BITELINE_TRY(tell(cell));
  return {};
}

void ReleaseTalk::forget() {
  words_.clear();
  asks_.clear();
}

}  // namespace biteline::fleet
