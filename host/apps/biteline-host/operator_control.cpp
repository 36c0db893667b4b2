// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/operator_control.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <utility>

#include "host/interfaces/accounts/first_token.hpp"
#include "host/interfaces/accounts/secrets.hpp"
#include "host/records/mounted/mounted_record.hpp"
#include "host/report/report.hpp"

namespace biteline::service {
namespace {

using api::Json;

constexpr std::chrono::milliseconds k_between_states{200};

}  // namespace

Result<std::unique_ptr<OperatorControl>> OperatorControl::open(const OperatorControlConfig& config) {
  BITELINE_ASSIGN(memory::Memory memory, memory::Memory::open(config.results / memory::k_memory_file));
  std::unique_ptr<OperatorControl> operator_control{new OperatorControl{config, std::move(memory)}};
  // What was being taught when the last service ended still waits for a person.
  BITELINE_ASSIGN(const std::optional<std::string> hold, operator_control->memory_.setting(k_hold_key));
  operator_control->hold_all_ = operator_control->hold_kept_ = hold == "yes";
  BITELINE_TRY(operator_control->keep_day());
  if (config.endpoint) BITELINE_TRY(operator_control->listen());
  return operator_control;
}

OperatorControl::OperatorControl(OperatorControlConfig config, memory::Memory memory)
    : config_{std::move(config)},
      memory_{std::move(memory)},
      accounts_{memory_},
      stops_{config_.stops != nullptr ? *config_.stops : own_stops_},
      cycle_{config_.jobs},
      go_{stops_.now()} {
  process_.name = config_.process;
  if (cycle_.on_demand()) cell_.on(CellEvent::Spent);
}

OperatorControl::~OperatorControl() {
  {
    const std::lock_guard lock{mutex_};
    ending_ = true;
  }
  answer_sensor({}, fail(Errc::WrongState, "the service ends"));
  // Its thread tells the server, the server's threads give it work: it ends first and is asked no more.
  if (reruns_) reruns_->end();
}

Result<void> OperatorControl::keep_day() {
  for (const auto& [key, value] : {std::pair{memory::k_zone_key, memory::time_zone()},
                                   std::pair{memory::k_day_begin_key, config_.day.begin()}}) {
    BITELINE_ASSIGN(const std::optional<std::string> before, memory_.setting(key));
    if (before == value) continue;
    BITELINE_TRY(memory_.put_setting(key, value,
                                     {.id = 0,
                                      .time = memory::now_ms(),
                                      .who = "service",
                                      .door = {},
                                      .action = "setting",
                                      .subject = key,
                                      .before = before.value_or(""),
                                      .after = value}));
  }
  return {};
}

Result<std::string> OperatorControl::make_line_token() const {
  // With keys the control end knows who comes in; without jobs there is nothing that a line could command.
  if (config_.keys || config_.jobs.empty()) return std::string{};
  BITELINE_ASSIGN(const std::string token, accounts::make_token());
  const mode_t before = ::umask(0077);
  const Result<void> written =
      report::write_file_atomically(config_.results / line_control::k_token_file, token + "\n");
  ::umask(before);
  if (!written) return tl::unexpected<Error>{written.error()};
  return token;
}

Result<void> OperatorControl::listen() {
  BITELINE_ASSIGN(std::string line_token, make_line_token());
  BITELINE_TRY(accounts::offer_first_account(accounts_, config_.results));
  const api::Catalogue own = catalogue_of(std::nullopt, config_.catalogue);
  api_ = std::make_unique<api::Api>(
      api::Rooms{.memory = memory_,
                 .accounts = accounts_,
                 .cell = *this,
                 .results = config_.results,
                 .processes = own.processes,
                 .models = own.models,
                 .exchange = api::Exchange{config_.results / ".exchange"},
                 .version = BITELINE_VERSION,
                 .publish =
                     [this](const std::string& name, Json data) {
                       if (server_) server_->publish(name, std::move(data));
                     },
                 .last_seq = [this] { return server_ ? server_->last_seq() : 0; },
                 .catalogue = [folders = config_.catalogue] { return catalogue_now(folders); },
                 .line_token = std::move(line_token),
                 .day = config_.day});
  reruns_ = std::make_unique<RerunWorker>(
      RerunRoom{.results = config_.results,
                .catalogue = config_.catalogue,
                .arm = config_.rerun_arm,
                .mounted = [this](const std::string& tool) -> Result<path::Mounted> {
                  BITELINE_ASSIGN(const mounted::Record record, mounted::read_record(memory_));
                  return record.mounted(tool);
                }},
      [this](const std::string& scan) { tell_scan(scan); });
  control::ServerConfig server;
  server.endpoint = *config_.endpoint;
  server.keys = config_.keys;
  std::error_code error;
  server.hello = {{"version", BITELINE_VERSION},
                  {"results", std::filesystem::absolute(config_.results, error).string()},
                  {"accounts", std::filesystem::absolute(config_.results, error).string()},
                  {"sensor", config_.sensor},
                  {"started", control::utc_now()}};
  BITELINE_ASSIGN(
      server_,
      control::Server::open(
          server, {.urgent = [this](const control::Request& request) { return api_->urgent(request); },
                   .ordinary = [this](const control::Request& request) { return api_->ordinary(request); },
                   .is_long = &api::Api::is_long,
                   .stops = [this] { return stops_.count(); }}));
  address_ = server_->address();
  return {};
}

void OperatorControl::command(OperatorCommand command) {
  const std::lock_guard lock{mutex_};
  command_locked(std::move(command));
}

void OperatorControl::command_locked(OperatorCommand command) {
  // The last of a kind counts, so there are never more than kinds and scans that were held.
  std::erase_if(commands_, [&](const OperatorCommand& other) {
    return other.kind == command.kind && other.scan == command.scan;
  });
  commands_.push_back(std::move(command));
}

std::optional<OperatorCommand> OperatorControl::next_command(bool of_held) {
  const std::lock_guard lock{mutex_};
  const auto next =
      std::ranges::find_if(commands_, [&](const OperatorCommand& one) { return of_held || !one.of_held(); });
  if (next == commands_.end()) return std::nullopt;
  OperatorCommand command = std::move(*next);
  commands_.erase(next);
  return command;
}

void OperatorControl::drop(const OperatorCommand& command) {
  const std::lock_guard lock{mutex_};
  if (command.kind == OperatorCommand::Kind::Mended && mending_ == command.scan) mending_.clear();
}

bool OperatorControl::wants_hold(const std::string& scan) const {
  const std::lock_guard lock{mutex_};
  return hold_all_ || hold_wanted_ == scan;
}

bool OperatorControl::wants_hold_at_last(const std::string& scan) {
  const std::lock_guard lock{mutex_};
  if (hold_all_ || hold_wanted_ == scan) return true;
  past_hold_ = scan;
  return false;
}

CellMachine OperatorControl::cell() const {
  const std::lock_guard lock{mutex_};
  return cell_;
}

void OperatorControl::enter(CellEvent event) {
  {
    const std::lock_guard lock{mutex_};
    if (!cell_.on(event)) return;
    published_ = {};
  }
  publish_state();
}

void OperatorControl::works(const std::string& scan) {
  const std::lock_guard lock{mutex_};
  shoe_scan_ = scan;
  cell_.on(CellEvent::Works);
}

void OperatorControl::hinder(Hindrance hindrance) {
  const std::lock_guard lock{mutex_};
  hindrance_ = hindrance;
}

void OperatorControl::show(const std::string& now, const std::string& next) {
  {
    const std::lock_guard lock{mutex_};
    if (now_ == now && next_ == next) return;
    now_ = now;
    next_ = next;
    if (cell_.sensing() != Sensing::Scanning) progress_.reset();
    published_ = {};
  }
  publish_state();
}

void OperatorControl::scan_begins(const std::string& scan) {
  const std::lock_guard lock{mutex_};
  scan_ = scan;
  cycle_.scan_begins();
  cell_.on(CellEvent::ScanBegins);
}

void OperatorControl::show_progress(std::uint64_t profiles, std::uint64_t expected) {
  {
    const std::lock_guard lock{mutex_};
    if (expected == 0) return;
    progress_ = std::min(1.0, static_cast<double>(profiles) / static_cast<double>(expected));
  }
  publish_state();
}

void OperatorControl::show_model(const std::string& name, double probability, const ShownProcess& process) {
  {
    const std::lock_guard lock{mutex_};
    model_ = name;
    model_probability_ = probability;
    process_ = process;
  }
  publish_state();
}

void OperatorControl::show_shoe(const ShownShoe& shoe) {
  {
    const std::lock_guard lock{mutex_};
    if (shoe_ == shoe) return;
    shoe_ = shoe;
    published_ = {};
  }
  publish_state();
}

void OperatorControl::show_next(const ShownProcess& process) {
  {
    const std::lock_guard lock{mutex_};
    if (process_.name == process.name && process_.by == process.by) return;
    process_ = process;
    published_ = {};
  }
  publish_state();
}

void OperatorControl::hear(const wire::SensorHello& hello) {
  const std::lock_guard lock{mutex_};
  hello_ = hello;
  sensor_lost_.clear();
}

void OperatorControl::hear(const wire::Health& health) {
  {
    const std::lock_guard lock{mutex_};
    health_ = health;
    sensor_lost_.clear();
  }
  publish_state();
}

void OperatorControl::lose_sensor(const std::string& why) {
  answer_sensor({}, fail(Errc::WrongState, "the sensor was lost before it answered: %s", why.c_str()));
  {
    const std::lock_guard lock{mutex_};
    sensor_lost_ = why;
    health_.reset();
  }
  give_up_start();
  publish_state();
}

void OperatorControl::hear(const Result<robot::ur::ControllerWords>& words, const std::string& wrong) {
  {
    const std::lock_guard lock{mutex_};
    robot_asked_ = true;
    robot_ = words ? std::optional{*words} : std::nullopt;
    robot_wrong_ = words ? wrong : to_line(words.error());
  }
  publish_state();
}

void OperatorControl::show_work(const std::string& words, bool asks) {
  {
    const std::lock_guard lock{mutex_};
    work_ = ShownWork{.words = words, .asks = asks};
    published_ = {};
  }
  publish_state();
}

void OperatorControl::show_centre(const std::string& words) {
  {
    const std::lock_guard lock{mutex_};
    if (centre_ == words) return;
    centre_ = words;
  }
  publish_state();
}

robot::StopMark OperatorControl::going() const {
  const std::lock_guard lock{mutex_};
  return go_;
}

std::optional<robot::StopMark> OperatorControl::begin_cycle() {
  const std::lock_guard lock{mutex_};
  if (cell_.going() != Going::Goes || go_.stopped()) return std::nullopt;
  if (const std::optional<double> whole_s = cycle_s_locked()) last_cycle_s_ = whole_s;
  this_cycle_ = Cycle{.begun = Clock::now(), .mark = go_};
  if (cycle_.on_demand()) cell_.on(CellEvent::Spent);
  return go_;
}

std::optional<double> OperatorControl::cycle_s() const {
  const std::lock_guard lock{mutex_};
  return cycle_s_locked();
}

std::optional<double> OperatorControl::cycle_s_locked() const {
  if (!this_cycle_ || this_cycle_->mark.stopped()) return std::nullopt;
  return std::chrono::duration<double>(Clock::now() - this_cycle_->begun).count();
}

void OperatorControl::hold(const HeldShown& held) {
  const std::lock_guard lock{mutex_};
  if (mending_ == held.scan) mending_.clear();
  shoe_scan_ = held.scan;
  if (held.mark.value_or(go_).stopped()) {
    ended_ = held.scan;
    return;
  }
  cell_.on(CellEvent::Holds);
  show_held_locked(held);
}

void OperatorControl::hold_on(const HeldShown& held) {
  const std::lock_guard lock{mutex_};
  if (holds_locked(held.scan)) show_held_locked(held);
}

void OperatorControl::show_held_locked(const HeldShown& held) {
  waits_ = held.waits;
  not_sendable_ = held.not_sendable;
  version_ = held.version;
  held_is_step_ = held.is_step;
  held_tool_ = held.tool;
  fresh_until_.reset();
  if (held.fresh_s)
    fresh_until_ = Clock::now() +
                   std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*held.fresh_s));
  published_ = {};
}

bool OperatorControl::mends(const std::string& scan) const {
  const std::lock_guard lock{mutex_};
  return mending_ == scan;
}

void OperatorControl::tell_scan(const std::string& scan) {
  if (!server_) return;
  const Result<std::optional<memory::Scan>> row = memory_.scan(scan);
  if (row && *row) server_->publish("scan", api::to_json(**row));
  // What is being taught goes on with it, also while no page asks.
  if (api_) static_cast<void>(api_->teaching_json());
}

void OperatorControl::publish_state() {
  if (!server_) return;
  Json state;
  {
    const std::lock_guard lock{mutex_};
    const Clock::time_point now = Clock::now();
    if (now - published_ < k_between_states) return;
    published_ = now;
    state = state_locked();
  }
  if (const std::optional<accounts::Holder> holder = accounts_.holder()) {
    state["control"] = {
        {"holder", holder->name}, {"door", holder->door}, {"since", memory::to_iso(holder->since)}};
  } else {
    state["control"] = {{"holder", nullptr}};
  }
  state["seq"] = server_->last_seq() + 1;
  server_->publish("state", std::move(state));
}

}  // namespace biteline::service
