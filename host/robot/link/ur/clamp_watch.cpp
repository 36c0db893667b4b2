// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/clamp_watch.hpp"

#include <pthread.h>

#include <chrono>
#include <variant>
#include <vector>

#include "common/rtde/client_session.hpp"
#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {
namespace {

constexpr Nanoseconds k_clamp_turn{50'000'000};
constexpr Nanoseconds k_clamp_patience{2'000'000'000};
constexpr Nanoseconds k_clamp_silent{1'000'000'000};
constexpr Nanoseconds k_clamp_fresh{500'000'000};  // by this machine's clock: it may be late itself
constexpr std::chrono::milliseconds k_clamp_retry{300};
constexpr double k_clamp_hz = 125;  // each controller has it

HostClock::time_point clamp_now() {
  return HostClock::time_point{
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}

}  // namespace

class ClampWatch::Reader final : public rtde::ClientListener {
 public:
  explicit Reader(ClampWatch& watch) : watch_{watch} {}
  void on_data(std::size_t, std::span<const rtde::Value> values) override {
    watch_.take(std::get<double>(values[0]), std::get<std::uint64_t>(values[1]));
  }
  void on_text(const rtde::TextMessage&) override {}

 private:
  ClampWatch& watch_;
};

ClampWatch::ClampWatch(const Config& config) : config_{config}, thread_{[this] { run(); }} {}

ClampWatch::~ClampWatch() {
  {
    const std::lock_guard lock{mutex_};
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::optional<HostClock::time_point> ClampWatch::held_since() const {
  const std::lock_guard lock{mutex_};
  return clamp_now() - heard_ <= k_clamp_fresh ? since_ : std::nullopt;
}

void ClampWatch::run() {
  pthread_setname_np(pthread_self(), "bl-clamp");
  rtde::ClientSession session{
      {.outputs = {{.variables = {{"timestamp", rtde::FieldType::Double},
                                  {"actual_digital_input_bits", rtde::FieldType::Uint64}},
                    .frequency_hz = k_clamp_hz}},
       .inputs = {}}};
  while (!stopping_) {
    static_cast<void>(watch(session));
    begin_afresh();
    std::unique_lock lock{mutex_};
    changed_.wait_for(lock, k_clamp_retry, [this] { return stopping_.load(); });
  }
}

Result<void> ClampWatch::watch(rtde::ClientSession& session) {
  BITELINE_ASSIGN(TcpStream stream, TcpStream::connect({config_.host, config_.rtde_port}, k_clamp_patience));
  session.start();
  Reader reader{*this};
  std::vector<std::uint8_t> bytes;
  HostClock::time_point heard = clamp_now();
  while (!stopping_) {
    BITELINE_TRY(stream.write_all(session.outgoing(), k_clamp_patience));
    session.outgoing().clear();
    BITELINE_TRY(stream.read_some(bytes, k_clamp_turn));
    if (!bytes.empty()) heard = clamp_now();
    BITELINE_TRY(session.consume(bytes, reader));
    if (clamp_now() - heard > k_clamp_silent)
      return fail(Errc::ConnectionLost, "%.60s: silent", config_.host.c_str());
  }
  return {};
}

void ClampWatch::take(double stamp_s, std::uint64_t inputs) {
  const std::lock_guard lock{mutex_};
  const double most_s = std::chrono::duration<double>{config_.most_gap}.count();
  // A clock that went back is one of a controller that was started anew; NaN is no clock.
  const bool follows = stamp_s_ && stamp_s >= *stamp_s_ && stamp_s - *stamp_s_ <= most_s;
  const bool held = (inputs >> static_cast<unsigned>(config_.input) & 1U) != 0;
  heard_ = clamp_now();
  if (!held || !follows) since_.reset();
  if (held && !since_) since_ = heard_;
  stamp_s_ = stamp_s;
}

void ClampWatch::begin_afresh() {
  const std::lock_guard lock{mutex_};
  stamp_s_.reset();
  since_.reset();
}

}  // namespace biteline::robot::ur
