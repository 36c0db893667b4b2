// SPDX-License-Identifier: MIT
#include "host/cloud/column_names.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace biteline::cloud {
namespace {

/// What may stand beside the letter of an axis; with any other word the column is another quantity.
constexpr auto k_place_words = std::to_array<std::string_view>({"coord",
                                                                "coords",
                                                                "coordinate",
                                                                "coordinates",
                                                                "koordinate",
                                                                "koordinaten",
                                                                "coordonnee",
                                                                "coordonn\xC3\xA9"
                                                                "e",
                                                                "coordonn\xE9"
                                                                "e",
                                                                "coordenada",
                                                                "coordinata",
                                                                "pos",
                                                                "position",
                                                                "positions",
                                                                "point",
                                                                "points",
                                                                "pt",
                                                                "punkt",
                                                                "punto",
                                                                "vertex",
                                                                "vertices",
                                                                "loc",
                                                                "location",
                                                                "world",
                                                                "global",
                                                                "abs",
                                                                "absolute",
                                                                "value",
                                                                "wert",
                                                                "val",
                                                                "axis",
                                                                "achse",
                                                                "axe",
                                                                "xyz",
                                                                "cart",
                                                                "cartesian",
                                                                "actual",
                                                                "ist",
                                                                "measured",
                                                                "data",
                                                                "p",
                                                                "3d",
                                                                "center",
                                                                "centroid"});
/// A numbered component is a place only of these.
constexpr auto k_numbered =
    std::to_array<std::string_view>({"point", "points", "xyz", "coord", "coords", "coordinate", "coordinates",
                                     "pos", "position", "positions", "vertex", "vertices", "location"});

bool is_letter(char c) {
  return ((c | 0x20) >= 'a' && (c | 0x20) <= 'z') || static_cast<signed char>(c) < 0;
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// "posX [mm]" -> pos, x, mm.
std::vector<std::string> name_words(std::string_view name) {
  std::vector<std::string> words;
  char before = ' ';
  for (const char c : name) {
    const bool part = is_letter(c) || is_digit(c);
    const bool hump = c >= 'A' && c <= 'Z' && before >= 'a' && before <= 'z';
    const bool number_begins = is_digit(c) && is_letter(before);
    if (part) {
      if (words.empty() || hump || number_begins || !(is_letter(before) || is_digit(before)))
        words.emplace_back();
      words.back() += c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
    }
    before = c;
  }
  return words;
}

struct Axis {
  std::size_t axis{0};
  std::string stem;  ///< the name without axis and unit: names of one place share it
  std::size_t words{0};
  std::optional<Unit> unit;
};

template <class Words>
bool one_of(const Words& words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

/// The letter may stand at the end of a place's word, too: "coordx", "posy".
std::optional<std::size_t> axis_letter(std::string& word) {
  if (word.size() == 1 && word[0] >= 'x' && word[0] <= 'z') return static_cast<std::size_t>(word[0] - 'x');
  const auto glued = [&](char letter, std::string rest) -> std::optional<std::size_t> {
    if (letter < 'x' || letter > 'z' || rest.size() < 3 || !one_of(k_place_words, rest)) return std::nullopt;
    word = std::move(rest);
    return static_cast<std::size_t>(letter - 'x');
  };
  if (word.size() < 4) return std::nullopt;
  if (const auto axis = glued(word.back(), word.substr(0, word.size() - 1))) return axis;
  return glued(word.front(), word.substr(1));
}

std::optional<Axis> axis_of(std::string_view name) {
  std::vector<std::string> words = name_words(name);
  Axis axis;
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::string& word = words[i];
    if (const auto letter = axis_letter(word)) {
      if (found) return std::nullopt;  // "x y", "x_z"
      found = letter;
      if (word.size() == 1) continue;
    } else if (const auto unit = unit_of_word(word)) {
      // "X in mm" has two of them.
      if (!axis.unit || axis.unit == Unit::Inch) axis.unit = unit;
      continue;
    }
    const bool component = i > 0 && i + 1 == words.size() && !found && word.size() == 1 && word[0] >= '0' &&
                           word[0] <= '2' &&
                           std::all_of(words.begin(), words.end() - 1,
                                       [](const auto& other) { return one_of(k_numbered, other); });
    if (component) {
      found = static_cast<std::size_t>(word[0] - '0');
      continue;
    }
    if (!one_of(k_place_words, word)) return std::nullopt;
    axis.stem += word + ' ';
    ++axis.words;
  }
  if (!found) return std::nullopt;
  axis.axis = *found;
  return axis;
}

}  // namespace

std::optional<NamedColumns> named_columns(const std::vector<std::string_view>& names) {
  struct Triple {
    NamedColumns columns;
    std::array<bool, 3> found{};
    std::size_t words{0}, first{0};
  };
  std::map<std::string, Triple> triples;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto axis = axis_of(names[i]);
    if (!axis) continue;
    Triple& triple =
        triples.try_emplace(axis->stem, Triple{.columns = {}, .found = {}, .words = axis->words, .first = i})
            .first->second;
    if (std::exchange(triple.found[axis->axis], true)) continue;  // the first one of a name
    triple.columns.field[axis->axis] = i;
    triple.columns.unit[axis->axis] = axis->unit;
  }
  const Triple* best = nullptr;
  for (const auto& [stem, triple] : triples) {
    if (!(triple.found[0] && triple.found[1] && triple.found[2])) continue;
    if (best == nullptr || std::pair{triple.words, triple.first} < std::pair{best->words, best->first})
      best = &triple;
  }
  return best == nullptr ? std::nullopt : std::optional{best->columns};
}

}  // namespace biteline::cloud
