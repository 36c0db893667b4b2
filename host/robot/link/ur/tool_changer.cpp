// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/tool_changer.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "common/rtde/client_session.hpp"
#include "host/robot/link/ur/tcp_stream.hpp"

namespace biteline::robot::ur {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr Nanoseconds k_changer_turn{20'000'000};
constexpr Nanoseconds k_changer_answer{2'000'000'000};
constexpr Seconds k_changer_silent{1};
/// Contacts of a lock bounce; the controller's cycles are a hundredth of it.
constexpr Seconds k_stands_for{0.2};
constexpr double k_changer_hz = 125;  // each controller has it
constexpr double k_turning_room_mm = 10;

std::uint64_t bit(int line) {
  return std::uint64_t{1} << static_cast<unsigned>(line);
}

/// One exchange with the changer, over a connection of its own.
class Exchange final : public rtde::ClientListener {
 public:
  Exchange(const ChangerAddress& at, const path::Changer& changer, std::string in_the_way,
           const StopMark& mark)
      : at_{at},
        in_the_way_{std::move(in_the_way)},
        mark_{mark},
        wanted_{bit(changer.wanted.ask_output)},
        there_{bit(changer.wanted.there_input)} {
    asks_ = wanted_;
    places_ = there_;
    for (const path::ChangerLines& other : changer.others) {
      asks_ |= bit(other.ask_output);
      places_ |= bit(other.there_input);
    }
  }

  Result<void> run() {
    BITELINE_ASSIGN(stream_, TcpStream::connect({at_.host, at_.rtde_port}, k_changer_answer));
    session_.start();
    heard_ = Clock::now();
    Result<void> done = wait_for_tool();
    if (!done && asked_) let_go();
    return done;
  }

  void on_data(std::size_t, std::span<const rtde::Value> values) override {
    const bool stands = (std::get<std::uint64_t>(values[0]) & places_) == there_;
    if (!stands) since_.reset();
    if (stands && !since_) since_ = Clock::now();
    known_ = true;
  }
  void on_text(const rtde::TextMessage&) override {}

 private:
  Result<void> wait_for_tool() {
    const Clock::time_point begin = Clock::now();
    while (!(since_ && Clock::now() - *since_ >= k_stands_for)) {
      if (mark_.stopped()) return fail(Errc::WrongState, "the change of the tool was stopped");
      if (Clock::now() - begin > Seconds{at_.patience_s})
        return fail(Errc::Timeout, "the changer does not tell within %.0f s that the tool stands",
                    at_.patience_s);
      if (known_ && !since_ && !asked_) {
        if (!in_the_way_.empty()) return fail(Errc::CheckFailed, "%.200s", in_the_way_.c_str());
        ask(wanted_);
      }
      BITELINE_TRY(exchange());
    }
    return {};
  }
  Result<void> exchange() {
    BITELINE_TRY(stream_.write_all(session_.outgoing(), k_changer_answer));
    session_.outgoing().clear();
    BITELINE_TRY(stream_.read_some(bytes_, k_changer_turn));
    if (!bytes_.empty()) heard_ = Clock::now();
    if (const Result<void> taken = session_.consume(bytes_, *this); !taken)
      return session_.refused()
                 ? fail(Errc::PeerRefused, "the controller's outputs: %.200s", to_line(taken.error()).c_str())
                 : Result<void>{tl::unexpected<Error>{taken.error()}};
    if (Clock::now() - heard_ > k_changer_silent)
      return fail(Errc::ConnectionLost, "%.60s: silent", at_.host.c_str());
    return {};
  }
  void ask(std::uint64_t outputs) {
    const std::array<rtde::Value, 2> values{static_cast<std::uint8_t>(asks_),
                                            static_cast<std::uint8_t>(outputs)};
    session_.send_inputs(0, values);
    asked_ = true;
  }
  void let_go() {
    if (!session_.running()) return;
    ask(0);
    static_cast<void>(stream_.write_all(session_.outgoing(), k_changer_answer));
  }

  ChangerAddress at_;
  std::string in_the_way_;
  StopMark mark_;
  std::uint64_t wanted_{0}, asks_{0};   // outputs, as bits
  std::uint64_t there_{0}, places_{0};  // inputs
  rtde::ClientSession session_{
      {.outputs = {{.variables = {{"actual_digital_input_bits", rtde::FieldType::Uint64}},
                    .frequency_hz = k_changer_hz}},
       .inputs = {{{"standard_digital_output_mask", rtde::FieldType::Uint8},
                   {"standard_digital_output", rtde::FieldType::Uint8}}}}};
  TcpStream stream_;
  std::vector<std::uint8_t> bytes_;
  Clock::time_point heard_;
  std::optional<Clock::time_point> since_;  // it stands
  bool known_{false}, asked_{false};
};

}  // namespace

Result<void> change_tool(const ChangerAddress& at, const path::Changer& changer,
                         const std::string& in_the_way, const StopMark& mark) {
  Exchange exchange{at, changer, in_the_way, mark};
  return exchange.run();
}

double room_to_change_mm(const path::Changer& changer, const path::Tool& tool) {
  const double reach_mm = std::max(changer.reach_mm, tool.T_flange_tcp.translation().norm());
  return reach_mm + tool.body_radius_mm + k_turning_room_mm;
}

}  // namespace biteline::robot::ur
