// SPDX-License-Identifier: MIT
#include "hal/sim/robot/program_text.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "hal/sim/robot/script_rows.hpp"

namespace biteline::sim {
namespace {

constexpr std::string_view k_before_line = "script line ";

int line_in(std::string_view error) {
  const std::size_t at = error.find(k_before_line);
  return at == std::string_view::npos
             ? 0
             : std::atoi(std::string{error.substr(at + k_before_line.size(), 10)}.c_str());
}

std::string_view row_of(std::string_view program, int line) {
  for (; line > 1 && !program.empty(); --line)
    program.remove_prefix(std::min(program.find('\n'), program.size() - 1) + 1);
  return program.substr(0, program.find('\n'));
}

/// `def name():` or bare rows.
Result<ScriptCode> parse_code(std::string_view text) {
  std::optional<CodeReader> code;
  int line = 0;
  bool inside = false, ended = false;
  while (!text.empty()) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string_view row = bare_row(text.substr(0, length));
    text.remove_prefix(std::min(length + 1, text.size()));
    ++line;
    RowReader reader{row, line};
    if (reader.at_end()) continue;
    if (ended) return fail(Errc::BadFormat, "script line %d: something follows the end of the program", line);
    if (!code && reader.word() == "def") {
      code.emplace(reader.word(), CodeReader::Part::Main);
      if (!reader.take("(") || !reader.take(")") || !reader.take(":")) return reader.wrong("'():'");
      inside = true;
      continue;
    }
    if (!code) code.emplace("script", CodeReader::Part::Main);
    BITELINE_ASSIGN(ended, code->take(row, line));
  }
  if (!code || inside != ended || !code->is_whole())
    return fail(Errc::Truncated, "script line %d: 'end' is missing", line);
  return (*std::move(code)).code();
}

}  // namespace

std::optional<std::string> take_program(std::vector<std::uint8_t>& bytes) {
  const std::string text(bytes.begin(), bytes.end());
  std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return std::nullopt;
  const bool function = text.compare(begin, 4, "def ") == 0 || text.compare(begin, 4, "sec ") == 0;
  std::size_t end = text.find('\n', begin);
  int depth = 0;
  for (std::size_t first = begin; function && end != std::string::npos;) {
    std::string line = text.substr(first, end - first);
    line.erase(0, std::min(line.find_first_not_of(" \t"), line.size()));
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.ends_with(':') && !line.starts_with("else") && !line.starts_with("elif")) ++depth;
    if (line == "end" && --depth <= 0) break;
    first = end + 1;
    end = text.find('\n', first);
  }
  if (end == std::string::npos) return std::nullopt;
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(end + 1));
  return text.substr(begin, end + 1 - begin);
}

Result<ProgramText> parse_program(std::string_view text) {
  Result<Script> plain = parse_script(text);
  if (plain) return ProgramText{*std::move(plain)};
  if (plain.error().code != Errc::NotSupported && plain.error().code != Errc::BadFormat)
    return tl::unexpected{plain.error()};
  Result<ScriptCode> code = parse_code(text);
  if (code) return ProgramText{*std::move(code)};
  // Who came farther understood more of it.
  const bool code_came_farther = line_in(to_line(code.error())) > line_in(to_line(plain.error()));
  return tl::unexpected{code_came_farther ? code.error() : plain.error()};
}

ProgramFault fault_of(const Error& error, std::string_view program) {
  const std::string told = to_line(error);
  ProgramFault fault{.line = line_in(told), .text = told};
  if (error.code != Errc::NotSupported) return fault;
  const std::size_t begin = told.find('\'') + 1, end = told.find('\'', begin);
  if (begin == 0 || end == std::string::npos) return fault;
  const std::string name = told.substr(begin, end - begin);
  const std::size_t at = row_of(program, fault.line).find(name);
  if (at == std::string_view::npos) return fault;
  fault.column = static_cast<int>(at) + 1;
  fault.text = "compile_error_name_not_found:" + name + ":";
  return fault;
}

PortOrder port_order(std::string_view line) {
  constexpr std::array<std::pair<std::string_view, PortOrder>, 5> k_words{
      {{"power on", PortOrder::PowerOn},
       {"power off", PortOrder::PowerOff},
       {"set robotmode run", PortOrder::ReleaseBrakes},
       {"set unlock protective stop", PortOrder::Unlock},
       {"stop program", PortOrder::Stop}}};
  const std::string_view word = bare_row(line.substr(0, line.find('\n')));
  const auto* known = std::ranges::find(k_words, word, &std::pair<std::string_view, PortOrder>::first);
  return known == k_words.end() ? PortOrder::None : known->second;
}

}  // namespace biteline::sim
