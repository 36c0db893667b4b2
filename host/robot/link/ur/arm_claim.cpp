// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/arm_claim.hpp"

#include <chrono>
#include <utility>
#include <vector>

#include "common/rtde/client_session.hpp"
#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {
namespace {

using std::chrono::milliseconds;

constexpr Nanoseconds k_poll{50'000'000};
constexpr Nanoseconds k_patience{2'000'000'000};
constexpr milliseconds k_retry{300};
/// Something must come, so that a connection that broke without a word is found.
constexpr double k_sign_of_life_hz = 2;
constexpr std::chrono::seconds k_silent{5};

struct Deaf final : rtde::ClientListener {
  void on_data(std::size_t, std::span<const rtde::Value>) override {}
  void on_text(const rtde::TextMessage&) override {}
};

std::string variable_of(int number) {
  return "input_int_register_" + std::to_string(number);
}

}  // namespace

Result<std::unique_ptr<ArmClaim>> ArmClaim::take(const Config& config) {
  std::unique_ptr<ArmClaim> claim{new ArmClaim{config}};
  claim->thread_ = std::thread{[raw = claim.get()] { raw->run(); }};
  std::unique_lock lock{claim->mutex_};
  claim->changed_.wait_for(lock, std::chrono::duration<double>{config.patience_s},
                           [&] { return claim->safe(); });
  lock.unlock();
  if (claim->state() != State::Taken) return claim;
  return fail(Errc::PeerRefused, "robot %.100s: another service holds this arm (its %s is in use)",
              config.host.c_str(), variable_of(config.input_register).c_str());
}

ArmClaim::~ArmClaim() {
  {
    const std::lock_guard lock{mutex_};
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void ArmClaim::set(State state) {
  {
    const std::lock_guard lock{mutex_};
    state_ = state;
  }
  changed_.notify_all();
}

void ArmClaim::run() {
  rtde::ClientSession session{{.outputs = {{.variables = {{"timestamp", rtde::FieldType::Double}},
                                            .frequency_hz = k_sign_of_life_hz}},
                               .inputs = {{{variable_of(config_.input_register), rtde::FieldType::Int32}}}}};
  while (!stopping_) {
    const Result<void> ended = keep(session);
    const std::string_view why = ended ? std::string_view{} : ended.error().where.view();
    const bool refused = session.refused();
    set(refused && why.find("IN_USE") != std::string_view::npos      ? State::Taken
        : refused && why.find("NOT_FOUND") != std::string_view::npos ? State::Lacking
                                                                     : State::Away);
    std::unique_lock lock{mutex_};
    changed_.wait_for(lock, k_retry, [this] { return stopping_.load(); });
  }
}

Result<void> ArmClaim::keep(rtde::ClientSession& session) {
  BITELINE_ASSIGN(TcpStream stream, TcpStream::connect({config_.host, config_.rtde_port}, k_patience));
  session.start();
  Deaf deaf;
  std::vector<std::uint8_t> bytes;
  auto heard = std::chrono::steady_clock::now();
  std::uint32_t written = beats_;
  while (!stopping_) {
    const std::uint32_t beats = beats_;
    const bool beaten = session.running() && beats != std::exchange(written, beats);
    if (beaten) {
      // A register has a sign.
      const rtde::Value count{static_cast<std::int32_t>(beats & 0x7fffffffU)};
      session.send_inputs(0, {&count, 1});
    }
    BITELINE_TRY(stream.write_all(session.outgoing(), k_patience));
    session.outgoing().clear();
    BITELINE_TRY(stream.read_some(bytes, beaten ? k_write : k_poll));
    if (!bytes.empty()) heard = std::chrono::steady_clock::now();
    BITELINE_TRY(session.consume(bytes, deaf));
    if (session.running() && state_ != State::Held) set(State::Held);
    if (std::chrono::steady_clock::now() - heard > k_silent)
      return fail(Errc::ConnectionLost, "%.60s: silent", config_.host.c_str());
  }
  return {};
}

}  // namespace biteline::robot::ur
