// SPDX-License-Identifier: MIT
#include "host/records/force_book/force_book.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/fixed_text.hpp"

namespace biteline::force_book {
namespace {

using nlohmann::ordered_json;

/// In the memory's settings: a list of keys, and an entry under each.
constexpr const char* k_list_key = "force_learned";
constexpr double k_most_newton = 250, k_most_count = 1e9;
constexpr double k_latest_ms = 1e15;
constexpr std::array k_error_keys{"error_x_n", "error_y_n", "error_z_n"};

std::string key_of(const Subject& of) {
  // No name of a model, foot or process has a line's end.
  return std::string{k_list_key} + "\n" + of.model + "\n" + of.foot + "\n" + of.process;
}

/// The first fault stays.
struct Reader {
  const ordered_json& json;
  bool& good;

  [[nodiscard]] double number(const char* name, double most) const {
    const auto found = json.find(name);
    const double value = found != json.end() && found->is_number() ? found->get<double>() : NAN;
    if (std::abs(value) <= most) return value;
    good = false;
    return 0;
  }
  [[nodiscard]] int count(const char* name) const { return static_cast<int>(number(name, k_most_count)); }
  [[nodiscard]] std::string text(const char* name) const {
    const auto found = json.find(name);
    if (found != json.end() && found->is_string()) return found->get<std::string>();
    good = false;
    return {};
  }
  [[nodiscard]] std::vector<double> places(const char* name) const {
    std::vector<double> values;
    const auto found = json.find(name);
    if (found != json.end() && found->is_array())
      for (const ordered_json& one : *found) values.push_back(one.is_number() ? one.get<double>() : NAN);
    const bool whole = values.size() == path::k_force_places &&
                       std::ranges::all_of(values, [](double v) { return std::abs(v) <= k_most_newton; });
    good = good && whole;
    values.resize(path::k_force_places, 0.0);
    return values;
  }
};

ordered_json text_of(const Entry& entry) {
  ordered_json json{{"model", entry.of.model},
                    {"foot", entry.of.foot},
                    {"process", entry.of.process},
                    {"process_sha256", entry.of.process_sha256},
                    {"tip", entry.of.tip},
                    {"set_n", entry.learned.set_newton},
                    {"air_runs", entry.learned.air_runs},
                    {"shoes", entry.learned.shoes},
                    {"ahead_n", entry.learned.ahead_newton}};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vec3& error : entry.learned.error_tcp) values.push_back(error[axis]);
    json[k_error_keys.at(static_cast<std::size_t>(axis))] = values;
  }
  json["worked"] = ordered_json::array();
  for (const ShoeForce& shoe : entry.shoes)
    json["worked"].push_back({{"scan", shoe.scan},
                              {"within", shoe.within},
                              {"mean_n", shoe.mean_newton},
                              {"largest_n", shoe.largest_newton},
                              {"along_mm", shoe.along_mm},
                              {"tool", shoe.tool},
                              {"time_ms", shoe.time}});
  return json;
}

std::optional<Entry> entry_of(const std::string& text) {
  const ordered_json json = ordered_json::parse(text, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  bool good = true;
  const Reader in{json, good};
  Entry entry{.of = {.model = in.text("model"),
                     .foot = in.text("foot"),
                     .process = in.text("process"),
                     .process_sha256 = in.text("process_sha256"),
                     .tip = in.text("tip")},
              .learned = {.set_newton = in.number("set_n", k_most_newton),
                          .air_runs = in.count("air_runs"),
                          .shoes = in.count("shoes"),
                          .error_tcp = std::vector<Vec3>(path::k_force_places, Vec3::Zero()),
                          .ahead_newton = in.places("ahead_n")}};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::vector<double> values = in.places(k_error_keys.at(static_cast<std::size_t>(axis)));
    for (std::size_t i = 0; i < values.size(); ++i) entry.learned.error_tcp[i][axis] = values[i];
  }
  const auto worked = json.find("worked");
  if (worked == json.end() || !worked->is_array()) return std::nullopt;
  for (const ordered_json& one : *worked) {
    if (!one.is_object()) return std::nullopt;
    const Reader shoe{one, good};
    entry.shoes.push_back({.scan = shoe.text("scan"),
                           .within = shoe.number("within", 1),
                           .mean_newton = shoe.number("mean_n", k_most_count),
                           .largest_newton = shoe.number("largest_n", k_most_count),
                           .along_mm = shoe.number("along_mm", k_most_count)});
    if (!one.contains("tool")) continue;
    entry.shoes.back().tool = shoe.text("tool");
    entry.shoes.back().time = static_cast<memory::UnixMs>(shoe.number("time_ms", k_latest_ms));
  }
  if (!good) return std::nullopt;
  return entry;
}

tl::unexpected<Error> unreadable(const std::string& what) {
  return fail(Errc::BadFormat,
              "memory: what was learned of the force (%.100s) was not written by this program; "
              "biteline work-force --forget MODEL drops it",
              what.c_str());
}

memory::LogRow row(const char* action, const std::string& who, const std::string& subject,
                   std::string after) {
  return {.id = 0,
          .time = memory::now_ms(),
          .who = who,
          .door = {},
          .action = action,
          .subject = subject,
          .before = {},
          .after = std::move(after)};
}

Result<std::vector<std::string>> keys(const memory::Memory& memory) {
  BITELINE_ASSIGN(const std::optional<std::string> text, memory.setting(k_list_key));
  if (!text || text->empty()) return std::vector<std::string>{};
  const ordered_json json = ordered_json::parse(*text, nullptr, false);
  std::vector<std::string> found;
  if (!json.is_array()) return unreadable("its list");
  for (const ordered_json& one : json) {
    if (!one.is_string()) return unreadable("its list");
    found.push_back(one.get<std::string>());
  }
  return found;
}

/// The list first: an entry that it does not name would never be shown or forgotten.
Result<void> put(memory::Memory& memory, const Entry& entry, const std::string& scan) {
  const std::string key = key_of(entry.of);
  BITELINE_ASSIGN(std::vector<std::string> all, keys(memory));
  if (std::ranges::find(all, key) == all.end()) {
    all.push_back(key);
    BITELINE_TRY(memory.put_setting(k_list_key, ordered_json(all).dump(),
                                    row("force learned", "service", entry.of.model, "the first of it")));
  }
  return memory.put_setting(
      key, text_of(entry).dump(),
      row("force learned", "service", entry.of.model, scan + ": " + words_of(entry.learned)));
}

/// As it stands, or a new one where nothing of it counts any more.
Result<Entry> begin(const memory::Memory& memory, const Subject& of, double set_newton) {
  BITELINE_ASSIGN(std::optional<Entry> entry, read(memory, of));
  if (entry && entry->of == of && entry->learned.set_newton == set_newton) return std::move(*entry);
  return Entry{.of = of, .learned = {.set_newton = set_newton}};
}

}  // namespace

std::string tip_text(const std::optional<Vec3>& tip_flange) {
  if (!tip_flange) return {};
  return FixedText<100>::format("%.2f %.2f %.2f", tip_flange->x(), tip_flange->y(), tip_flange->z()).c_str();
}

std::string words_of(const path::ForceLearned& learned) {
  const path::ForceDrift drift = path::drift_of(learned);
  return FixedText<200>::format(
             "learned from %d shoes and %d runs in the air: the sensor's drift with the place is up to %.1f "
             "N, what is added ahead up to %.1f N",
             learned.shoes, learned.air_runs, drift.error_newton, drift.ahead_newton)
      .c_str();
}

Result<std::optional<Entry>> read(const memory::Memory& memory, const Subject& of) {
  BITELINE_ASSIGN(const std::optional<std::string> text, memory.setting(key_of(of)));
  if (!text || text->empty()) return std::optional<Entry>{};
  std::optional<Entry> entry = entry_of(*text);
  if (!entry || !entry->of.same_place(of)) return unreadable(of.model);
  return entry;
}

Result<std::optional<path::ForceLearned>> learned(const memory::Memory& memory, const Subject& of) {
  BITELINE_ASSIGN(const std::optional<Entry> entry, read(memory, of));
  if (!entry || !(entry->of == of)) return std::optional<path::ForceLearned>{};
  return std::optional<path::ForceLearned>{entry->learned};
}

Result<std::vector<Entry>> read_all(const memory::Memory& memory) {
  std::vector<Entry> entries;
  BITELINE_ASSIGN(const std::vector<std::string> all, keys(memory));
  for (const std::string& key : all) {
    BITELINE_ASSIGN(const std::optional<std::string> text, memory.setting(key));
    if (!text || text->empty()) continue;
    std::optional<Entry> entry = entry_of(*text);
    if (!entry) return unreadable(key);
    entries.push_back(std::move(*entry));
  }
  return entries;
}

Result<Entry> learn_shoe(memory::Memory& memory, const Subject& of, double set_newton,
                         const std::string& scan, const path::ForceTold& told, const std::string& tool) {
  BITELINE_ASSIGN(Entry entry, begin(memory, of, set_newton));
  path::learn_shoe(entry.learned, told.learn, told.place);
  entry.shoes.push_back({.scan = scan,
                         .within = told.within,
                         .mean_newton = told.mean_newton,
                         .largest_newton = told.largest_newton,
                         .along_mm = told.along_mm,
                         .tool = tool,
                         .time = memory::now_ms()});
  if (entry.shoes.size() > k_shoes_kept) entry.shoes.erase(entry.shoes.begin());
  BITELINE_TRY(put(memory, entry, scan));
  return entry;
}

Result<Entry> learn_air(memory::Memory& memory, const Subject& of, double set_newton, const std::string& scan,
                        std::span<const path::ForceSample> samples) {
  BITELINE_ASSIGN(Entry entry, begin(memory, of, set_newton));
  path::learn_air(entry.learned, samples);
  BITELINE_TRY(put(memory, entry, scan));
  return entry;
}

Result<int> forget(memory::Memory& memory, const std::string& model, const std::string& who) {
  BITELINE_ASSIGN(std::vector<std::string> all, keys(memory));
  const std::string begins = std::string{k_list_key} + "\n" + model + "\n";
  int forgotten = 0;
  // An entry goes before its name: what fails in between is forgotten by the next try.
  for (const std::string& key : all) {
    if (!key.starts_with(begins)) continue;
    ++forgotten;
    BITELINE_TRY(memory.put_setting(key, "", row("force forgotten", who, model, {})));
  }
  if (forgotten == 0) return 0;
  std::erase_if(all, [&](const std::string& key) { return key.starts_with(begins); });
  BITELINE_TRY(memory.put_setting(k_list_key, ordered_json(all).dump(),
                                  row("force forgotten", who, model, std::to_string(forgotten))));
  return forgotten;
}

ordered_json to_json(const Entry& entry) {
  const path::ForceDrift drift = path::drift_of(entry.learned);
  return {{"model", entry.of.model},
          {"foot", entry.of.foot},
          {"process", entry.of.process},
          {"set_n", entry.learned.set_newton},
          {"shoes", entry.learned.shoes},
          {"air_runs", entry.learned.air_runs},
          {"sensor_drift_n", drift.error_newton},
          {"ahead_n", drift.ahead_newton}};
}

}  // namespace biteline::force_book
