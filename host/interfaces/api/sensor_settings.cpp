// SPDX-License-Identifier: MIT
// What a door asks of the sensor: other settings, a recording to be kept.
#include "common/settings/settings.hpp"

#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"

namespace biteline::api {
namespace {

using control::Answer;
using settings::Key;
using settings::KeyRow;

/// A fault is noted and gives nothing.
std::optional<settings::Value> read_value(Fields& fields, const KeyRow& row, const std::string& name) {
  settings::Value value;
  switch (row.kind) {
    case KeyRow::Kind::Number:
    case KeyRow::Kind::Whole: {
      const auto number = fields.number(name, row.range.minimum, row.range.maximum);
      if (!number) return std::nullopt;
      value.number = *number;
      if (row.kind == KeyRow::Kind::Whole && value.number != static_cast<double>(static_cast<long>(*number)))
        fields.fault(name, "a whole number expected");
      return value;
    }
    case KeyRow::Kind::OnOff: {
      const auto on = fields.boolean(name);
      if (!on) return std::nullopt;
      value.on = *on;
      return value;
    }
    case KeyRow::Kind::Word: {
      constexpr std::size_t k_longest_word = 40;
      value.word = fields.text(name, k_longest_word, true);
      for (const std::string& word : row.words)
        if (word == value.word) return value;
      std::string known;
      for (const std::string& word : row.words) known += (known.empty() ? "" : ", ") + word;
      fields.fault(name, "one of " + known + " expected");
      return std::nullopt;
    }
  }
  return std::nullopt;
}

std::string words_of(const std::vector<SettingChange>& changes) {
  std::string words;
  for (const SettingChange& change : changes) {
    if (!words.empty()) words += ", ";
    words += settings::path_of(change.key);
    words += change.value ? " " : " as usual";
    if (change.value) words += settings::value_text(change.key, *change.value);
  }
  return words;
}

}  // namespace

Answer Api::change_settings(const Call& call) {
  Fields body{call.request.body};
  const Json given = body.object("settings");
  Fields fields{given};
  std::vector<SettingChange> changes;
  for (std::size_t i = 0; i < settings::k_key_count; ++i) {
    const auto key = static_cast<Key>(i);
    const std::string name = settings::path_of(key);
    if (!given.is_object() || !given.contains(name)) continue;
    // Null: as it is without any set.
    if (!fields.has(name)) {
      fields.boolean(name);
      changes.push_back({.key = key, .value = {}});
      continue;
    }
    changes.push_back({.key = key, .value = read_value(fields, settings::row_of(key), name)});
  }
  if (const std::optional<Answer> faults = body.faults()) return *faults;
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (changes.empty()) return control::refusal(400, "bad_request", "settings: at least one of them expected");
  const Result<void> done = rooms_.cell.change_settings(changes, call.person.name);
  if (!done) return answer_of(done.error());
  static_cast<void>(rooms_.memory.log({.id = 0,
                                       .time = memory::now_ms(),
                                       .who = call.person.name,
                                       .door = call.request.door,
                                       .action = "settings",
                                       .subject = "sensor",
                                       .before = {},
                                       .after = words_of(changes)}));
  return ok({{"done", true}, {"words", "the sensor took it, and runs with it until it stops"}});
}

Answer Api::keep_recording(const Call& call) {
  Fields fields{call.request.body};
  constexpr std::size_t k_longest_word = 10;
  const std::string which = fields.text("which", k_longest_word, true);
  if (which != "last" && which != "next") fields.fault("which", "last or next expected");
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  const Result<std::string> kept = rooms_.cell.keep_recording(which == "next", call.person.name);
  if (!kept) return answer_of(kept.error());
  static_cast<void>(rooms_.memory.log({.id = 0,
                                       .time = memory::now_ms(),
                                       .who = call.person.name,
                                       .door = call.request.door,
                                       .action = "keep recording",
                                       .subject = "sensor",
                                       .before = {},
                                       .after = *kept}));
  return ok({{"done", true}, {"words", "kept: " + *kept}});
}

}  // namespace biteline::api
