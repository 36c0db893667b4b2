// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/primary_messages.hpp"

#include <algorithm>

#include "common/core/fixed_text.hpp"
#include "common/rtde/big_endian.hpp"

namespace biteline::robot::ur {
namespace {

constexpr std::size_t k_head_bytes = 5;          // length and type, of messages and of their parts
constexpr std::size_t k_most_bytes = 1U << 16U;  // a state has some 1500
constexpr std::uint8_t k_robot_message = 20;
constexpr std::uint8_t k_error_code = 6, k_key = 7, k_runtime_exception = 10;
constexpr std::int32_t k_violation = 3, k_critical_fault = 5;  // and a fault between
constexpr std::size_t k_most_text = 200;

/// One line of it: what a controller says goes into logs and pages.
std::string line_of(std::string text) {
  text.resize(std::min(text.size(), k_most_text));
  for (char& letter : text)
    if (static_cast<unsigned char>(letter) < ' ' || letter == '\x7f') letter = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

std::optional<ControllerSaid> runtime_exception(rtde::Reader& body) {
  const std::int32_t line = body.get<std::int32_t>().value_or(0),
                     column = body.get<std::int32_t>().value_or(0);
  if (body.failed()) return std::nullopt;
  return ControllerSaid{
      .about = ControllerSaid::About::ProgramError,
      .text = std::string{FixedText<60>::format("line %d, column %d: ", line, column).view()} +
              line_of(body.get_rest())};
}

std::optional<ControllerSaid> error_code(rtde::Reader& body) {
  const std::int32_t code = body.get<std::int32_t>().value_or(0),
                     argument = body.get<std::int32_t>().value_or(0);
  const std::int32_t level = body.get<std::int32_t>().value_or(0);
  static_cast<void>(body.get<std::uint32_t>());  // the data's type
  static_cast<void>(body.get<std::uint32_t>());  // the data
  if (body.failed() || level < k_violation || level > k_critical_fault) return std::nullopt;
  const std::string text = line_of(body.get_rest());
  return ControllerSaid{.about = ControllerSaid::About::Fault,
                        .text = std::string{FixedText<60>::format("C%dA%d", code, argument).view()} +
                                (text.empty() ? "" : ": ") + text};
}

std::optional<ControllerSaid> key(rtde::Reader& body) {
  static_cast<void>(body.get<std::int32_t>());  // code
  static_cast<void>(body.get<std::int32_t>());  // argument
  const std::size_t size = body.get<std::uint8_t>().value_or(0);
  const std::optional<std::string> title = body.get_text(size);
  if (!title) return std::nullopt;
  using About = ControllerSaid::About;
  if (*title == "PROGRAM_XXX_STARTED") return ControllerSaid{About::Started, line_of(body.get_rest())};
  if (*title == "PROGRAM_XXX_STOPPED") return ControllerSaid{About::Ended, line_of(body.get_rest())};
  return std::nullopt;
}

std::optional<ControllerSaid> said_in(const Part& message) {
  if (message.type != k_robot_message) return std::nullopt;
  rtde::Reader body{message.body};
  static_cast<void>(body.get<std::uint64_t>());  // stamp
  static_cast<void>(body.get<std::uint8_t>());   // source
  switch (body.get<std::uint8_t>().value_or(0)) {
    case k_error_code:
      return error_code(body);
    case k_key:
      return key(body);
    case k_runtime_exception:
      return runtime_exception(body);
    default:
      return std::nullopt;
  }
}

}  // namespace

Result<std::optional<Part>> take_part(std::span<const std::uint8_t>& bytes) {
  if (bytes.size() < k_head_bytes) return std::optional<Part>{};
  rtde::Reader head{bytes};
  const std::uint32_t length = head.get<std::uint32_t>().value_or(0);
  const std::uint8_t type = head.get<std::uint8_t>().value_or(0);
  if (length < k_head_bytes || length > k_most_bytes)
    return fail(Errc::BadFormat, "a message of %u bytes", static_cast<unsigned>(length));
  if (bytes.size() < length) return std::optional<Part>{};
  const Part part{.type = type, .body = bytes.subspan(k_head_bytes, length - k_head_bytes)};
  bytes = bytes.subspan(length);
  return part;
}

Result<std::vector<ControllerSaid>> take_said(std::vector<std::uint8_t>& heard) {
  std::vector<ControllerSaid> said;
  std::span<const std::uint8_t> left{heard};
  for (;;) {
    BITELINE_ASSIGN(const std::optional<Part> message, take_part(left));
    if (!message) break;
    if (std::optional<ControllerSaid> one = said_in(*message)) said.push_back(std::move(*one));
  }
  heard.erase(heard.begin(), heard.end() - static_cast<std::ptrdiff_t>(left.size()));
  return said;
}

}  // namespace biteline::robot::ur
