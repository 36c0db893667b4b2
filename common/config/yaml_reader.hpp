// SPDX-License-Identifier: MIT
#pragma once
/// \file Strict reading of small YAML files: every fault names file, key and line; an unknown key is a fault.
///
/// The one place where yaml-cpp and its exceptions are met.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/core/numbers.hpp"
#include "common/core/result.hpp"

namespace biteline::config {

/// A key that a reader asked for, with what it may be and what it was: the table of a file's keys, made by
/// the code that reads the file.
struct KeyAsked {
  enum class Kind { Number, Integer, Numbers, Text, Choice };
  std::string path;  ///< "motion.speed_mm_s"
  Kind kind{Kind::Text};
  bool required{true};
  NumberRange range{};
  std::size_t count{1};  ///< of numbers
  std::optional<double> default_number{};
  std::optional<std::string> default_text{};
  std::vector<std::string> choices{};
  std::vector<double> numbers{};      ///< as read; empty: not there, or bad
  std::optional<std::string> text{};  ///< as read
};
using KeysAsked = std::vector<KeyAsked>;

/// Reads one mapping.  Calls never fail one by one: faults are collected, and finish() tells the first of
/// them and how many more there are.  A key that was never asked for is unknown.
///
///     auto reader = YamlReader::open(path);          // Result
///     settings.speed_mm_s = reader->number("speed_mm_s", {.minimum = 0.1, .maximum = 500});
///     BITELINE_TRY(reader->finish());
class YamlReader {
 public:
  using Range = NumberRange;

  [[nodiscard]] static Result<YamlReader> open(const std::filesystem::path& path);
  /// `name` stands for the file in faults.
  [[nodiscard]] static Result<YamlReader> parse(const std::string& text, const std::string& name);

  /// From now on every key that is asked for (mappings, booleans, matrices and lists of texts apart) is noted
  /// in `keys`, which outlives this reader and its children.
  void note_keys(KeysAsked& keys);

  YamlReader(YamlReader&&) noexcept;
  YamlReader& operator=(YamlReader&&) noexcept;
  ~YamlReader();

  [[nodiscard]] bool has(const std::string& key) const;
  /// Of the value, from 1; 0 where there is none.
  [[nodiscard]] int line_at(const std::string& key) const;

  /// Required values; a missing or bad one is a fault and returns 0, empty or zeros.  Numbers must be finite.
  double number(const std::string& key, Range range);
  long integer(const std::string& key, Range range);
  bool boolean(const std::string& key);
  std::string text(const std::string& key);
  std::vector<double> numbers(const std::string& key, std::size_t count, Range range = {});
  /// Row-major, `rows` lists of `columns` numbers.
  std::vector<double> matrix(const std::string& key, std::size_t rows, std::size_t columns, Range range = {});
  std::vector<std::string> texts(const std::string& key);

  /// Optional values.
  double number_or(const std::string& key, double fallback, Range range);
  long integer_or(const std::string& key, long fallback, Range range);
  bool boolean_or(const std::string& key, bool fallback);
  std::string text_or(const std::string& key, const std::string& fallback);

  /// One of some words; the first is meant when there is none.
  std::string choice_or_first(const std::string& key, const std::vector<std::string>& choices);

  /// The nested mapping under `key`; an absent one reads as empty and is a fault when `required`.  Its faults
  /// join this reader's; unknown keys in it are found when the child is destroyed, so destroy it before
  /// finish().
  YamlReader child(const std::string& key, bool required);

  /// The mappings of the list under `key`, at most `most` of them; an absent one reads as none.  Each is as a
  /// child, its keys are told as "key[0].name".
  std::vector<YamlReader> children(const std::string& key, std::size_t most);

  /// Records a fault of the caller's own, e.g. a matrix that is no rotation.
  void fault(Errc code, const std::string& key, const std::string& expected);

  /// Also checks for unknown keys.  Call once, last.
  [[nodiscard]] Result<void> finish();

 private:
  struct Node;
  explicit YamlReader(std::unique_ptr<Node> node);
  std::unique_ptr<Node> node_;
};

}  // namespace biteline::config
