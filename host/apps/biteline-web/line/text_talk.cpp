// SPDX-License-Identifier: MIT
// The plain text protocol: a line in, a line of numbers in round brackets out, as URScript reads them.
#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "host/apps/biteline-web/line/line_talk.hpp"
#include "host/interfaces/line_control/part_number.hpp"

namespace biteline::web {
namespace {

using line_control::Refusal;

/// A part number, its word and CR.
constexpr std::size_t k_most_line_bytes = 80;
constexpr std::array<std::string_view, 7> k_words{"STATE", "JOB", "PART", "SHOE", "START", "STOP", "BYE"};

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

/// Of "PART A-17"; of "PART" alone an empty one.
std::optional<std::string> part_behind(std::string_view line) {
  constexpr std::string_view k_word = "PART";
  if (!line.starts_with(k_word)) return std::nullopt;
  return line_control::part_number(line.substr(k_word.size()));
}

/// Letters, digits and the like: a TLS hello or another program's bytes are none.
bool is_text(std::string_view line) {
  return std::ranges::all_of(line, [](unsigned char c) { return (c >= ' ' && c < 127) || c == '\t'; });
}

/// The beginning of a line that may become one of this protocol.
bool may_become_one(std::string_view line) {
  const auto fits = [line](std::string_view word) {
    if (line.size() <= word.size()) return word.starts_with(line);
    return line.starts_with(word) && (line[word.size()] == ' ' || line[word.size()] == '\t');
  };
  return is_text(line) && std::ranges::any_of(k_words, fits);
}

/// Its first word is one of this protocol, whatever stands behind it.
bool is_one(std::string_view line) {
  const std::string_view first = line.substr(0, line.find_first_of(" \t"));
  return line.empty() || (is_text(line) && std::ranges::find(k_words, first) != k_words.end());
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
    if (end == bytes.end()) {
      // A browser, TLS, a scanner: what it sends behind its own first line must never be read as one of ours.
      std::string_view begun{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
      if (begun.ends_with('\r')) begun.remove_suffix(1);
      cut.garbled = !may_become_one(begun);
      return cut;
    }
    cut.used = length + 1;
    cut.command.bytes.assign(bytes.begin(), end);
    std::string_view line{reinterpret_cast<const char*>(bytes.data()), length};
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!is_text(line)) {
      cut.garbled = true;
    } else if (!is_one(line)) {
      cut.command.fault = static_cast<int>(Refusal::BadRequest);
      cut.last = true;
    } else if (line == "BYE") {
      cut.farewell = true;
    } else if (line == "STOP") {
      cut.command.stop = true;
    } else if (line == "SHOE") {
      cut.command.asks_part = true;
    } else if (line != "STATE") {
      cut.command.job = number_behind(line, "JOB");
      cut.command.part = part_behind(line);
      cut.command.start = number_behind(line, "START");
      if (!cut.command.job && !cut.command.part && !cut.command.start)
        cut.command.fault = static_cast<int>(Refusal::BadRequest);
    }
    return cut;
  }

  [[nodiscard]] std::string answer(const LineCommand& command, const LineNews& news) override {
    if (command.fault > 0) return line_of(std::array{static_cast<std::uint16_t>(command.fault)});
    if (command.asks_part) return "(" + news.state.part + ")\n";
    if (command.job || command.part || command.start || command.stop)
      return line_of(std::array{static_cast<std::uint16_t>(news.refusal)});
    return line_of(line_control::values_of(news.state, news.heartbeat, news.refusal));
  }
};

}  // namespace

std::unique_ptr<LineTalk> text_talk() {
  return std::make_unique<TextTalk>();
}

}  // namespace biteline::web
