// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/cockpit.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace biteline::service {
namespace {

using api::Json;

constexpr std::size_t k_most_wishes = 64;
constexpr std::chrono::milliseconds k_between_states{200};
constexpr std::chrono::seconds k_silent{2};
constexpr std::array k_phases{"starting", "waiting",   "scanning", "working",
                              "deciding", "following", "stopped",  "fault"};

Json lamp(const char* level, const std::string& words) {
  return {{"level", level}, {"words", words}};
}

Json clock_json(const wire::ClockState& clock) {
  return {{"name", clock.name},
          {"known", clock.known},
          {"offset_ns", clock.offset.count()},
          {"uncertainty_ns", clock.uncertainty.count()},
          {"drift_ppm", clock.drift_ppm},
          {"steps", clock.steps}};
}

Json laser_lamp(const wire::Health& health) {
  switch (health.laser) {
    case wire::LaserState::Off:
      return lamp("off", health.laser_reason.empty() ? "off" : "off: " + health.laser_reason);
    case wire::LaserState::On:
      return lamp("ok", "on");
    case wire::LaserState::Fault:
      return lamp("fault", "off by a fault: " + health.laser_reason);
  }
  return lamp("unknown", "not known");
}

Json clock_lamp(const wire::Devices& devices) {
  if (devices.clocks.empty()) return lamp("ok", "one clock");
  std::string unknown;
  for (const wire::ClockState& clock : devices.clocks) {
    if (!clock.known) unknown += (unknown.empty() ? "" : ", ") + clock.name;
  }
  if (!unknown.empty()) return lamp("warning", "not known yet: " + unknown);
  return lamp("ok", std::to_string(devices.clocks.size()) + " known");
}

}  // namespace

Result<std::unique_ptr<Cockpit>> Cockpit::open(const CockpitConfig& config) {
  BITELINE_ASSIGN(memory::Memory memory, memory::Memory::open(config.results / memory::k_memory_file));
  std::unique_ptr<Cockpit> cockpit{new Cockpit{config, std::move(memory)}};
  if (config.endpoint) BITELINE_TRY(cockpit->listen());
  return cockpit;
}

Cockpit::Cockpit(CockpitConfig config, memory::Memory memory)
    : config_{std::move(config)}, memory_{std::move(memory)}, accounts_{memory_}, cycle_{config_.jobs} {
  process_ = config_.process;
  paused_ = cycle_.on_demand();
}

Cockpit::~Cockpit() {
  // Its thread tells the server, the server's threads give it work: it ends first and is asked no more.
  if (reruns_) reruns_->end();
}

Result<void> Cockpit::listen() {
  api_ = std::make_unique<api::Api>(
      api::Rooms{.memory = memory_,
                 .accounts = accounts_,
                 .cell = *this,
                 .results = config_.results,
                 .processes = api::ProcessStore{config_.shipped_processes, config_.results / "processes"},
                 .models = transfer::Library{config_.library},
                 .version = BITELINE_VERSION,
                 .publish =
                     [this](const std::string& name, Json data) {
                       if (server_) server_->publish(name, std::move(data));
                     },
                 .last_seq = [this] { return server_ ? server_->last_seq() : 0; }});
  reruns_ = std::make_unique<RerunWorker>(
      RerunRoom{.results = config_.results,
                .processes = api::ProcessStore{config_.shipped_processes, config_.results / "processes"},
                .models = transfer::Library{config_.library},
                .arm = config_.rerun_arm},
      [this](const std::string& scan) { tell_scan(scan); });
  control::ServerConfig server;
  server.endpoint = *config_.endpoint;
  server.keys = config_.keys;
  std::error_code error;
  server.hello = {{"version", BITELINE_VERSION},
                  {"results", std::filesystem::absolute(config_.results, error).string()},
                  {"sensor", config_.sensor},
                  {"started", control::utc_now()}};
  BITELINE_ASSIGN(
      server_,
      control::Server::open(
          server, {.urgent = [this](const control::Request& request) { return api_->urgent(request); },
                   .ordinary = [this](const control::Request& request) { return api_->ordinary(request); }}));
  address_ = server_->address();
  return {};
}

void Cockpit::wish(Wish wish) {
  const std::lock_guard lock{mutex_};
  // Nobody wishes so much but by a fault; a stop has taken effect already.
  if (wishes_.size() < k_most_wishes) wishes_.push_back(std::move(wish));
}

std::optional<Wish> Cockpit::next_wish() {
  const std::lock_guard lock{mutex_};
  if (wishes_.empty()) return std::nullopt;
  Wish wish = std::move(wishes_.front());
  wishes_.pop_front();
  return wish;
}

bool Cockpit::wants_hold(const std::string& scan) const {
  const std::lock_guard lock{mutex_};
  return hold_wanted_ == scan;
}

void Cockpit::show(Phase phase, const std::string& now, const std::string& next) {
  {
    const std::lock_guard lock{mutex_};
    if (phase_ == phase && now_ == now && next_ == next) return;
    phase_ = phase;
    now_ = now;
    next_ = next;
    if (phase != Phase::Scanning) progress_.reset();
    published_ = {};
  }
  publish_state();
}

void Cockpit::show_scan(const std::string& scan) {
  const std::lock_guard lock{mutex_};
  scan_ = scan;
  cycle_.scan_begins();
}

void Cockpit::show_progress(std::uint64_t profiles, std::uint64_t expected) {
  {
    const std::lock_guard lock{mutex_};
    if (expected == 0) return;
    progress_ = std::min(1.0, static_cast<double>(profiles) / static_cast<double>(expected));
  }
  publish_state();
}

void Cockpit::show_model(const std::string& name, double probability, const std::string& process) {
  {
    const std::lock_guard lock{mutex_};
    model_ = name;
    model_probability_ = probability;
    process_ = process;
  }
  publish_state();
}

void Cockpit::hear(const wire::SensorHello& hello) {
  const std::lock_guard lock{mutex_};
  hello_ = hello;
  sensor_lost_.clear();
  heard_ = Clock::now();
}

void Cockpit::hear(const wire::Health& health) {
  {
    const std::lock_guard lock{mutex_};
    health_ = health;
    sensor_lost_.clear();
    heard_ = Clock::now();
  }
  publish_state();
}

void Cockpit::lose_sensor(const std::string& why) {
  {
    const std::lock_guard lock{mutex_};
    sensor_lost_ = why;
    health_.reset();
  }
  give_up_start();
  publish_state();
}

void Cockpit::hear(const Result<robot::ur::ControllerWords>& words, const std::string& wrong) {
  {
    const std::lock_guard lock{mutex_};
    robot_asked_ = true;
    robot_ = words ? std::optional{*words} : std::nullopt;
    robot_wrong_ = words ? wrong : to_line(words.error());
  }
  publish_state();
}

void Cockpit::begin_cycle() {
  const std::lock_guard lock{mutex_};
  const Clock::time_point now = Clock::now();
  if (cycle_begun_) last_cycle_s_ = std::chrono::duration<double>(now - *cycle_begun_).count();
  cycle_begun_ = now;
  if (cycle_.on_demand()) paused_ = true;
}

double Cockpit::cycle_s() const {
  const std::lock_guard lock{mutex_};
  return cycle_begun_ ? std::chrono::duration<double>(Clock::now() - *cycle_begun_).count() : 0;
}

void Cockpit::hold(const std::string& scan, Wait wait) {
  const std::lock_guard lock{mutex_};
  held_ = scan;
  wait_ = wait;
  if (mending_ == scan) mending_.clear();
  if (scan.empty()) hold_wanted_.clear();
}

void Cockpit::tell_scan(const std::string& scan) {
  if (!server_) return;
  const Result<std::optional<memory::Scan>> row = memory_.scan(scan);
  if (row && *row) server_->publish("scan", api::to_json(**row));
}

void Cockpit::publish_state() {
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

Json Cockpit::state_locked() const {
  const bool connected = sensor_lost_.empty();
  Json lamps;
  if (!connected || !health_) {
    const Json away =
        connected ? lamp("unknown", "not told yet") : lamp("unknown", "sensor: " + sensor_lost_);
    for (const char* name : {"laser", "camera", "poses", "clock"}) lamps[name] = away;
  } else {
    const wire::Devices& devices = health_->devices;
    lamps["laser"] = laser_lamp(*health_);
    lamps["camera"] = devices.camera_connected ? lamp("ok", "connected") : lamp("warning", "not open");
    lamps["poses"] = devices.poses_flow ? lamp("ok", "come in") : lamp("warning", "none come in");
    lamps["clock"] = clock_lamp(devices);
  }
  if (config_.arm.empty()) {
    lamps["robot"] = lamp("off", "none: lines are found, no path is planned");
  } else if (!robot_asked_) {
    lamps["robot"] = lamp("unknown", "not asked yet");
  } else {
    lamps["robot"] = robot_wrong_.empty() ? lamp("ok", "ready") : lamp("fault", robot_wrong_);
  }
  const bool simulated = hello_ && hello_->simulated;
  Json state{
      {"version", BITELINE_VERSION},
      {"simulated", simulated},
      {"phase", k_phases.at(static_cast<std::size_t>(phase_))},
      {"now", now_},
      {"next", next_},
      {"scan", api::or_null(scan_)},
      {"progress", api::or_null(progress_)},
      {"lamps", std::move(lamps)},
      {"cycle",
       {{"this_s",
         cycle_begun_ ? Json(std::chrono::duration<double>(Clock::now() - *cycle_begun_).count()) : Json{}},
        {"last_s", api::or_null(last_cycle_s_)}}},
      {"model", nullptr},
      {"process", api::or_null(process_)}};
  if (!model_.empty()) state["model"] = {{"name", model_}, {"probability", model_probability_}};
  return state;
}

Json Cockpit::state() {
  const std::lock_guard lock{mutex_};
  return state_locked();
}

Json Cockpit::robots() {
  const std::lock_guard lock{mutex_};
  if (config_.arm.empty()) return Json::array();
  Json robot{{"name", config_.arm},
             {"address", config_.controller},
             {"serial", nullptr},
             {"connected", robot_.has_value()},
             {"powered", nullptr},
             {"remote", nullptr},
             {"ready", robot_asked_ && robot_wrong_.empty()},
             {"words", robot_asked_ ? robot_wrong_ : "not asked yet"}};
  if (robot_) {
    if (robot_->serial) robot["serial"] = *robot_->serial;
    if (robot_->remote) robot["remote"] = *robot_->remote;
    if (robot_->robot_mode)
      robot["powered"] = *robot_->robot_mode == "RUNNING" || *robot_->robot_mode == "IDLE";
  }
  return Json::array({std::move(robot)});
}

Json Cockpit::sensors() {
  const std::lock_guard lock{mutex_};
  const bool connected = sensor_lost_.empty() && hello_;
  Json sensor{
      {"name", hello_ ? hello_->name : "sensor"}, {"address", config_.sensor}, {"connected", connected}};
  if (hello_) {
    sensor["version"] = hello_->version;
    sensor["simulated"] = hello_->simulated;
  }
  if (!connected) {
    sensor["fault"] = sensor_lost_;
    sensor["next_step"] = "check the sensor's power and network";
    return Json::array({std::move(sensor)});
  }
  if (!health_) return Json::array({std::move(sensor)});
  const wire::Health& health = *health_;
  constexpr std::array k_lasers{"off", "on", "fault"};
  sensor["scanning"] = health.scanning;
  sensor["laser"] = k_lasers.at(static_cast<std::size_t>(health.laser));
  sensor["laser_reason"] = health.laser_reason;
  sensor["camera_connected"] = health.devices.camera_connected;
  sensor["poses_flow"] = health.devices.poses_flow;
  sensor["realtime"] = health.devices.realtime;
  sensor["temperature_degc"] =
      health.devices.temperature_degc ? Json(*health.devices.temperature_degc) : Json{};
  const wire::Counters& counters = health.counters;
  for (const auto& [name, count] :
       {std::pair{"frames", counters.frames}, std::pair{"frames_lost", counters.frames_lost},
        std::pair{"frames_damaged", counters.frames_damaged}, std::pair{"profiles", counters.profiles},
        std::pair{"profiles_dropped", counters.profiles_dropped},
        std::pair{"messages_lost", counters.messages_lost}, std::pair{"poses_lost", counters.poses_lost},
        std::pair{"overruns", counters.overruns}}) {
    sensor[name] = count;
  }
  sensor["clocks"] = Json::array();
  for (const wire::ClockState& clock : health.devices.clocks) sensor["clocks"].push_back(clock_json(clock));
  const bool fault = health.laser == wire::LaserState::Fault;
  sensor["fault"] = fault ? Json(health.laser_reason) : Json{};
  sensor["next_step"] = fault ? Json("remove the cause, then start again") : Json{};
  return Json::array({std::move(sensor)});
}

void Cockpit::stop(const std::string& who) {
  halted_ = true;
  pause_by_person();
  wish({.kind = Wish::Kind::Stop, .scan = {}, .who = who, .why = {}});
}

void Cockpit::laser_off(const std::string& who) {
  halted_ = true;
  pause_by_person();
  wish({.kind = Wish::Kind::LaserOff, .scan = {}, .who = who, .why = {}});
}

Result<void> Cockpit::start(const api::Job& job, const std::string& who) {
  {
    const std::lock_guard lock{mutex_};
    if (!held_.empty())
      return fail(Errc::WrongState, "%s waits for a person; accept or reject it first", held_.c_str());
    if (cycle_.on_demand() && cycle_.busy())
      return fail(Errc::WrongState, "a scan is in work, and each start is one scan; wait for its end");
    cycle_.begin(0);
    stopped_ = false;
  }
  go(job, who);
  return {};
}

void Cockpit::go(const api::Job& job, const std::string& who) {
  halted_ = false;
  paused_ = false;
  wish({.kind = Wish::Kind::Start, .scan = {}, .who = who, .why = {}, .job = job});
}

Result<void> Cockpit::rescan(const std::string& who, const std::string& why, const std::string& door) {
  std::string held;
  {
    const std::lock_guard lock{mutex_};
    if (phase_ == Phase::Following) return fail(Errc::WrongState, "the arm follows a path; stop it first");
    held = held_;
    if (held.empty() && cycle_.on_demand() && cycle_.busy())
      return fail(Errc::WrongState, "a scan is in work; wait for its end, or stop it first");
  }
  if (!held.empty())
    BITELINE_TRY(decide({.kind = api::Decision::Kind::Reject,
                         .scan = held,
                         .who = who,
                         .why = "scanned again: " + why,
                         .door = door}));
  {
    const std::lock_guard lock{mutex_};
    cycle_.begin(0);
    stopped_ = false;
  }
  halted_ = false;
  paused_ = false;
  wish({.kind = Wish::Kind::Rescan, .scan = {}, .who = who, .why = why});
  return {};
}

Result<void> Cockpit::decide(const api::Decision& decision) {
  using enum api::Decision::Kind;
  bool held = false;
  Wait wait = Wait::Word;
  {
    const std::lock_guard lock{mutex_};
    if (mending_ == decision.scan)
      return fail(Errc::WrongState, "%s is being mended; decide when its path is checked", mending_.c_str());
    held = held_ == decision.scan;
    wait = wait_;
    if (decision.kind == Hold && !held && scan_ == decision.scan &&
        (phase_ == Phase::Scanning || phase_ == Phase::Working)) {
      hold_wanted_ = decision.scan;
    } else if (decision.kind == Hold && !held) {
      return fail(Errc::WrongState, "%s is not in work any more; nothing is left to hold",
                  decision.scan.c_str());
    }
  }
  BITELINE_ASSIGN(std::optional<memory::Scan> scan, memory_.scan(decision.scan));
  if (!scan) {
    // In work: it has no row yet.
    if (decision.kind != Hold)
      return fail(Errc::FileNotFound, "%s among the finished scans", decision.scan.c_str());
    scan.emplace();
    scan->name = decision.scan;
    scan->time = memory::now_ms();
    scan->verdict = "working";
  }
  const bool sends = decision.kind == Accept || decision.kind == Send;
  if (sends && held && wait == Wait::Model)
    return fail(Errc::WrongState, "the model of %s is not known; choose one, or reject it",
                decision.scan.c_str());
  if (sends && held && wait == Wait::Mend)
    return fail(Errc::WrongState, "%s has no checked path with its mended line; mend it again, or reject it",
                decision.scan.c_str());
  if (sends && !held)
    return fail(Errc::WrongState, "%s does not wait for a word; scan the shoe again", decision.scan.c_str());
  if (decision.kind == Reject && scan->sent)
    return fail(Errc::WrongState, "%s was sent already", decision.scan.c_str());
  const std::string before = scan->decision;
  scan->decision = sends ? "accepted" : decision.kind == Reject ? "rejected" : "held";
  scan->decided_by = decision.who;
  scan->decided_at = memory::now_ms();
  scan->why = decision.why;
  BITELINE_TRY(memory_.put_scan(*scan, {.id = 0,
                                        .time = *scan->decided_at,
                                        .who = decision.who,
                                        .door = decision.door,
                                        .action = scan->decision,
                                        .subject = decision.scan,
                                        .before = before,
                                        .after = decision.why}));
  if (held && decision.kind != Hold) {
    hold("");
    if (sends) halted_ = false;
    if (!sends) end_cycle(*scan);
    wish({.kind = sends ? Wish::Kind::Send : Wish::Kind::Reject,
          .scan = decision.scan,
          .who = decision.who,
          .why = decision.why});
  }
  tell_scan(decision.scan);
  return {};
}

Result<void> Cockpit::choose_model(const std::string& scan, const std::string& model,
                                   const std::string& who) {
  {
    const std::lock_guard lock{mutex_};
    if (held_ != scan || wait_ != Wait::Model)
      return fail(Errc::WrongState, "%s does not wait for its model", scan.c_str());
    held_.clear();
    hold_wanted_.clear();
  }
  wish({.kind = Wish::Kind::Model,
        .scan = scan,
        .who = who,
        .why = {},
        .job = {.model = model, .process = {}}});
  return {};
}

Result<void> Cockpit::begin_mend(const std::string& scan) {
  const std::lock_guard lock{mutex_};
  if (held_ == scan && wait_ == Wait::Model)
    return fail(Errc::WrongState, "the model of %s is not known; choose one first", scan.c_str());
  if (!mending_.empty()) return fail(Errc::WrongState, "%s is being mended; wait for it", mending_.c_str());
  if (scan_ == scan && held_ != scan &&
      (phase_ == Phase::Scanning || phase_ == Phase::Working || phase_ == Phase::Following))
    return fail(Errc::WrongState, "%s is in work; mend it when it is done", scan.c_str());
  mending_ = scan;
  return {};
}

void Cockpit::end_mend(const std::string& scan, bool mended, const std::string& who) {
  {
    const std::lock_guard lock{mutex_};
    if (!mended || held_ != scan) {
      mending_.clear();
      return;
    }
  }
  // What waits gets its path planned anew; until then nobody can accept it.
  wish({.kind = Wish::Kind::Mended, .scan = scan, .who = who, .why = {}});
}

Result<int> Cockpit::rerun(const api::RerunOrder& order) {
  {
    const std::lock_guard lock{mutex_};
    if (scan_ == order.scan && held_ != order.scan && (phase_ == Phase::Scanning || phase_ == Phase::Working))
      return fail(Errc::WrongState, "%s is in work; wait for its result", order.scan.c_str());
  }
  return reruns_->add(order);
}

bool Cockpit::rerun_open(const std::string& scan, int number) {
  return reruns_->open(scan, number);
}

}  // namespace biteline::service
