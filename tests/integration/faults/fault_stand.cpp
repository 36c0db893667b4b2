// SPDX-License-Identifier: MIT
#include "tests/integration/faults/fault_stand.hpp"

#include <CppUTest/TestHarness.h>
#include <sched.h>

#include <csignal>
#include <cstdio>
#include <thread>

#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds k_patience{30};  // of a loaded machine

/// Below the sensor's threads (40 and more) and the cell's (30 and more).
constexpr int k_host_priority = 20;

void run_as(int policy, int priority) {
  const sched_param wanted{.sched_priority = priority};
  // Without the rights the host is as any program.
  (void)sched_setscheduler(0, policy, &wanted);
}

WakeupProbe::Clock::time_point on_probe_clock(SensorClock::time_point instant) {
  return WakeupProbe::Clock::time_point{instant.time_since_epoch()};  // both are CLOCK_MONOTONIC
}

}  // namespace

std::unique_ptr<FaultStand> FaultStand::set_up(const PictureCellConfig& config,
                                               std::vector<std::string> more) {
  auto cell = PictureCell::open(config);
  if (!cell) {
    note_skipped(to_line(cell.error()));
    return nullptr;
  }
  note_ran();
  std::unique_ptr<FaultStand> stand{new FaultStand};
  stand->cell_ = std::move(*cell);
  stand->more_ = std::move(more);
  stand->account_.emplace(*stand->cell_);
  stand->board_file_ = stand->folder_.write("board.yaml", stand->cell_->board_file_text());
  stand->sensor_file_ = stand->folder_.write("sensor.yaml", stand->cell_->sensor_file_text());
  stand->start_sensor();
  run_as(SCHED_FIFO, k_host_priority);
  stand->come_back();
  return stand;
}

void FaultStand::start_sensor() {
  for (const char* const rights : {"--rt=required", "--rt=ignore"}) {
    std::vector<std::string> arguments{"--source", "board:" + board_file_, "--sensor", sensor_file_, rights};
    arguments.insert(arguments.end(), more_.begin(), more_.end());
    auto sensor = intake::SensorProcess::start(*intake::find_sensor_program(), arguments, k_patience);
    if (!sensor && sensor.error().where.view().find("--rt=ignore") != std::string_view::npos) continue;
    SUCCEEDS(sensor);
    urgent_ = std::string_view{rights} == "--rt=required";
    sensor_.emplace(std::move(*sensor));
    return;
  }
}

FaultStand::~FaultStand() {
  run_as(SCHED_OTHER, 0);
}

void FaultStand::leave() {
  link_.reset();
}

void FaultStand::replace_sensor() {
  leave();
  ::kill(sensor_->child().pid(), SIGKILL);
  start_sensor();
  come_back();
}

void FaultStand::come_back() {
  intake::SensorLinkConfig config;
  config.sensor = sensor_->endpoint();
  auto link = intake::SensorLink::open(config);
  SUCCEEDS(link);
  link_ = std::move(*link);
  account_->clear();
  known_ = false;
  CHECK(take_until([this] { return known_; }));
}

void FaultStand::command(wire::Command command) {
  link_->command({.id = ++command_id_, .command = command});
}

wire::ControlReply FaultStand::ask(wire::Command order) {
  reply_.reset();
  command(order);
  if (!take_until([this] { return reply_.has_value(); }))
    return {.id = 0, .errc = static_cast<std::uint16_t>(Errc::Timeout), .where = "no answer"};
  return *reply_;
}

std::string FaultStand::send_settings(const std::string& text) {
  reply_.reset();
  link_->command({.id = ++command_id_, .command = wire::Command::UseSettings, .settings = text});
  if (!take_until([this] { return reply_.has_value(); })) return "no answer";
  return reply_->where;
}

std::optional<std::string> FaultStand::start_scan(std::uint64_t profiles) {
  account_->clear();
  reply_.reset();
  command(wire::Command::StartScan);
  const bool answered = take_until([this] { return reply_.has_value(); });
  if (!answered) return "no answer";
  if (reply_->errc != 0) return reply_->where;
  take_until([&] { return (cell_->laser_on() && account_->profiles >= profiles) || account_->end; });
  if (account_->end) return account_->end->where;
  return std::nullopt;
}

bool FaultStand::take_until(const std::function<bool()>& done) {
  const auto deadline = std::chrono::steady_clock::now() + k_patience;
  const bool over = account_->end.has_value();
  while (!done()) {
    // What a scan was to bring does not come after its end.
    if (!over && account_->end) {
      std::printf("the scan ended: %s\n", account_->end->where.c_str());
      return false;
    }
    if (std::chrono::steady_clock::now() > deadline) return false;
    const auto event = link_->next(milliseconds{5});
    if (!event) return false;
    if (*event) take(**event);
  }
  return true;
}

bool FaultStand::take_profiles(std::uint64_t more) {
  const std::uint64_t wanted = account_->profiles + more;
  return take_until([&] { return account_->profiles >= wanted; });
}

bool FaultStand::take_health() {
  const std::uint64_t seen = account_->healths;
  return take_until(
      [&] { return account_->healths >= seen + 2; });  // the first may have been under way already
}

void FaultStand::take(const intake::LinkEvent& event) {
  if (const auto* hello = std::get_if<intake::Hello>(&event)) {
    known_ = true;
    hello_ = hello->sensor;
  }
  if (const auto* health = std::get_if<wire::Health>(&event); health && health->settings)
    settings_ = *health->settings;
  if (const auto* health = std::get_if<wire::Health>(&event)) upkeep_ = health->upkeep;
  if (const auto* reply = std::get_if<wire::ControlReply>(&event)) reply_ = *reply;
  account_->take(event);
}

std::optional<double> FaultStand::dark_after_ms(SensorClock::time_point begin) {
  const auto deadline = std::chrono::steady_clock::now() + k_patience;
  // The line's level changes a moment before its instant is noted.
  const auto dark = [&] { return !cell_->laser_on() && cell_->dark_since() >= begin; };
  while (!dark() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::microseconds{200});
  if (cell_->laser_on()) return std::nullopt;
  return reaction_ms(on_probe_clock(begin), on_probe_clock(cell_->dark_since()));
}

}  // namespace biteline::test
