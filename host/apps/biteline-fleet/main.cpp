// SPDX-License-Identifier: MIT
// biteline-fleet: takes the shoes of all cells from the broker into the centre's database.
#include <sys/prctl.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <thread>

#include "host/apps/biteline-fleet/page_door.hpp"
#include "host/apps/biteline-fleet/recording_orders.hpp"
#include "host/apps/biteline-fleet/recording_talk.hpp"
#include "host/apps/biteline-fleet/release_orders.hpp"
#include "host/apps/biteline-fleet/release_talk.hpp"
#include "host/doors/control/messages.hpp"
#include "host/fleet/broker_options.hpp"
#include "host/fleet/centre.hpp"
#include "host/fleet/metrics.hpp"
#include "host/fleet/overview.hpp"
#include "host/fleet/program.hpp"

namespace {

using namespace biteline;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr const char* k_program = "biteline-fleet";

constexpr milliseconds k_turn{100};
constexpr std::size_t k_most_at_once = 100;
/// More than so many are dropped: their cells send them again.
constexpr std::size_t k_most_waiting = 5000;
constexpr milliseconds k_before_retry{1000};
/// How old the metrics of the cells are, at most, and whose cell is odd.
constexpr milliseconds k_between_counts{10'000};
constexpr milliseconds k_between_judgements{60'000};

struct Options {
  fleet::BrokerOptions broker;
  std::string database;
  std::filesystem::path migrations;
  bool list{false};
  bool odd{false};
  fleet::ReleaseOrders releases;
  fleet::RecordingOrders fetches;
  std::filesystem::path recordings;
  std::string control;
  std::filesystem::path accounts;
  std::optional<std::uint16_t> metrics;
  bool json{false};
  bool exit_with_parent{false};
};

class Fleet {
 public:
  explicit Fleet(const Options& options) : options_{options}, recordings_{options.recordings} {}

  Result<void> open() {
    BITELINE_ASSIGN(fleet::BrokerConfig broker, fleet::broker_of(options_.broker));
    broker.client = "biteline-fleet";
    broker.subscriptions = {fleet::k_all_shoes, fleet::k_all_health, fleet::k_all_release_words,
                            fleet::k_all_asks, fleet::k_all_recordings};
    BITELINE_ASSIGN(broker_,
                    fleet::Broker::open(
                        broker, [this](std::string_view topic, std::string_view text) { hear(topic, text); },
                        [] {
                          std::printf("biteline-fleet: connected to the broker\n");
                          std::fflush(stdout);
                        }));
    if (options_.metrics) {
      BITELINE_ASSIGN(metrics_, fleet::MetricsPort::open(*options_.metrics));
      std::printf("biteline-fleet: http://127.0.0.1:%u/metrics\n", unsigned{metrics_->port()});
      std::fflush(stdout);
    }
    if (options_.control.empty()) return {};
    BITELINE_ASSIGN(const wire::Endpoint endpoint, wire::parse_endpoint(options_.control));
    BITELINE_ASSIGN(page_, fleet::PageDoor::open({.endpoint = endpoint,
                                                  .accounts = options_.accounts,
                                                  .database = options_.database,
                                                  .migrations = options_.migrations,
                                                  .version = BITELINE_VERSION}));
    std::printf("biteline-fleet: pages come in at %s\n", page_->address().c_str());
    std::fflush(stdout);
    return {};
  }

  void run() {
    while (!fleet::told_to_stop()) {
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

  /// What is told of a database that went away stays as it was, but for `database_up`.
  void show_metrics() {
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
      if (auto odd = fleet::odd_of_all(*centre_)) news_.odd = std::move(*odd);
    }
    metrics_->show(fleet::metrics_text(news_));
  }

 private:
  bool open_centre() {
    Result<fleet::Centre> centre = fleet::Centre::open(options_.database, options_.migrations);
    if (!centre) {
      say(to_line(centre.error()));
      return false;
    }
    centre_.emplace(std::move(*centre));
    std::printf("biteline-fleet: connected to the database\n");
    std::fflush(stdout);
    return true;
  }

  void wait() {
    for (milliseconds waited{0}; waited < k_before_retry && !fleet::told_to_stop(); waited += k_turn) {
      if (const Result<void> turned = broker_->turn(k_turn); !turned) std::this_thread::sleep_for(k_turn);
    }
    forget();
  }

  void forget() {
    shoes_.clear();
    health_.clear();
    releases_.forget();
    recordings_.forget();
  }

  void say(const std::string& line) {
    if (line == last_) return;
    last_ = line;
    std::fprintf(stderr, "biteline-fleet: %s\n", line.c_str());
  }

  void hear(std::string_view topic, std::string_view text) {
    const Result<bool> heard = releases_.hear(topic, text);
    if (!heard) return say(std::string{topic} + ": " + to_line(heard.error()));
    if (*heard) return;
    const Result<bool> piece = recordings_.hear(topic, text);
    if (!piece) return say(std::string{topic} + ": " + to_line(piece.error()));
    if (*piece) return;
    if (const std::optional<std::string> cell = fleet::cell_of(topic, "shoes")) {
      Result<fleet::ShoeMessage> shoe = fleet::read_shoe(text);
      if (!shoe) return say(*cell + ": " + to_line(shoe.error()));
      ++news_.taken;
      if (shoes_.size() < k_most_waiting) shoes_.push_back({.cell = *cell, .shoe = std::move(*shoe)});
    } else if (const std::optional<std::string> speaker = fleet::cell_of(topic, "health")) {
      Result<fleet::HealthMessage> health = fleet::read_health(text);
      if (!health) return say(*speaker + ": " + to_line(health.error()));
      if (health_.size() < k_most_waiting) health_.emplace_back(*speaker, std::move(*health));
    }
  }

  /// Into the database, and only then the cells are told.
  Result<void> keep() {
    for (std::size_t at = 0; at < shoes_.size(); at += k_most_at_once) {
      const auto begin = shoes_.begin() + static_cast<std::ptrdiff_t>(at);
      const auto end =
          shoes_.begin() + static_cast<std::ptrdiff_t>(std::min(shoes_.size(), at + k_most_at_once));
      BITELINE_ASSIGN(const std::vector<fleet::CommittedOf> committed, centre_->commit({begin, end}));
      for (const fleet::CommittedOf& one : committed) tell(one.cell, one.to);
    }
    shoes_.clear();
    for (const auto& [cell, health] : health_) {
      BITELINE_TRY(centre_->note_health(cell, health));
      if (!health.online) continue;
      BITELINE_ASSIGN(const fleet::CommittedMessage stands, centre_->committed(cell, health.book));
      tell(cell, stands);
    }
    health_.clear();
    const auto publish = [this](const std::string& topic, const std::string& payload) {
      broker_->publish(topic, payload, fleet::Broker::Delivery::AtLeastOnce);
    };
    BITELINE_TRY(releases_.work(*centre_, publish, Clock::now()));
    return recordings_.work(*centre_, publish, Clock::now());
  }

  void tell(const std::string& cell, const fleet::CommittedMessage& committed) {
    // Not kept by the broker: a word from before a database that was put back would be wrong.
    broker_->publish(fleet::committed_topic(cell), fleet::to_text(committed),
                     fleet::Broker::Delivery::AtLeastOnce);
  }

  const Options& options_;
  std::unique_ptr<fleet::Broker> broker_;
  std::optional<fleet::Centre> centre_;
  std::vector<fleet::FromCell> shoes_;
  std::vector<std::pair<std::string, fleet::HealthMessage>> health_;
  fleet::ReleaseTalk releases_;
  fleet::RecordingTalk recordings_;
  std::unique_ptr<fleet::MetricsPort> metrics_;
  std::unique_ptr<fleet::PageDoor> page_;
  fleet::FleetNews news_;
  Clock::time_point count_at_{}, judge_at_{};
  std::string last_;
};

Result<ExitStatus> list(const Options& options, fleet::Centre& centre) {
  BITELINE_ASSIGN(const std::vector<fleet::CellRow> cells, centre.cells());
  control::Json json = control::Json::array();
  if (!options.json)
    std::printf("%-20s %-8s %-24s %8s %8s %8s %8s %8s %8s\n", "cell", "state", "heard", "waiting", "shoes",
                "ok", "amber", "refused", "failed");
  for (const fleet::CellRow& cell : cells) {
    if (options.json) {
      json.push_back({{"cell", cell.cell},
                      {"online", cell.online},
                      {"heard", memory::to_iso(cell.heard_ms)},
                      {"version", cell.version},
                      {"waiting", cell.waiting},
                      {"shoes", cell.shoes},
                      {"ok", cell.ok},
                      {"amber", cell.amber},
                      {"refused", cell.refused},
                      {"failed", cell.failed},
                      {"last_shoe", cell.last_shoe_ms ? control::Json(memory::to_iso(*cell.last_shoe_ms))
                                                      : control::Json{}}});
      continue;
    }
    std::printf("%-20s %-8s %-24s %8lld %8lld %8lld %8lld %8lld %8lld\n", cell.cell.c_str(),
                cell.online ? "online" : "away", memory::to_iso(cell.heard_ms).c_str(),
                static_cast<long long>(cell.waiting), static_cast<long long>(cell.shoes),
                static_cast<long long>(cell.ok), static_cast<long long>(cell.amber),
                static_cast<long long>(cell.refused), static_cast<long long>(cell.failed));
  }
  if (options.json)
    std::printf("%s\n", control::Json{{"schema_version", 1}, {"cells", std::move(json)}}.dump(2).c_str());
  return ExitStatus::Done;
}

/// Cells whose lines differ from the others'; Refused when there is one.
Result<ExitStatus> tell_odd_cells(const Options& options, fleet::Centre& centre) {
  BITELINE_ASSIGN(const std::vector<fleet::OddOfModel> all, fleet::odd_of_all(centre));
  control::Json json = control::Json::array();
  for (const auto& [model, odd] : all) {
    json.push_back({{"model", model},
                    {"cell", odd.cell},
                    {"difference", fleet::to_text(odd.difference)},
                    {"mm", odd.mm},
                    {"u95_mm", odd.u95_mm},
                    {"shoes", odd.shoes},
                    {"since", odd.since}});
    if (!options.json)
      std::printf("%s, %s: %s by %.3f mm (U95 %.3f mm) in %d shoes since %s\n", odd.cell.c_str(),
                  model.c_str(), fleet::to_text(odd.difference), odd.mm, odd.u95_mm, odd.shoes,
                  odd.since.c_str());
  }
  const bool none = json.empty();
  if (options.json) {
    std::printf("%s\n", control::Json{{"schema_version", 1}, {"odd", std::move(json)}}.dump(2).c_str());
  } else if (none) {
    std::printf("no cell differs from the others\n");
  }
  return none ? ExitStatus::Done : ExitStatus::Refused;
}

int complain(const std::string& line, ExitStatus status) {
  return fleet::complain(k_program, line, status);
}

int run(int argc, char** argv) {
  Options options;
  std::error_code fault;
  options.migrations = std::filesystem::read_symlink("/proc/self/exe", fault).parent_path().parent_path() /
                       "share/biteline/migrations";
  CLI::App app{"The factory's centre: takes the shoes of all cells from the broker into PostgreSQL.",
               k_program};
  app.set_version_flag("--version", BITELINE_VERSION);
  app.add_option(
         "--database", options.database,
         "PostgreSQL, as libpq takes it: \"host=HOST dbname=NAME user=NAME\"; a password stands in ~/.pgpass")
      ->required();
  fleet::add_broker_options(app, options.broker);
  app.add_option("--migrations", options.migrations, "Folder of the tables' versions")->capture_default_str();
  app.add_option("--metrics", options.metrics,
                 "Give Prometheus' text at http://127.0.0.1:PORT/metrics; 0: any free port");
  auto* control =
      app.add_option("--control", options.control,
                     "Where biteline-web comes in for the page of all cells: tcp://127.0.0.1:PORT");
  auto* accounts =
      app.add_option("--accounts", options.accounts, "Folder of the page's accounts and log")->needs(control);
  control->needs(accounts);
  app.add_flag("--list", options.list, "Print the cells with their health and counts, and leave");
  app.add_flag(
      "--odd", options.odd,
      "Name each cell whose lines of a model differ from the other cells', and leave; exit status 3 where "
      "there is one");
  fleet::add_release_options(app, options.releases);
  app.add_option("--recordings", options.recordings,
                 "Folder for the recordings that are asked for with --fetch; without: none are fetched");
  fleet::add_recording_options(app, options.fetches);
  app.add_flag("--json", options.json, "With --list, --odd, --releases or --fetches: as JSON");
  app.add_flag("--exit-with-parent", options.exit_with_parent,
               "Stop when the program that started this one ends");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return complain(std::string{error.what()} + " (see --help)", ExitStatus::BadInput);
  }
  if (options.exit_with_parent) prctl(PR_SET_PDEATHSIG, SIGTERM);
  const Result<ExitStatus> done = [&]() -> Result<ExitStatus> {
    if (!options.odd && !options.list && !options.releases.any() && !options.fetches.any()) {
      Fleet fleet{options};
      BITELINE_TRY(fleet.open());
      fleet.run();
      return ExitStatus::Done;
    }
    BITELINE_ASSIGN(fleet::Centre centre, fleet::Centre::open(options.database, options.migrations));
    if (options.odd) return tell_odd_cells(options, centre);
    if (options.list) return list(options, centre);
    if (options.fetches.any()) return fleet::carry_out(options.fetches, centre, options.json);
    return fleet::carry_out(options.releases, centre, options.json);
  }();
  if (!done) return complain(to_line(done.error()), error_row(done.error().code).exit_status);
  return static_cast<int>(*done);
}

}  // namespace

int main(int argc, char** argv) {
  return biteline::fleet::run_until_told(k_program, argc, argv, run);
}
