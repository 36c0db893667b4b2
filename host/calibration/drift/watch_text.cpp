// SPDX-License-Identifier: MIT
// A watch as text: what a cell's memory keeps from shoe to shoe.
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/core/numbers.hpp"
#include "host/calibration/drift/watch.hpp"

namespace biteline::drift {
namespace {

using Json = nlohmann::json;

constexpr int k_version = 4;
/// A sum over a lifetime of shoes; beyond it is no number of ours.
constexpr NumberRange k_plausible{.minimum = -1e15, .maximum = 1e15};

Json json_of(const Sums& sums) {
  Json values = Json::array();
  for (int row = 0; row < k_quantities; ++row) {
    for (int col = 0; col <= row; ++col) values.push_back(sums.information(row, col));
  }
  for (const double value : sums.pull) values.push_back(value);
  return values;
}

Json json_of(const std::optional<TablePlane>& table) {
  if (!table) return {};
  return {table->middle.x(), table->middle.y(), table->height_mm, table->slope_x, table->slope_y};
}

/// Reads numbers only; anything else makes it wrong, once and for all.
class Reader {
 public:
  [[nodiscard]] bool sound() const { return sound_; }
  double number(const Json& json) {
    if (json.is_number() && k_plausible.holds(json.get<double>())) return json.get<double>();
    sound_ = false;
    return 0;
  }
  double number(const Json& json, const char* key) { return number(value(json, key)); }
  int count(const Json& json, const char* key) {
    const double value = number(json, key);
    constexpr double k_most = 1e9;
    if (value < 0 || value > k_most || value != std::floor(value)) sound_ = false;
    return sound_ ? static_cast<int>(value) : 0;
  }
  const Json& value(const Json& json, const char* key) {
    static const Json k_nothing;
    const auto found = json.is_object() ? json.find(key) : json.end();
    if (json.is_object() && found != json.end()) return *found;
    sound_ = false;
    return k_nothing;
  }
  const Json& list(const Json& json, const char* key, std::size_t most) {
    static const Json k_empty = Json::array();
    const Json& found = value(json, key);
    if (found.is_array() && found.size() <= most) return found;
    sound_ = false;
    return k_empty;
  }
  Sums sums(const Json& json) {
    constexpr std::size_t k_numbers = k_quantities * (k_quantities + 1) / 2 + k_quantities;
    Sums sums;
    if (!json.is_array() || json.size() != k_numbers) {
      sound_ = false;
      return sums;
    }
    std::size_t at = 0;
    for (int row = 0; row < k_quantities; ++row) {
      for (int col = 0; col <= row; ++col)
        sums.information(row, col) = sums.information(col, row) = number(json[at++]);
    }
    for (double& value : sums.pull) value = number(json[at++]);
    return sums;
  }
  Vector vector(const Json& json) {
    Vector values = Vector::Zero();
    if (!json.is_array() || json.size() != k_quantities) {
      sound_ = false;
      return values;
    }
    for (int i = 0; i < k_quantities; ++i) values[i] = number(json[static_cast<std::size_t>(i)]);
    return values;
  }
  bool flag(const Json& json, const char* key) {
    const Json& found = value(json, key);
    if (!found.is_boolean()) sound_ = false;
    return sound_ && found.get<bool>();
  }
  std::string text(const Json& json, const char* key) {
    const Json& found = value(json, key);
    if (found.is_string()) return found.get<std::string>();
    sound_ = false;
    return {};
  }
  ModelUsuals models(const Json& json) {
    std::map<std::string, ModelUsuals::Usual> of;
    for (const Json& model : list(json, "models", ModelUsuals::k_most + 1))
      of[text(model, "name")] = {.sums = sums(value(model, "sums")),
                                 .alone = vector(value(model, "alone")),
                                 .shoes = count(model, "shoes"),
                                 .table = table(value(model, "table")),
                                 .on_another_table = count(model, "on_another_table")};
    std::string first = text(json, "first_model");
    if (!of.empty() && !of.contains(first)) sound_ = false;
    return {std::move(first), std::move(of)};
  }
  std::optional<TablePlane> table(const Json& json) {
    if (json.is_null()) return std::nullopt;
    constexpr std::size_t k_numbers = 5;
    if (!json.is_array() || json.size() != k_numbers) {
      sound_ = false;
      return std::nullopt;
    }
    return TablePlane{.middle = {number(json[0]), number(json[1])},
                      .height_mm = number(json[2]),
                      .slope_x = number(json[3]),
                      .slope_y = number(json[4])};
  }

 private:
  bool sound_{true};
};

}  // namespace

std::string Watch::to_text() const {
  Json rows = Json::array(), recent = Json::array();
  for (const SelfStarting& row : rows_) {
    const SelfStarting::State& s = row.state();
    rows.push_back({{"count", s.count},
                    {"mean", s.mean},
                    {"squares", s.squares},
                    {"on_trial", s.on_trial},
                    {"high", s.high},
                    {"low", s.low}});
  }
  for (const Recent& shoe : recent_)
    recent.push_back({{"model", shoe.model},
                      {"seen", json_of(shoe.seen)},
                      {"scatter", shoe.scatter ? Json(*shoe.scatter) : Json{}},
                      {"learnt", shoe.learnt}});
  Json models = Json::array();
  for (const auto& [name, usual] : models_.of())
    models.push_back({{"name", name},
                      {"shoes", usual.shoes},
                      {"sums", json_of(usual.sums)},
                      {"alone", std::vector<double>(usual.alone.begin(), usual.alone.end())},
                      {"table", json_of(usual.table)},
                      {"on_another_table", usual.on_another_table}});
  return Json{
      {"version", k_version},    {"rows", rows},
      {"recent", recent},        {"sound_shoes", sound_shoes_},
      {"scatter", scatter_},     {"first_model", models_.first()},
      {"models", models},        {"last_scan", last_scan_},
      {"shoes", verdict_.shoes}, {"drifted_for", verdict_.status == Status::Drifted ? verdict_.for_shoes : 0}}
      .dump();
}

Result<Watch> Watch::from_text(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  Reader reader;
  Watch watch;
  const int version = reader.count(json, "version");
  if (version > 0 && version < k_version && reader.count(json, "drifted_for") > 0 && reader.sound()) {
    // What an earlier release learnt is not read; its alarm stays.
    watch.verdict_.for_shoes = 1;
    watch.judge();
    return watch;
  }
  const Json& rows = reader.list(json, "rows", k_quantities);
  if (rows.size() == k_quantities) {
    watch.rows_.clear();
    for (const Json& row : rows) {
      SelfStarting::State state{.count = reader.count(row, "count"),
                                .mean = reader.number(row, "mean"),
                                .squares = reader.number(row, "squares"),
                                .on_trial = {},
                                .high = reader.number(row, "high"),
                                .low = reader.number(row, "low")};
      for (const Json& value : reader.list(row, "on_trial", SelfStarting::k_on_trial))
        state.on_trial.push_back(reader.number(value));
      watch.rows_.emplace_back(Watch::k_least_sigma, std::move(state));
    }
  }
  for (const Json& shoe : reader.list(json, "recent", Watch::k_recent)) {
    const Json& scatter = reader.value(shoe, "scatter");
    watch.recent_.push_back(
        {.model = reader.text(shoe, "model"),
         .seen = reader.sums(reader.value(shoe, "seen")),
         .scatter = scatter.is_null() ? std::nullopt : std::optional{reader.number(scatter)},
         .learnt = reader.flag(shoe, "learnt")});
  }
  watch.sound_shoes_ = reader.count(json, "sound_shoes");
  watch.scatter_ = reader.number(json, "scatter");
  watch.models_ = reader.models(json);
  const Json& last = reader.value(json, "last_scan");
  watch.last_scan_ = last.is_string() ? last.get<std::string>() : std::string{};
  watch.verdict_.shoes = reader.count(json, "shoes");
  watch.verdict_.for_shoes = reader.count(json, "drifted_for");
  if (version != k_version || !reader.sound() || rows.size() != k_quantities)
    return fail(Errc::BadFormat, "calibration check: its memory cannot be read; it learns anew");
  if (watch.verdict_.shoes > 0) watch.judge();
  return watch;
}

}  // namespace biteline::drift
