// SPDX-License-Identifier: MIT
#include "host/apps/biteline-fleet/running_centre.hpp"

#include <cstdio>
#include <thread>

#include "host/fleet/overview.hpp"
#include "host/fleet/program.hpp"

namespace biteline::fleet {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds k_turn{100};
constexpr std::size_t k_most_at_once = 100;
constexpr milliseconds k_before_retry{1000};
/// How old the metrics of the cells are, at most, and whose cell is odd.
constexpr milliseconds k_between_counts{10'000};
constexpr milliseconds k_between_judgements{60'000};

}  // namespace

Result<void> RunningCentre::open() {
  BITELINE_ASSIGN(BrokerConfig broker, broker_of(options_.broker));
  broker.client = "biteline-fleet";
  broker.subscriptions = {k_all_shoes, k_all_health, k_all_release_words, k_all_asks, k_all_recordings};
  BITELINE_ASSIGN(broker_,
                  Broker::open(
                      broker, [this](std::string_view topic, std::string_view text) { hear(topic, text); },
                      [] {
                        std::printf("biteline-fleet: connected to the broker\n");
                        std::fflush(stdout);
                      }));
  if (options_.metrics) {
    BITELINE_ASSIGN(metrics_, MetricsDoor::open(*options_.metrics, options_.accounts));
    std::printf("biteline-fleet: http://127.0.0.1:%u/metrics\n", unsigned{metrics_->port()});
    std::fflush(stdout);
  }
  if (options_.control.empty()) return {};
  BITELINE_ASSIGN(const wire::Endpoint endpoint, wire::parse_endpoint(options_.control));
  BITELINE_ASSIGN(page_, PageDoor::open({.endpoint = endpoint,
                                         .accounts = options_.accounts,
                                         .database = options_.database,
                                         .migrations = options_.migrations,
                                         .version = BITELINE_VERSION,
                                         .day = options_.day}));
  std::printf("biteline-fleet: pages come in at %s\n", page_->address().c_str());
  std::fflush(stdout);
  return {};
}

void RunningCentre::run() {
  while (!told_to_stop()) {
    show_metrics();
    if (page_) page_->show_broker(broker_->ready());
    if (!centre_ && !open_centre()) {
      // Without a database nothing is taken: the cells keep it.
      forget();
      wait();
      continue;
    }
    // The broker's line waits less while something is in hand.
    const bool in_hand = !shoes_.empty() || recordings_.busy();
    const Result<void> turned = broker_->turn(in_hand ? milliseconds{0} : k_turn);
    if (!turned) say(to_line(turned.error()));
    if (const Result<void> kept = keep(); !kept) {
      say(to_line(kept.error()));
      centre_.reset();
      forget();
    }
  }
}

void RunningCentre::show_metrics() {
  if (!metrics_) return;
  const Clock::time_point now = Clock::now();
  const bool changed = news_.broker != broker_->ready() || news_.database != centre_.has_value();
  if (!changed && now < count_at_) return;
  news_.broker = broker_->ready();
  news_.database = centre_.has_value();
  if (centre_ && now >= count_at_) {
    count_at_ = now + k_between_counts;
    if (auto cells = centre_->cells()) news_.cells = std::move(*cells);
  }
  if (centre_ && now >= judge_at_) {
    judge_at_ = now + k_between_judgements;
    if (auto odd = odd_of_all(*centre_)) news_.odd = std::move(*odd);
  }
  metrics_->show(metrics_text(news_));
}

bool RunningCentre::open_centre() {
  Result<Centre> centre = Centre::open(options_.database, options_.migrations);
  if (!centre) {
    say(to_line(centre.error()));
    return false;
  }
  centre_.emplace(std::move(*centre));
  if (const Result<void> day = Overview{*centre_}.keep_day(options_.day); !day) say(to_line(day.error()));
  std::printf("biteline-fleet: connected to the database\n");
  std::fflush(stdout);
  return true;
}

void RunningCentre::wait() {
  for (milliseconds waited{0}; waited < k_before_retry && !told_to_stop(); waited += k_turn) {
    if (const Result<void> turned = broker_->turn(k_turn); !turned) std::this_thread::sleep_for(k_turn);
  }
  forget();
}

void RunningCentre::forget() {
  shoes_.clear();
  health_.clear();
  releases_.forget();
  recordings_.forget();
}

void RunningCentre::say(const std::string& line) {
  if (line == last_) return;
  last_ = line;
  std::fprintf(stderr, "biteline-fleet: %s\n", line.c_str());
}

void RunningCentre::hear(std::string_view topic, std::string_view text) {
  const Result<bool> heard = releases_.hear(topic, text);
  if (!heard) return say(std::string{topic} + ": " + to_line(heard.error()));
  if (*heard) return;
  const Result<bool> piece = recordings_.hear(topic, text);
  if (!piece) return say(std::string{topic} + ": " + to_line(piece.error()));
  if (*piece) return;
  if (const std::optional<std::string> cell = cell_of(topic, "shoes")) {
    Result<ShoeMessage> shoe = read_shoe(text);
    if (!shoe) return say(*cell + ": " + to_line(shoe.error()));
    ++news_.taken;
    if (!shoe->fault.empty()) say(*cell + ": " + shoe->scan.name + ": " + shoe->fault + "; taken without it");
    shoes_.put({.cell = *cell, .shoe = std::move(*shoe)}, Clock::now());
  } else if (const std::optional<std::string> speaker = cell_of(topic, "health")) {
    Result<HealthMessage> health = read_health(text);
    if (!health) return say(*speaker + ": " + to_line(health.error()));
    if (health_.size() < k_most_cells_heard || health_.contains(*speaker))
      health_.insert_or_assign(*speaker, std::move(*health));
  }
}

Result<void> RunningCentre::keep() {
  while (!shoes_.empty()) {
    BITELINE_ASSIGN(const std::vector<CommittedOf> committed, centre_->commit(shoes_.take(k_most_at_once)));
    for (const CommittedOf& one : committed) tell(one.cell, one.to);
  }
  for (const auto& [cell, health] : health_) {
    BITELINE_TRY(centre_->note_health(cell, health));
    if (!health.online) continue;
    BITELINE_ASSIGN(const CommittedMessage stands, centre_->committed(cell, health.book));
    tell(cell, stands);
  }
  health_.clear();
  const auto publish = [this](const std::string& topic, const std::string& payload) {
    broker_->publish(topic, payload, Broker::Delivery::AtLeastOnce);
  };
  BITELINE_TRY(releases_.work(*centre_, publish, Clock::now()));
  return recordings_.work(*centre_, publish, Clock::now());
}

void RunningCentre::tell(const std::string& cell, CommittedMessage committed) {
  if (committed.held.empty()) committed.held = shoes_.held_words(cell, Clock::now());
  // Not kept by the broker: a word from before a database that was put back would be wrong.
  broker_->publish(committed_topic(cell), to_text(committed), Broker::Delivery::AtLeastOnce);
}

}  // namespace biteline::fleet
