// SPDX-License-Identifier: MIT
// The plain text protocol: a line in, a line of numbers in round brackets out, as URScript reads them.
#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "host/apps/biteline-web/line/line_talk.hpp"

namespace biteline::web {
namespace {

using line_control::Refusal;

constexpr std::size_t k_most_line_bytes = 64;

/// " 17" as 17.
std::optional<int> number_behind(std::string_view line, std::string_view word) {
  if (!line.starts_with(word)) return std::nullopt;
  line.remove_prefix(word.size());
  if (line.empty() || line.front() != ' ') return std::nullopt;
  line.remove_prefix(1);
  int number = 0;
  const auto [at, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error != std::errc{} || at != line.data() + line.size() || number < 0 || number > 65535)
    return std::nullopt;
  return number;
}

std::string line_of(std::span<const std::uint16_t> numbers) {
  std::string line;
  for (const std::uint16_t number : numbers) {
    line += line.empty() ? '(' : ',';
    line += std::to_string(number);
  }
  line += ")\n";
  return line;
}

class TextTalk final : public LineTalk {
 public:
  [[nodiscard]] const char* name() const override { return "text"; }

  [[nodiscard]] LineCut cut(std::span<const std::uint8_t> bytes) const override {
    LineCut cut;
    const auto end = std::ranges::find(bytes, std::uint8_t{'\n'});
    const auto length = static_cast<std::size_t>(end - bytes.begin());
    if (length > k_most_line_bytes) {
      cut.garbled = true;
      return cut;
    }
    if (end == bytes.end()) return cut;
    cut.used = length + 1;
    cut.command.bytes.assign(bytes.begin(), end);
    std::string_view line{reinterpret_cast<const char*>(bytes.data()), length};
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line == "BYE") {
      cut.farewell = true;
    } else if (line == "STOP") {
      cut.command.stop = true;
    } else if (line != "STATE") {
      cut.command.job = number_behind(line, "JOB");
      cut.command.start = number_behind(line, "START");
      if (!cut.command.job && !cut.command.start) cut.command.fault = static_cast<int>(Refusal::BadRequest);
    }
    return cut;
  }

  [[nodiscard]] std::string answer(const LineCommand& command, const LineNews& news) override {
    if (command.fault > 0) return line_of(std::array{static_cast<std::uint16_t>(command.fault)});
    if (command.job || command.start || command.stop)
      return line_of(std::array{static_cast<std::uint16_t>(news.refusal)});
    return line_of(line_control::values_of(news.state, news.heartbeat, news.refusal));
  }
};

}  // namespace

std::unique_ptr<LineTalk> text_talk() {
  return std::make_unique<TextTalk>();
}

}  // namespace biteline::web
