// SPDX-License-Identifier: MIT
// Modbus TCP.  What comes is judged here; libmodbus sees only requests whose lengths and numbers are sound,
// and writes the answers.  Its own waiting (0.5 s after a wrong request) and flushing are never met.
#include <modbus.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "host/apps/biteline-web/line/line_talk.hpp"
#include "host/interfaces/line_control/part_number.hpp"

namespace biteline::web {
namespace {

// Modbus Messaging on TCP/IP 1.0b: transaction, protocol (0), length of what follows, unit; then the
// function.
constexpr std::size_t k_header_bytes = 6;
constexpr std::size_t k_function_at = 7;
constexpr std::size_t k_least_length = 2;  // unit and function
constexpr std::size_t k_most_length = 254;
// Function, address and count, or address and value.
constexpr std::size_t k_short_pdu_bytes = 5;
constexpr int k_job_at = 0;
constexpr int k_start_at = 1;
constexpr int k_stop_at = 2;
constexpr int k_part_at = 3;
constexpr int k_holding = k_part_at + static_cast<int>(line_control::k_part_registers);
/// Behind the values: the part number of the last scan.
constexpr int k_input_registers = static_cast<int>(line_control::k_values + line_control::k_part_registers);
constexpr int k_inputs = 5;

int word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] << 8 | bytes[at + 1];
}

/// The exception of Modbus Application Protocol 1.1b3, section 6, that a whole request deserves; 0: none.
int judge(std::span<const std::uint8_t> pdu) {
  const bool whole = pdu.size() >= k_short_pdu_bytes;
  const int count = whole ? word_at(pdu, 3) : 0;
  switch (pdu[0]) {
    case MODBUS_FC_READ_COILS:
    case MODBUS_FC_READ_DISCRETE_INPUTS:
      if (pdu.size() == k_short_pdu_bytes && count >= 1 && count <= MODBUS_MAX_READ_BITS) return 0;
      return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    case MODBUS_FC_READ_HOLDING_REGISTERS:
    case MODBUS_FC_READ_INPUT_REGISTERS:
      if (pdu.size() == k_short_pdu_bytes && count >= 1 && count <= MODBUS_MAX_READ_REGISTERS) return 0;
      return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    case MODBUS_FC_WRITE_SINGLE_REGISTER:
      return pdu.size() == k_short_pdu_bytes ? 0 : MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    case MODBUS_FC_WRITE_MULTIPLE_REGISTERS:
      if (pdu.size() > k_short_pdu_bytes && count >= 1 && count <= MODBUS_MAX_WRITE_REGISTERS &&
          pdu[5] == 2 * count && pdu.size() == 6 + std::size_t{pdu[5]})
        return 0;
      return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    default:
      return MODBUS_EXCEPTION_ILLEGAL_FUNCTION;
  }
}

void take_register(LineCommand& command, int address, int value) {
  if (address == k_job_at) command.job = value;
  // 0 stands for "no start": controls write it to put their register back.
  if (address == k_start_at && value > 0) command.start = value;
  if (address == k_stop_at && value > 0) command.stop = true;
}

/// A part number is written whole: a piece of it alone would be another one.  The exception, as of judge().
int take_part(LineCommand& command, int address, std::span<const std::uint16_t> values) {
  if (address + std::ssize(values) <= k_part_at) return 0;
  if (address > k_part_at) return MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS;
  command.part = line_control::part_of(values.subspan(static_cast<std::size_t>(k_part_at - address)));
  return command.part ? 0 : MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
}

/// What a sound request writes; nothing where a part of it lies beyond the registers: it is refused whole.
void take_writes(LineCommand& command, std::span<const std::uint8_t> pdu) {
  const int address = word_at(pdu, 1);
  std::vector<std::uint16_t> values;
  if (pdu[0] == MODBUS_FC_WRITE_SINGLE_REGISTER)
    values.push_back(static_cast<std::uint16_t>(word_at(pdu, 3)));
  if (pdu[0] == MODBUS_FC_WRITE_MULTIPLE_REGISTERS) {
    for (std::size_t at = 6; at + 1 < pdu.size(); at += 2)
      values.push_back(static_cast<std::uint16_t>(word_at(pdu, at)));
  }
  if (values.empty() || address + std::ssize(values) > k_holding) return;
  command.fault = take_part(command, address, values);
  if (command.fault > 0) return;
  for (std::size_t i = 0; i < values.size(); ++i)
    take_register(command, address + static_cast<int>(i), values[i]);
}

class ModbusTalk final : public LineTalk {
 public:
  ~ModbusTalk() override {
    if (mapping_ != nullptr) modbus_mapping_free(mapping_);
    if (context_ != nullptr) modbus_free(context_);
    for (const int fd : pair_) {
      if (fd >= 0) ::close(fd);
    }
  }

  Result<void> open() {
    // The address is never used: answers go through a pair of sockets of this process.
    context_ = modbus_new_tcp("127.0.0.1", MODBUS_TCP_DEFAULT_PORT);
    mapping_ = modbus_mapping_new(0, k_inputs, k_holding, k_input_registers);
    if (context_ == nullptr || mapping_ == nullptr ||
        ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair_.data()) != 0)
      return fail_errno(Errc::DeviceError, errno, "--modbus: libmodbus cannot be set up");
    modbus_set_socket(context_, pair_[0]);
    return {};
  }

  [[nodiscard]] const char* name() const override { return "modbus"; }

  [[nodiscard]] LineCut cut(std::span<const std::uint8_t> bytes) const override {
    LineCut cut;
    if (bytes.size() < k_header_bytes) return cut;
    const auto length = static_cast<std::size_t>(word_at(bytes, 4));
    cut.garbled = word_at(bytes, 2) != 0 || length < k_least_length || length > k_most_length;
    if (cut.garbled || bytes.size() < k_header_bytes + length) return cut;
    cut.used = k_header_bytes + length;
    cut.command.bytes.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(cut.used));
    const std::span<const std::uint8_t> pdu = std::span{cut.command.bytes}.subspan(k_function_at);
    cut.command.fault = judge(pdu);
    if (cut.command.fault == 0) take_writes(cut.command, pdu);
    return cut;
  }

  [[nodiscard]] std::string answer(const LineCommand& command, const LineNews& news) override {
    fill(news);
    const auto length = static_cast<int>(command.bytes.size());
    const int sent = command.fault > 0 ? modbus_reply_exception(context_, command.bytes.data(),
                                                                static_cast<unsigned>(command.fault))
                                       : modbus_reply(context_, command.bytes.data(), length, mapping_);
    std::array<char, MODBUS_MAX_ADU_LENGTH> reply{};
    const ssize_t got = ::recv(pair_[1], reply.data(), reply.size(), MSG_DONTWAIT);
    if (sent <= 0 || got != sent) return {};
    return {reply.data(), static_cast<std::size_t>(got)};
  }

 private:
  void fill(const LineNews& news) {
    const auto values = line_control::values_of(news.state, news.heartbeat, news.refusal);
    std::ranges::copy(values, mapping_->tab_input_registers);
    std::ranges::copy(line_control::registers_of(news.state.part),
                      mapping_->tab_input_registers + line_control::k_values);
    std::ranges::copy(line_control::registers_of(news.state.next_part), mapping_->tab_registers + k_part_at);
    mapping_->tab_registers[k_job_at] = static_cast<std::uint16_t>(news.state.job);
    mapping_->tab_registers[k_start_at] = static_cast<std::uint16_t>(news.state.taken);
    using line_control::Step;
    mapping_->tab_registers[k_stop_at] = news.state.step == Step::Stopped ? 1 : 0;
    const std::array bits{news.state.step == Step::Ready, news.state.busy, news.state.done,
                          news.state.step == Step::Deciding, news.state.step != Step::Away};
    static_assert(std::tuple_size_v<decltype(bits)> == k_inputs);
    std::ranges::transform(bits, mapping_->tab_input_bits, [](bool bit) { return std::uint8_t{bit}; });
  }

  modbus_t* context_{nullptr};
  modbus_mapping_t* mapping_{nullptr};
  std::array<int, 2> pair_{-1, -1};
};

}  // namespace

Result<std::unique_ptr<LineTalk>> modbus_talk() {
  auto talk = std::make_unique<ModbusTalk>();
  BITELINE_TRY(talk->open());
  return talk;
}

}  // namespace biteline::web
