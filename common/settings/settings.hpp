// SPDX-License-Identifier: MIT
#pragma once
/// \file Settings as a set: one file with all that may change while a sensor is in use.
///
/// board.yaml says what is wired, sensor.yaml what is calibrated; neither is repeated here.  A key that a set
/// leaves out keeps its default: the head's own (sensor.yaml) or the program's.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/numbers.hpp"
#include "common/core/result.hpp"

namespace biteline::settings {

/// The rows of key_table(), in its order.
enum class Key : std::uint8_t {
  ExposureUs,
  RateHz,
  Gain,
  SecondExposureUs,
  AutoExposure,
  FollowStripe,
  LaserOffFrames,
  TestPattern,
  RegionLeft,
  RegionTop,
  RegionWidth,
  RegionHeight,
  PeakMode,
  PeakChoice,
  PeakThreshold,
  PeakWidthMin,
  PeakWidthMax,
};
inline constexpr std::size_t k_key_count = 17;

struct KeyRow {
  enum class Kind { Number, Whole, OnOff, Word } kind{Kind::Number};
  const char* group;  ///< mapping of the file that the key stands in
  const char* name;
  NumberRange range;
  const char* unit;
  const char* usual;  ///< what holds where no set says it
  const char* what;   ///< for a person: what it does
  std::vector<std::string> words{};
};

[[nodiscard]] const std::array<KeyRow, k_key_count>& key_table();
[[nodiscard]] const KeyRow& row_of(Key key);
/// "camera.exposure_us"
[[nodiscard]] std::string path_of(Key key);

struct Value {
  double number{0};
  bool on{false};
  std::string word{};
  int line{0};  ///< of the file; 0: of no file

  [[nodiscard]] bool same_as(const Value& other) const {
    return number == other.number && on == other.on && word == other.word;
  }
};

class SettingsSet {
 public:
  std::string file;  ///< for messages; empty: of no file
  std::string note;  ///< one line for people

  [[nodiscard]] const std::optional<Value>& at(Key key) const {
    return values_[static_cast<std::size_t>(key)];
  }
  [[nodiscard]] std::optional<double> number(Key key) const;
  [[nodiscard]] std::optional<bool> on(Key key) const;
  [[nodiscard]] std::optional<std::string> word(Key key) const;
  void set(Key key, Value value) { values_[static_cast<std::size_t>(key)] = std::move(value); }
  void clear(Key key) { values_[static_cast<std::size_t>(key)].reset(); }
  [[nodiscard]] bool empty() const;

  /// Errc::BadValue "FILE line N, camera.exposure_us: EXPECTED expected, found 9000 us".
  [[nodiscard]] tl::unexpected<Error> refuse(Key key, const std::string& expected) const;

 private:
  std::array<std::optional<Value>, k_key_count> values_;
};

/// What is written under a start-up set's folder.
inline constexpr const char* k_start_file = "start-up.yaml";

/// Strict: every fault names file, line and key.  A file without its last line "..." is cut, and refused.
[[nodiscard]] Result<SettingsSet> read_settings(const std::filesystem::path& file);
[[nodiscard]] Result<SettingsSet> parse_settings(const std::string& text, const std::string& name);

/// The file of a set.
[[nodiscard]] std::string settings_text(const SettingsSet& set);

/// With its unit: "400 us", "on", "matched".
[[nodiscard]] std::string value_text(Key key, const Value& value);

struct Difference {
  Key key;
  std::string left, right;  ///< as value_text(); the usual one where a set says nothing
};
[[nodiscard]] std::vector<Difference> compare(const SettingsSet& left, const SettingsSet& right);

}  // namespace biteline::settings
