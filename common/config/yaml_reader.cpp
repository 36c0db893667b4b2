// SPDX-License-Identifier: MIT
#include "common/config/yaml_reader.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "common/core/text.hpp"
#include "common/core/text_bounds.hpp"
#include "common/system/file.hpp"

namespace biteline::config {
namespace {

constexpr std::size_t k_longest_key_bytes = 80;

struct Faults {
  std::string file;
  std::optional<Error> first;
  int count{0};

  void add(Errc code, int line, const std::string& key, const std::string& expected) {
    ++count;
    if (first) return;
    // A key comes from the file, and may be as long as it.
    const std::string named = clean_text(key, k_longest_key_bytes);
    first =
        line > 0
            ? fail(code, "%s line %d, %s: %s", file.c_str(), line, named.c_str(), expected.c_str()).value()
            : fail(code, "%s, %s: %s", file.c_str(), named.c_str(), expected.c_str()).value();
  }
};

int line_of(const YAML::Node& node) {
  return node.Mark().line >= 0 ? node.Mark().line + 1 : 0;
}

std::string describe(YamlReader::Range range) {
  std::ostringstream text;
  text << "a finite number from " << range.minimum << " to " << range.maximum;
  return text.str();
}

/// One number of a scalar node; false when it is none, not finite or out of range.
bool to_number(const YAML::Node& node, YamlReader::Range range, double& value) {
  return node.IsScalar() && YAML::convert<double>::decode(node, value) && range.holds(value);
}

}  // namespace

struct YamlReader::Node {
  std::shared_ptr<Faults> faults;
  YAML::Node yaml;
  std::string prefix;  ///< path of keys down to here, for faults
  std::set<std::string> asked;
  KeysAsked* keys{nullptr};

  /// Where `key` is noted; nowhere when nobody notes.
  KeyAsked* note(const std::string& key, KeyAsked::Kind kind, Range range = {}) const {
    if (keys == nullptr) return nullptr;
    const std::string path = prefix + key;
    for (KeyAsked& known : *keys) {
      if (known.path == path) return &known;
    }
    KeyAsked added;
    added.path = path;
    added.kind = kind;
    added.range = range;
    keys->push_back(std::move(added));
    return &keys->back();
  }

  /// The value under `key`, or nothing (a fault when `required`).
  std::optional<YAML::Node> find(const std::string& key, bool required) {
    asked.insert(key);
    const YAML::Node& mapping = yaml;
    if (mapping.IsMap()) {
      if (const YAML::Node value = mapping[key]; value.IsDefined() && !value.IsNull()) return value;
    }
    if (required) faults->add(Errc::BadFormat, line_of(yaml), prefix + key, "missing");
    return std::nullopt;
  }

  void check_unknown_keys() {
    if (!yaml.IsMap()) return;
    for (const auto& entry : yaml) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
      if (!asked.contains(key))
        faults->add(Errc::UnknownKey, line_of(entry.first), prefix + key, "not a key of this file");
    }
  }
};

YamlReader::YamlReader(std::unique_ptr<Node> node) : node_{std::move(node)} {}
YamlReader::YamlReader(YamlReader&&) noexcept = default;
YamlReader& YamlReader::operator=(YamlReader&&) noexcept = default;
YamlReader::~YamlReader() {
  // A child reports its unknown keys when it goes out of scope: it lives no longer than its parent.
  if (node_ && !node_->prefix.empty()) node_->check_unknown_keys();
}

Result<YamlReader> YamlReader::open(const std::filesystem::path& path) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(path, k_most_settings_bytes));
  return parse(text, path.string());
}

Result<YamlReader> YamlReader::parse(const std::string& text, const std::string& name) {
  auto node = std::make_unique<Node>();
  node->faults = std::make_shared<Faults>();
  node->faults->file = name;
  try {
    node->yaml = YAML::Load(text);
  } catch (const YAML::Exception& fault) {
    return fail(Errc::BadFormat, "%s line %d, column %d: %s", name.c_str(), fault.mark.line + 1,
                fault.mark.column + 1, fault.msg.c_str());
  }
  if (!node->yaml.IsMap()) return fail(Errc::BadFormat, "%s: a mapping of keys expected", name.c_str());
  std::set<std::string> keys;
  for (const auto& entry : node->yaml) {
    if (entry.first.IsScalar() && !keys.insert(entry.first.Scalar()).second) {
      node->faults->add(Errc::BadFormat, line_of(entry.first), entry.first.Scalar(), "stands twice");
    }
  }
  return YamlReader{std::move(node)};
}

void YamlReader::note_keys(KeysAsked& keys) {
  node_->keys = &keys;
}

bool YamlReader::has(const std::string& key) const {
  const YAML::Node& mapping = node_->yaml;
  return mapping.IsMap() && mapping[key].IsDefined() && !mapping[key].IsNull();
}

int YamlReader::line_at(const std::string& key) const {
  const YAML::Node& mapping = node_->yaml;
  return has(key) ? line_of(mapping[key]) : 0;
}

double YamlReader::number(const std::string& key, Range range) {
  KeyAsked* const noted = node_->note(key, KeyAsked::Kind::Number, range);
  const auto found = node_->find(key, true);
  double value = 0;
  if (!found) return 0;
  if (!to_number(*found, range, value)) {
    fault(Errc::BadValue, key, describe(range) + " expected");
    return 0;
  }
  if (noted != nullptr) noted->numbers = {value};
  return value;
}

long YamlReader::integer(const std::string& key, Range range) {
  // Beyond 2^53 a double skips whole numbers, and far beyond it fits no integer.
  constexpr double k_exact = 9007199254740992;
  node_->note(key, KeyAsked::Kind::Integer, range);
  const double value = number(
      key, {.minimum = std::max(range.minimum, -k_exact), .maximum = std::min(range.maximum, k_exact)});
  if (value != std::floor(value)) fault(Errc::BadValue, key, "a whole number expected");
  return static_cast<long>(value);
}

bool YamlReader::boolean(const std::string& key) {
  const auto found = node_->find(key, true);
  bool value = false;
  if (found && !(found->IsScalar() && YAML::convert<bool>::decode(*found, value))) {
    fault(Errc::BadValue, key, "true or false expected");
  }
  return value;
}

std::string YamlReader::text(const std::string& key) {
  KeyAsked* const noted = node_->note(key, KeyAsked::Kind::Text);
  const auto found = node_->find(key, true);
  if (!found) return {};
  if (!found->IsScalar()) {
    fault(Errc::BadValue, key, "text expected");
    return {};
  }
  if (!bounds::fits(found->Scalar(), bounds::k_value)) {
    fault(Errc::BadValue, key, bounds::expected(bounds::k_value));
    return {};
  }
  if (noted != nullptr) noted->text = found->Scalar();
  return found->Scalar();
}

std::vector<double> YamlReader::numbers(const std::string& key, std::size_t count, Range range) {
  std::vector<double> values(count, 0.0);
  KeyAsked* const noted = node_->note(key, KeyAsked::Kind::Numbers, range);
  if (noted != nullptr) noted->count = count;
  const auto found = node_->find(key, true);
  if (!found) return values;
  bool good = found->IsSequence() && found->size() == count;
  for (std::size_t i = 0; good && i < count; ++i) good = to_number((*found)[i], range, values[i]);
  if (!good) {
    fault(Errc::BadValue, key, std::to_string(count) + " times " + describe(range) + " expected");
    values.assign(count, 0.0);
  } else if (noted != nullptr) {
    noted->numbers = values;
  }
  return values;
}

std::vector<double> YamlReader::matrix(const std::string& key, std::size_t rows, std::size_t columns,
                                       Range range) {
  std::vector<double> values(rows * columns, 0.0);
  const auto found = node_->find(key, true);
  if (!found) return values;
  bool good = found->IsSequence() && found->size() == rows;
  for (std::size_t i = 0; good && i < rows; ++i) {
    const YAML::Node row = (*found)[i];
    good = row.IsSequence() && row.size() == columns;
    for (std::size_t j = 0; good && j < columns; ++j)
      good = to_number(row[j], range, values[i * columns + j]);
  }
  if (!good) {
    fault(Errc::BadValue, key,
          std::to_string(rows) + " rows of " + std::to_string(columns) + " times " + describe(range) +
              " expected");
    values.assign(rows * columns, 0.0);
  }
  return values;
}

std::vector<std::string> YamlReader::texts(const std::string& key) {
  const auto found = node_->find(key, true);
  std::vector<std::string> values;
  if (!found) return values;
  bool good = found->IsSequence();
  for (std::size_t i = 0; good && i < found->size(); ++i) {
    good = (*found)[i].IsScalar();
    if (good) values.push_back((*found)[i].Scalar());
  }
  if (!good) fault(Errc::BadValue, key, "a list of texts expected");
  return values;
}

double YamlReader::number_or(const std::string& key, double fallback, Range range) {
  if (KeyAsked* const noted = node_->note(key, KeyAsked::Kind::Number, range)) {
    noted->required = false;
    noted->default_number = fallback;
  }
  return node_->find(key, false) ? number(key, range) : fallback;
}

long YamlReader::integer_or(const std::string& key, long fallback, Range range) {
  if (KeyAsked* const noted = node_->note(key, KeyAsked::Kind::Integer, range)) {
    noted->required = false;
    noted->default_number = static_cast<double>(fallback);
  }
  return node_->find(key, false) ? integer(key, range) : fallback;
}

bool YamlReader::boolean_or(const std::string& key, bool fallback) {
  return node_->find(key, false) ? boolean(key) : fallback;
}

std::string YamlReader::text_or(const std::string& key, const std::string& fallback) {
  if (KeyAsked* const noted = node_->note(key, KeyAsked::Kind::Text)) {
    noted->required = false;
    noted->default_text = fallback;
  }
  return node_->find(key, false) ? text(key) : fallback;
}

std::string YamlReader::choice_or_first(const std::string& key, const std::vector<std::string>& choices) {
  if (KeyAsked* const noted = node_->note(key, KeyAsked::Kind::Choice)) noted->choices = choices;
  const std::string word = text_or(key, choices.front());
  if (std::find(choices.begin(), choices.end(), word) != choices.end()) return word;
  std::string expected;
  for (std::size_t i = 0; i < choices.size(); ++i)
    expected += (i == 0 ? "" : i + 1 == choices.size() ? " or " : ", ") + choices[i];
  fault(Errc::BadValue, key, expected);
  return choices.front();
}

YamlReader YamlReader::child(const std::string& key, bool required) {
  auto node = std::make_unique<Node>();
  node->faults = node_->faults;
  node->prefix = node_->prefix + key + ".";
  node->keys = node_->keys;
  if (const auto found = node_->find(key, required)) {
    if (found->IsMap()) {
      node->yaml = *found;
    } else {
      fault(Errc::BadFormat, key, "a mapping expected");
    }
  }
  return YamlReader{std::move(node)};
}

std::vector<YamlReader> YamlReader::children(const std::string& key, std::size_t most) {
  std::vector<YamlReader> out;
  const auto found = node_->find(key, false);
  if (!found) return out;
  if (!found->IsSequence() || found->size() > most) {
    fault(Errc::BadFormat, key, "a list of at most " + std::to_string(most) + " mappings expected");
    return out;
  }
  for (std::size_t i = 0; i < found->size(); ++i) {
    const YAML::Node item = (*found)[i];
    auto node = std::make_unique<Node>();
    node->faults = node_->faults;
    node->prefix = node_->prefix + key + "[" + std::to_string(i) + "].";
    node->keys = node_->keys;
    if (item.IsMap()) {
      node->yaml = item;
    } else {
      node_->faults->add(Errc::BadFormat, line_of(item), node_->prefix + key + "[" + std::to_string(i) + "]",
                         "a mapping expected");
    }
    out.push_back(YamlReader{std::move(node)});
  }
  return out;
}

void YamlReader::fault(Errc code, const std::string& key, const std::string& expected) {
  const YAML::Node& mapping = node_->yaml;
  const int line = mapping.IsMap() && mapping[key].IsDefined() ? line_of(mapping[key]) : line_of(mapping);
  node_->faults->add(code, line, node_->prefix + key, expected);
}

Result<void> YamlReader::finish() {
  node_->check_unknown_keys();
  if (!node_->faults->first) return {};
  Error error = *node_->faults->first;
  error.more_faults = node_->faults->count - 1;
  return tl::unexpected<Error>(error);
}

}  // namespace biteline::config
