// SPDX-License-Identifier: MIT
#include "host/fleet/messages.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

#include "common/core/text.hpp"
#include "host/fleet/fields.hpp"

namespace biteline::fleet {
namespace {

constexpr std::string_view k_root = "biteline/1/cells/";

constexpr double k_most_place_mm = 1e6;
constexpr const char* k_unread = "unread";

/// The texts of a shoe on their way, and how long each may be at both ends.
struct TextField {
  const char* key;
  std::string memory::Scan::*text;
  std::size_t most_bytes;
};
constexpr std::array k_texts{TextField{"model", &memory::Scan::model, bounds::k_title},
                             TextField{"verdict", &memory::Scan::verdict, bounds::k_choice},
                             TextField{"reason_code", &memory::Scan::reason_code, bounds::k_word},
                             TextField{"reason", &memory::Scan::reason, bounds::k_reason},
                             TextField{"process", &memory::Scan::process, bounds::k_title},
                             TextField{"decision", &memory::Scan::decision, bounds::k_choice}};
/// Cells of before these were told say none of them.
constexpr std::array k_newer_texts{TextField{"part", &memory::Scan::part, bounds::k_name},
                                   TextField{"foot", &memory::Scan::foot, bounds::k_choice},
                                   TextField{"size", &memory::Scan::size, bounds::k_size},
                                   TextField{"follows", &memory::Scan::follows, bounds::k_name}};
struct NumberField {
  const char* key;
  std::optional<double> memory::Scan::*number;
};
constexpr std::array k_numbers{
    NumberField{"length_mm", &memory::Scan::length_mm}, NumberField{"confidence", &memory::Scan::confidence},
    NumberField{"u95_mm", &memory::Scan::u95_mm}, NumberField{"cycle_s", &memory::Scan::cycle_s}};

struct CountField {
  const char* key;
  int memory::Work::*count;
};
constexpr std::array k_work_counts{
    CountField{"work_narrow", &memory::Work::narrow}, CountField{"work_wide", &memory::Work::wide},
    CountField{"work_beside", &memory::Work::beside}, CountField{"work_doubled", &memory::Work::doubled}};
/// Of a line no more are told apart.
constexpr std::int64_t k_most_stretches = 1'000'000;

/// Of a row whose scan has no name that could be one.
std::string name_of_row(std::int64_t seq) {
  return "row-" + std::to_string(seq);
}

bool are_places(const memory::Places& places) {
  return std::ranges::all_of(
      places, [](float place) { return std::isfinite(place) && std::abs(place) <= k_most_place_mm; });
}

/// What stands behind `"key":` in a text that is no JSON; empty: nothing.
std::string_view behind_key(std::string_view text, std::string_view key) {
  const std::size_t at = text.find('"' + std::string{key} + '"');
  if (at == std::string_view::npos) return {};
  text.remove_prefix(at + key.size() + 2);
  const std::size_t begin = text.find_first_not_of(" :");
  return begin == std::string_view::npos ? std::string_view{} : text.substr(begin);
}

std::optional<std::int64_t> whole_behind(std::string_view text, std::string_view key) {
  text = behind_key(text, key);
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || number < 0 || number > k_most_number) return std::nullopt;
  return number;
}

/// A message that is no JSON, or too much of it: placed by its three numbers, without the rest.
std::optional<ShoeMessage> placed_alone(std::string_view text) {
  constexpr std::size_t k_head_bytes = 4096;  // they stand first
  text = text.substr(0, k_head_bytes);
  const std::string_view book = behind_key(text, "book");
  const std::size_t end = book.starts_with('"') ? book.find('"', 1) : std::string_view::npos;
  const auto seq = whole_behind(text, "seq"), after = whole_behind(text, "after");
  if (end == std::string_view::npos || end == 1 || end > bounds::k_name + 1 || !seq || !after ||
      *seq <= *after)
    return std::nullopt;
  ShoeMessage shoe;
  shoe.book = clean_text(book.substr(1, end - 1));
  shoe.seq = *seq;
  shoe.after = *after;
  shoe.scan.name = name_of_row(*seq);
  shoe.fault = "no JSON that can be read";
  return shoe;
}

/// What can be read is kept as it is; where the verdict is not, no other stands in for it.
void mark_unread(ShoeMessage& shoe) {
  memory::Scan& scan = shoe.scan;
  if (scan.name.empty()) scan.name = name_of_row(shoe.seq);
  if (scan.verdict.empty()) scan.verdict = k_unread;
  if (scan.decision.empty()) scan.decision = "open";
  if (scan.reason_code.empty()) scan.reason_code = "unread_row";
  if (scan.reason.empty()) scan.reason = "the centre could not read all of this row: " + shoe.fault;
}

std::optional<memory::Places> read_places(Fields& reader) {
  const Json* const list = reader.find("places");
  if (list == nullptr || list->is_null()) return std::nullopt;
  memory::Places places{};
  if (!list->is_array() || list->size() != places.size()) {
    reader.fault("places");
    return std::nullopt;
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Json& place = (*list)[i];
    if (!place.is_number() || !(std::abs(place.get<double>()) <= k_most_place_mm)) {
      reader.fault("places");
      return std::nullopt;
    }
    places.at(i) = place.get<float>();
  }
  return places;
}

}  // namespace

bool is_cell_name(std::string_view name) {
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, [](unsigned char letter) {
    return letter < 128 && (std::isalnum(letter) != 0 || letter == '-' || letter == '_');
  });
}

bool is_reserved_name(std::string_view name) {
  return name == "fleet" || name == "host";
}

std::string topic_of(const std::string& cell, const char* kind) {
  return std::string{k_root} + cell + "/" + kind;
}
std::string shoes_topic(const std::string& cell) {
  return topic_of(cell, "shoes");
}
std::string health_topic(const std::string& cell) {
  return topic_of(cell, "health");
}
std::string committed_topic(const std::string& cell) {
  return topic_of(cell, "committed");
}

std::string release_of(const memory::Scan& scan) {
  const std::optional<Json> versions = control::parse_bounded(scan.versions);
  if (!versions || !versions->is_object()) return {};
  const auto found = versions->find("release");
  return found != versions->end() && found->is_string() ? found->get<std::string>() : std::string{};
}

std::optional<std::string> cell_of(std::string_view topic, std::string_view kind) {
  if (!topic.starts_with(k_root) || !topic.ends_with(kind)) return std::nullopt;
  topic.remove_prefix(k_root.size());
  topic.remove_suffix(std::min(topic.size(), kind.size()));
  if (!topic.ends_with('/')) return std::nullopt;
  topic.remove_suffix(1);
  if (!is_cell_name(topic)) return std::nullopt;
  return std::string{topic};
}

memory::Scan fitted(const memory::Scan& scan, std::int64_t seq) {
  memory::Scan out = scan;
  if (out.name.empty() || !bounds::fits(out.name, bounds::k_name)) out.name = name_of_row(seq);
  out.time = std::clamp<memory::UnixMs>(out.time, 0, k_most_number);
  for (const TextField& field : k_texts) out.*field.text = bounds::fitted(scan.*field.text, field.most_bytes);
  for (const TextField& field : k_newer_texts)
    out.*field.text = bounds::fitted(scan.*field.text, field.most_bytes);
  for (const NumberField& field : k_numbers) {
    if (out.*field.number && !std::isfinite(*(out.*field.number))) (out.*field.number).reset();
  }
  out.work.verdict = bounds::fitted(scan.work.verdict, bounds::k_choice);
  if (out.work.missing_mm && !std::isfinite(*out.work.missing_mm)) out.work.missing_mm.reset();
  return out;
}

std::string to_text(const ShoeMessage& shoe) {
  const memory::Scan scan = fitted(shoe.scan, shoe.seq);
  Json json{{"book", shoe.book},
            {"seq", shoe.seq},
            {"after", shoe.after},
            {"scan", scan.name},
            {"time_ms", scan.time},
            {"sent", scan.sent},
            {"followed", scan.followed.value_or(false)},
            {"release", bounds::fitted(shoe.release, bounds::k_name)},
            {"places", nullptr}};
  for (const TextField& field : k_texts) json[field.key] = scan.*field.text;
  for (const TextField& field : k_newer_texts) json[field.key] = scan.*field.text;
  for (const NumberField& field : k_numbers)
    json[field.key] = scan.*field.number ? Json(*(scan.*field.number)) : Json{};
  json["work"] = scan.work.verdict;
  json["work_reworked"] = scan.work.reworked;
  json["work_missing_mm"] = scan.work.missing_mm ? Json(*scan.work.missing_mm) : Json{};
  for (const CountField& field : k_work_counts) json[field.key] = std::max(0, scan.work.*field.count);
  if (shoe.places && are_places(*shoe.places)) json["places"] = *shoe.places;
  return dump(json);
}

ShoeMessage bare_of(const ShoeMessage& shoe, const std::string& why) {
  ShoeMessage bare{.book = shoe.book, .seq = shoe.seq, .after = shoe.after, .scan = {}};
  bare.scan.time = std::clamp<memory::UnixMs>(shoe.scan.time, 0, memory::now_ms());
  bare.fault = why;
  mark_unread(bare);
  return bare;
}

Result<ShoeMessage> read_shoe(std::string_view text) {
  Fields reader{text, "shoe of a cell"};
  if (!reader.fault_words().empty()) {
    if (std::optional<ShoeMessage> alone = placed_alone(text)) {
      mark_unread(*alone);
      return std::move(*alone);
    }
  }
  ShoeMessage shoe;
  shoe.book = reader.text("book", bounds::k_name);
  shoe.seq = reader.whole("seq");
  shoe.after = reader.whole("after");
  if (shoe.seq <= shoe.after || shoe.book.empty()) reader.fault("seq, after or book");
  BITELINE_TRY(reader.finish());
  shoe.scan.name = reader.text("scan", bounds::k_name);
  if (shoe.scan.name.empty()) reader.fault("scan");
  shoe.scan.time = reader.whole("time_ms");
  for (const TextField& field : k_texts) shoe.scan.*field.text = reader.text(field.key, field.most_bytes);
  for (const TextField& field : k_newer_texts) {
    if (reader.find(field.key) != nullptr) shoe.scan.*field.text = reader.text(field.key, field.most_bytes);
  }
  for (const NumberField& field : k_numbers) shoe.scan.*field.number = reader.number_if(field.key);
  shoe.scan.sent = reader.truth("sent");
  shoe.scan.followed = reader.truth("followed");
  // Cells of before it was told say nothing of the work.
  if (reader.find("work") != nullptr) {
    shoe.scan.work.verdict = reader.text("work", bounds::k_choice);
    shoe.scan.work.reworked = reader.truth("work_reworked");
    shoe.scan.work.missing_mm = reader.number_if("work_missing_mm");
    for (const CountField& field : k_work_counts)
      shoe.scan.work.*field.count =
          static_cast<int>(std::min<std::int64_t>(reader.whole(field.key), k_most_stretches));
  }
  // Cells of before there were releases do not say it.
  if (reader.find("release") != nullptr) shoe.release = reader.text("release", bounds::k_name);
  shoe.places = read_places(reader);
  shoe.fault = reader.fault_words();
  // A stub that the cell itself made: its row was sent often, and never taken.
  if (shoe.fault.empty() && shoe.scan.verdict == k_unread)
    shoe.fault = "sent in vain as it is, so without its content";
  if (!shoe.fault.empty()) mark_unread(shoe);
  return shoe;
}

std::string to_text(const HealthMessage& health) {
  Json json{{"online", health.online},
            {"version", health.version},
            {"book", health.book},
            {"waiting", health.waiting}};
  if (health.log.row > 0) {
    json["log_row"] = health.log.row;
    json["log_link"] = health.log.link;
  }
  return dump(json);
}

Result<HealthMessage> read_health(std::string_view text) {
  Fields reader{text, "health of a cell"};
  HealthMessage health{.online = reader.truth("online"),
                       .version = reader.text("version", bounds::k_name),
                       .book = reader.text("book", bounds::k_name),
                       .waiting = reader.whole("waiting"),
                       .log = {}};
  // Cells of before this, and those whose log is empty, say neither.
  if (reader.find("log_row") != nullptr) {
    health.log = {.row = reader.whole("log_row"), .link = reader.text("log_link", bounds::k_name)};
    if (health.log.row < 1 || !memory::is_log_link(health.log.link)) reader.fault("log_link");
  }
  BITELINE_TRY(reader.finish());
  return health;
}

std::string to_text(const CommittedMessage& committed) {
  Json json{{"book", committed.book}, {"seq", committed.seq}};
  if (committed.dead > 0) {
    json["dead"] = committed.dead;
    json["letters"] = Json::array();
    for (const DeadLetter& letter : committed.letters)
      json["letters"].push_back({{"seq", letter.seq},
                                 {"scan", bounds::fitted(letter.scan, bounds::k_name)},
                                 {"why", bounds::fitted(letter.why, bounds::k_title)}});
  }
  if (!committed.held.empty()) json["held"] = bounds::fitted(committed.held, bounds::k_title);
  return dump(json);
}

Result<CommittedMessage> read_committed(std::string_view text) {
  Fields reader{text, "committed of a cell"};
  CommittedMessage committed{.book = reader.text("book", bounds::k_name), .seq = reader.whole("seq")};
  // A centre of before there were dead letters says nothing of them.
  if (reader.find("dead") != nullptr) committed.dead = reader.whole("dead");
  if (reader.find("held") != nullptr) committed.held = reader.text("held", bounds::k_title);
  if (const Json* const letters = reader.find("letters"); letters != nullptr) {
    if (!letters->is_array() || letters->size() > k_most_letters_told) {
      reader.fault("letters");
    } else {
      for (const Json& one : *letters) {
        Fields letter{dump(one), "letter"};
        committed.letters.push_back({.seq = letter.whole("seq"),
                                     .scan = letter.text("scan", bounds::k_name),
                                     .why = letter.text("why", bounds::k_title)});
        if (!letter.finish()) reader.fault("letters");
      }
    }
  }
  BITELINE_TRY(reader.finish());
  return committed;
}

}  // namespace biteline::fleet
