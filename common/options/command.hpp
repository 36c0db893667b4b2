// SPDX-License-Identifier: MIT
#pragma once
/// \file What a program takes on its command line, in plain types.  The parser behind it, CLI11, is compiled
/// once, here: its header and its templates cost each unit five seconds.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/options/check.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace biteline::options {

/// Where an option's value goes.
using Value =
    std::variant<std::string*, std::filesystem::path*, double*, int*, std::uint16_t*, std::uint32_t*,
                 std::uint64_t*, std::int64_t*, std::optional<std::string>*,
                 std::optional<std::filesystem::path>*, std::optional<double>*, std::optional<float>*,
                 std::optional<int>*, std::optional<std::uint16_t>*, std::optional<std::uint64_t>*,
                 std::optional<std::int64_t>*, std::vector<std::string>*, std::vector<std::filesystem::path>*,
                 std::vector<double>*>;

/// An option of a command; lives as long as that.  Each word returns the option: they are said in a row.
class Option {
 public:
  explicit Option(CLI::Option* parser) : parser_{parser} {}

  Option* required(bool is = true);
  Option* check(const Check& check);
  Option* needs(const Option* other);
  Option* excludes(const Option* other);
  Option* type_name(const std::string& shown);
  /// --help tells the value that stands there before.
  Option* capture_default_str();
  Option* default_str(const std::string& shown);
  /// So many words.
  Option* expected(int count);
  Option* expected(int least, int most);
  /// One word holds several values.
  Option* delimiter(char between);
  Option* take_all();
  Option* allow_extra_args(bool are);

  [[nodiscard]] std::size_t count() const;  ///< how often it was said
  [[nodiscard]] std::string name() const;

 private:
  friend class Command;
  CLI::Option* parser_;
};

/// A command line that the parser takes and its command does not, told from a callback.
class Unfit : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Why a program ends before it began.
struct Leave {
  std::string fault;  ///< empty: --help or --version were answered
};

/// A program, or one of its commands.
class Command {
 public:
  Command(const std::string& what_it_does, const std::string& name);
  explicit Command(CLI::App* parser);  ///< of another one
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  template <typename T>
  Option* add_option(const std::string& names, T& value, const std::string& help = {}) {
    return add_value(names, Value{&value}, help);
  }
  /// `choices` by the words for them.
  template <typename Enum, typename Target>
  Option* add_choice(const std::string& names, Target& value, const std::map<std::string, Enum>& choices,
                     const std::string& help) {
    std::map<std::string, int> numbers;
    for (const auto& [word, choice] : choices) numbers[word] = static_cast<int>(choice);
    return add_chosen(
        names, [&value](int number) { value = static_cast<Enum>(number); }, numbers, help);
  }
  Option* add_option_function(const std::string& names, std::function<void(const std::string&)> take,
                              const std::string& help);
  Option* add_flag(const std::string& names, bool& value, const std::string& help);
  Option* add_flag_callback(const std::string& names, std::function<void()> said, const std::string& help);
  void set_version_flag(const std::string& names, const std::string& version);
  [[nodiscard]] Option* get_option(const std::string& name);

  Command* add_subcommand(const std::string& name, const std::string& help);
  /// Options that have a rule in common.
  Command* add_option_group(const std::string& name, const std::string& help);
  void require_subcommand(int count);
  void require_option(int count);
  /// What it does not know is an option of the program before it.
  void fallthrough();
  /// All words after it are for another program, --help too: remaining().
  void take_the_rest();
  [[nodiscard]] std::vector<std::string> remaining() const;
  void callback(std::function<void()> chosen);

  /// Nothing: go on.
  [[nodiscard]] std::optional<Leave> parse(int argc, char** argv);
  [[nodiscard]] std::optional<Leave> parse(std::vector<std::string> words);

  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] const std::deque<Command>& commands() const { return commands_; }
  [[nodiscard]] std::vector<std::string> long_names() const;  ///< of its options, without dashes

 private:
  Option* add(CLI::Option* parser);
  Option* add_value(const std::string& names, Value value, const std::string& help);
  Option* add_chosen(const std::string& names, std::function<void(int)> take,
                     const std::map<std::string, int>& choices, const std::string& help);

  std::unique_ptr<CLI::App> own_;  ///< of a program
  CLI::App* parser_;
  std::deque<Option> options_;  ///< keep their places as more are added
  std::deque<Command> commands_;
};

}  // namespace biteline::options
