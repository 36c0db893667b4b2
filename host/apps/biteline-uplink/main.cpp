// SPDX-License-Identifier: MIT
// biteline-uplink: tells the centre of every shoe of one cell, fetches its releases, and gives recordings
// that the centre asks for.  It reads the cell's memory and results and never writes them.
#include <sys/prctl.h>

#include <csignal>
#include <cstdio>

#include "common/options/command.hpp"
#include "host/fleet/broker_command_line.hpp"
#include "host/fleet/idle_disk.hpp"
#include "host/fleet/program.hpp"
#include "host/fleet/recording_giver.hpp"
#include "host/fleet/release_keeper.hpp"
#include "host/fleet/sparkplug/line.hpp"
#include "host/fleet/uplink.hpp"
#include "host/records/centre_word/centre_word.hpp"

namespace {

using namespace biteline;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Delivery = fleet::Broker::Delivery;

constexpr const char* k_program = "biteline-uplink";

/// In the folder of results, beside what the centre says.
constexpr const char* k_sparkplug_count = "sparkplug.count";

constexpr milliseconds k_turn{100};
/// How long after its end a shoe is sent, at most.
constexpr milliseconds k_between_looks{200};
constexpr milliseconds k_between_words{5000};
/// Pieces of a recording sent in one look: about 1 MB/s, so that the line is never full of them.
constexpr int k_most_pieces = 4;
/// Shoes told to Sparkplug's hosts in one look.
constexpr int k_most_told = 20;

struct Options {
  std::filesystem::path results;
  std::string cell;
  fleet::BrokerOptions broker;
  std::string sparkplug;                        ///< group; empty: not told
  std::filesystem::path releases, release_key;  ///< empty: this cell takes none
  bool exit_with_parent{false};
};

/// Says a fault once, until it is another one.
class Complaints {
 public:
  void say(const std::string& line) {
    if (line == last_) return;
    last_ = line;
    if (line.empty()) return;
    std::fprintf(stderr, "biteline-uplink: %s\n", line.c_str());
  }

 private:
  std::string last_;
};

class Cell {
 public:
  explicit Cell(const Options& options)
      : options_{options}, file_{options.results / memory::k_memory_file}, giver_{options.results} {}

  Result<void> open() {
    BITELINE_ASSIGN(fleet::BrokerConfig broker, fleet::broker_of(options_.broker));
    broker.client = "biteline-uplink-" + options_.cell;
    broker.subscriptions = {fleet::committed_topic(options_.cell), fleet::topic_of(options_.cell, "fetch")};
    if (!options_.releases.empty()) {
      broker.subscriptions.push_back(fleet::topic_of(options_.cell, "plan"));
      broker.subscriptions.push_back(fleet::topic_of(options_.cell, "part"));
      releases_.emplace(options_.releases, options_.release_key, options_.cell,
                        [this](const fleet::PartAsk& ask) {
                          broker_->publish(fleet::topic_of(options_.cell, "ask"), fleet::to_text(ask),
                                           Delivery::AtLeastOnce);
                        });
      BITELINE_TRY(releases_->begin());
    }
    broker.will_topic = fleet::health_topic(options_.cell);
    broker.will = fleet::to_text(fleet::HealthMessage{});
    BITELINE_ASSIGN(broker_,
                    fleet::Broker::open(
                        broker, [this](std::string_view topic, std::string_view text) { hear(topic, text); },
                        [this] { begin_line(); }));
    if (!options_.sparkplug.empty()) {
      broker.client = "biteline-sparkplug-" + options_.cell;
      const std::filesystem::path count = options_.results / k_sparkplug_count;
      sparkplug_ = std::make_unique<fleet::sparkplug::Line>(
          broker,
          fleet::sparkplug::Node{options_.sparkplug, options_.cell, BITELINE_VERSION,
                                 fleet::sparkplug::Line::last_line(count)},
          count);
    }
    return {};
  }

  void run() {
    while (!fleet::told_to_stop()) {
      const Result<void> turned = broker_->turn(k_turn);
      if (!turned) line_.say(to_line(turned.error()));
      if (broker_->ready()) line_.say("");
      const Clock::time_point now = Clock::now();
      if (now >= speak_at_) {
        // Opened anew: the memory may have been put in the place of another.
        speak_at_ = now + k_between_words;
        open_outbox();
        speak();
        tell_releases();
      }
      if (now >= look_at_) {
        look_at_ = now + k_between_looks;
        send(now);
        look_at_releases(now);
        tell_sparkplug();
        give_recording();
      }
    }
    fleet::HealthMessage gone;
    broker_->publish(fleet::health_topic(options_.cell), fleet::to_text(gone), Delivery::Kept);
  }

 private:
  void begin_line() {
    uplink_.begin_line();
    speak_at_ = {};
    std::printf("biteline-uplink: connected as %s\n", options_.cell.c_str());
    std::fflush(stdout);
  }

  /// The shoes since the last look, each by itself; the first look begins with the last shoe.
  void tell_sparkplug() {
    if (!sparkplug_) return;
    const Result<void> turned = sparkplug_->turn(milliseconds{0});
    sparkplug_words_.say(turned ? "" : to_line(turned.error()));
    if (!outbox_) return;
    Result<memory::OutboxPart> part = told_ ? outbox_->after(*told_, k_most_told) : outbox_->last();
    if (!part) return memory_.say(to_line(part.error()));
    // A memory that begins anew counts from one again.
    if (told_ && part->book != told_book_) {
      told_.reset();
      return;
    }
    told_book_ = part->book;
    told_ = part->rows.empty() ? told_.value_or(0) : part->rows.back().seq;
    for (memory::OutboxRow& row : part->rows) {
      seen_.last = fleet::fitted(row.scan, row.seq);
      sparkplug_->show(seen_);
    }
    sparkplug_->show(seen_);
  }

  void hear(std::string_view topic, std::string_view text) {
    if (topic == fleet::committed_topic(options_.cell)) return hear_committed(text);
    if (topic.ends_with("/fetch")) return hear_fetch(text);
    const Clock::time_point now = Clock::now();
    const Result<void> done = topic.ends_with("/plan") ? hear_plan(text, now) : hear_part(text, now);
    release_words_.say(done ? "" : to_line(done.error()));
  }

  void hear_fetch(std::string_view text) {
    const Result<fleet::FetchAsk> ask = fleet::read_fetch_ask(text);
    fetch_words_.say(ask ? "" : to_line(ask.error()));
    if (ask) giver_.hear(*ask);
  }

  /// Only once the centre has all shoes, and while no scan comes in or is worked out.
  void give_recording() {
    if (!giver_.asked() || !broker_->ready() || !outbox_ || fleet::cell_works(options_.results)) return;
    const Result<memory::OutboxPart> waiting = outbox_->after(uplink_.committed(), 1);
    if (!waiting || waiting->waiting > 0) return;
    for (int i = 0; i < k_most_pieces; ++i) {
      const std::optional<fleet::Piece> piece = [&] {
        const fleet::IdleDisk idle;  // the service writes to this disk
        return giver_.step(waiting->book);
      }();
      if (!piece) return;
      broker_->publish(fleet::topic_of(options_.cell, "recording"), fleet::to_payload(*piece),
                       Delivery::AtLeastOnce);
    }
  }

  Result<void> hear_plan(std::string_view text, Clock::time_point now) {
    BITELINE_ASSIGN(const fleet::ReleasePlan plan, fleet::read_release_plan(text));
    const fleet::ReleaseWord before = releases_->word(memory::now_ms());
    const Result<void> done = releases_->hear(plan, now, memory::now_ms());
    const fleet::ReleaseWord after = releases_->word(memory::now_ms());
    // The centre waits for it; a word that says nothing new is for the next round.
    if (after.number != before.number || after.current != before.current || after.fault != before.fault)
      tell_releases();
    return done;
  }

  Result<void> hear_part(std::string_view payload, Clock::time_point now) {
    BITELINE_ASSIGN(const fleet::Part part, fleet::read_part(payload));
    const Result<bool> whole = releases_->hear(part, now);
    if (!whole) tell_releases();
    if (!whole) return tl::unexpected<Error>{whole.error()};
    return {};
  }

  void look_at_releases(Clock::time_point now) {
    if (!releases_ || !broker_->ready()) return;
    const Result<bool> looked = releases_->look(now, memory::now_ms());
    if (!looked) release_words_.say(to_line(looked.error()));
    if (!looked || *looked) tell_releases();
  }

  void tell_releases() {
    if (!releases_) return;
    broker_->publish(fleet::topic_of(options_.cell, "release"),
                     fleet::to_text(releases_->word(memory::now_ms())), Delivery::AtLeastOnce);
  }

  void hear_committed(std::string_view text) {
    const Result<fleet::CommittedMessage> committed = fleet::read_committed(text);
    if (!committed) return memory_.say(to_line(committed.error()));
    uplink_.hear(*committed, Clock::now());
    look_at_ = {};
    tell_cell(*committed);
  }

  /// The service shows it to people: on the page, in the log.
  void tell_cell(const fleet::CommittedMessage& committed) {
    Result<centre_word::CentreWord> known = centre_word::read(options_.results);
    centre_word::CentreWord word = known ? *known : centre_word::CentreWord{};
    word.held = committed.held;
    for (const fleet::DeadLetter& letter : committed.letters) {
      if (word.add({.book = committed.book,
                    .seq = letter.seq,
                    .scan = letter.scan,
                    .why = letter.why,
                    .time = memory::to_iso(memory::now_ms())}))
        std::fprintf(stderr, "biteline-uplink: %s: the centre could not read all of it: %s\n",
                     letter.scan.c_str(), letter.why.c_str());
    }
    if (known && word == *known) return;
    const Result<void> written = centre_word::write(options_.results, word);
    cell_words_.say(written ? "" : to_line(written.error()));
  }

  void open_outbox() {
    Result<memory::Outbox> outbox = memory::Outbox::open(file_);
    outbox_.reset();
    if (!outbox) return memory_.say(to_line(outbox.error()));
    outbox_.emplace(std::move(*outbox));
  }

  void speak() {
    if (!outbox_) return;
    const Result<memory::OutboxPart> part = outbox_->after(uplink_.committed(), 1);
    if (!part) return memory_.say(to_line(part.error()));
    memory_.say("");
    uplink_.use_book(part->book);
    seen_.waiting = part->waiting;
    fleet::HealthMessage health{
        .online = true, .version = BITELINE_VERSION, .book = part->book, .waiting = part->waiting, .log = {}};
    if (const Result<memory::LogLink> link = outbox_->last_log_link(); link) {
      health.log = *link;
    } else {
      memory_.say(to_line(link.error()));
    }
    broker_->publish(fleet::health_topic(options_.cell), fleet::to_text(health), Delivery::Kept);
  }

  void send(Clock::time_point now) {
    if (!outbox_ || !broker_->ready()) return;
    const std::optional<std::int64_t> from = uplink_.next(now);
    if (!from) return;
    const Result<memory::OutboxPart> part = outbox_->after(*from, uplink_.room());
    if (!part) return memory_.say(to_line(part.error()));
    for (const memory::OutboxRow& row : part->rows) {
      fleet::ShoeMessage shoe{.book = part->book,
                              .seq = row.seq,
                              .after = row.after,
                              .scan = row.scan,
                              .places = row.places,
                              .release = fleet::release_of(row.scan)};
      if (uplink_.bare()) shoe = fleet::bare_of(shoe, "the centre did not take it as it is");
      if (!broker_->publish(fleet::shoes_topic(options_.cell), fleet::to_text(shoe), Delivery::AtLeastOnce))
        return;
      uplink_.sent(row.seq, now);
    }
  }

  const Options& options_;
  std::filesystem::path file_;
  std::unique_ptr<fleet::Broker> broker_;
  std::optional<memory::Outbox> outbox_;
  fleet::Uplink uplink_;
  std::unique_ptr<fleet::sparkplug::Line> sparkplug_;
  fleet::sparkplug::CellState seen_;    ///< by Sparkplug's hosts
  std::optional<std::int64_t> told_{};  ///< the outbox's row that they were told of last
  std::string told_book_;
  std::optional<fleet::ReleaseKeeper> releases_;
  fleet::RecordingGiver giver_;
  Complaints line_, memory_, sparkplug_words_, release_words_, fetch_words_, cell_words_;
  Clock::time_point speak_at_{}, look_at_{};
};

int log_error(const std::string& line, ExitStatus status) {
  return fleet::log_error(k_program, line, status);
}

int run(int argc, char** argv) {
  Options options;
  options::Command app{"Tells the factory's centre of every shoe of one cell, over MQTT 5.", k_program};
  app.set_version_flag("--version", BITELINE_VERSION);
  app.add_option("--results", options.results, "biteline-host's folder of results (its --out)")->required();
  app.add_option("--cell", options.cell, "This cell's name: letters, digits, - and _, at most 64")
      ->required();
  fleet::add_broker_options(app, options.broker);
  app.add_option("--sparkplug", options.sparkplug,
                 "Be a node of this Sparkplug B group, too: state and last shoe, on a line of its own");
  auto* releases =
      app.add_option("--releases", options.releases,
                     "Folder of the releases that the centre offers, as biteline-host is told it");
  auto* key = app.add_option("--release-key", options.release_key,
                             "Public ed25519 key (PEM) of who may release; nothing else is taken");
  releases->needs(key);
  key->needs(releases);
  app.add_flag("--exit-with-parent", options.exit_with_parent,
               "Stop when the program that started this one ends");
  if (const std::optional<options::Leave> leave = app.parse(argc, argv))
    return leave->fault.empty() ? 0 : log_error(leave->fault + " (see --help)", ExitStatus::BadInput);
  if (!fleet::is_cell_name(options.cell) || fleet::is_reserved_name(options.cell))
    return log_error("--cell: letters, digits, - and _ expected, at most 64, not 'fleet' or 'host'",
                     ExitStatus::BadInput);
  if (!options.sparkplug.empty() && !fleet::is_cell_name(options.sparkplug))
    return log_error("--sparkplug: letters, digits, - and _ expected, at most 64", ExitStatus::BadInput);
  if (options.exit_with_parent) prctl(PR_SET_PDEATHSIG, SIGTERM);
  Cell cell{options};
  if (const Result<void> opened = cell.open(); !opened)
    return log_error(to_line(opened.error()), error_row(opened.error().code).exit_status);
  cell.run();
  return static_cast<int>(ExitStatus::Done);
}

}  // namespace

int main(int argc, char** argv) {
  return biteline::fleet::run_until_told(k_program, argc, argv, run);
}
