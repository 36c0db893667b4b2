// SPDX-License-Identifier: MIT
#include "host/fleet/messages.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/core/text.hpp"
#include "host/doors/control/messages.hpp"

namespace biteline::fleet {
namespace {

using control::Json;

constexpr std::string_view k_root = "biteline/1/cells/";
constexpr std::size_t k_most_text_bytes = 2000;
constexpr std::int64_t k_most_number = 1LL << 53;

/// Reads fields and remembers the first that is wrong.
class Reader {
 public:
  Reader(std::string_view text, const char* what) : what_{what} {
    if (std::optional<Json> json = control::parse_bounded(text); json && json->is_object()) {
      json_ = std::move(*json);
    } else {
      fault("a JSON object");
    }
  }

  std::string text(const char* key, std::size_t most = k_most_text_bytes) {
    const Json* const value = find(key);
    if (value == nullptr || !value->is_string()) return fault(key), std::string{};
    auto text = value->get<std::string>();
    if (text.size() > most || text.find('\0') != std::string::npos) return fault(key), std::string{};
    return text;
  }
  std::int64_t whole(const char* key) {
    const Json* const value = find(key);
    if (value == nullptr || !value->is_number_integer()) return fault(key), 0;
    const auto number = value->get<std::int64_t>();
    if (number < 0 || number > k_most_number) return fault(key), 0;
    return number;
  }
  bool truth(const char* key) {
    const Json* const value = find(key);
    if (value == nullptr || !value->is_boolean()) return fault(key), false;
    return value->get<bool>();
  }
  std::optional<double> number_if(const char* key) {
    const Json* const value = find(key);
    if (value == nullptr || value->is_null()) return std::nullopt;
    if (!value->is_number() || !std::isfinite(value->get<double>())) return fault(key), std::nullopt;
    return value->get<double>();
  }
  const Json* find(const char* key) const {
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
  }
  void fault(const char* key) {
    if (wrong_.empty()) wrong_ = key;
  }
  Result<void> finish() const {
    if (wrong_.empty()) return {};
    return fail(Errc::ProtocolError, "%s of a cell: %s is missing or out of bounds", what_, wrong_.c_str());
  }

 private:
  const char* what_;
  Json json_ = Json::object();
  std::string wrong_;
};

Json or_null(const std::optional<double>& number) {
  return number ? Json(*number) : Json{};
}

std::string dump(const Json& json) {
  // Texts of the memory may hold anything: what is no UTF-8 is replaced.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::optional<memory::Places> read_places(Reader& reader) {
  const Json* const list = reader.find("places");
  if (list == nullptr || list->is_null()) return std::nullopt;
  memory::Places places{};
  if (!list->is_array() || list->size() != places.size()) {
    reader.fault("places");
    return std::nullopt;
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Json& place = (*list)[i];
    if (!place.is_number() || std::abs(place.get<double>()) > 1e6) {
      reader.fault("places");
      return std::nullopt;
    }
    places.at(i) = place.get<float>();
  }
  return places;
}

std::string topic(const std::string& cell, const char* kind) {
  return std::string{k_root} + cell + "/" + kind;
}

}  // namespace

bool is_cell_name(std::string_view name) {
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, [](unsigned char letter) {
    return letter < 128 && (std::isalnum(letter) != 0 || letter == '-' || letter == '_');
  });
}

std::string shoes_topic(const std::string& cell) {
  return topic(cell, "shoes");
}
std::string health_topic(const std::string& cell) {
  return topic(cell, "health");
}
std::string committed_topic(const std::string& cell) {
  return topic(cell, "committed");
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

std::string to_text(const ShoeMessage& shoe) {
  const memory::Scan& scan = shoe.scan;
  Json json{{"book", shoe.book},
            {"seq", shoe.seq},
            {"after", shoe.after},
            {"scan", scan.name},
            {"time_ms", scan.time},
            {"model", scan.model},
            {"verdict", scan.verdict},
            {"reason_code", scan.reason_code},
            {"reason", clean_text(scan.reason, k_most_text_bytes)},
            {"length_mm", or_null(scan.length_mm)},
            {"confidence", or_null(scan.confidence)},
            {"u95_mm", or_null(scan.u95_mm)},
            {"cycle_s", or_null(scan.cycle_s)},
            {"process", scan.process},
            {"decision", scan.decision},
            {"sent", scan.sent},
            {"followed", scan.followed.value_or(false)},
            {"places", nullptr}};
  if (shoe.places) json["places"] = *shoe.places;
  return dump(json);
}

Result<ShoeMessage> read_shoe(std::string_view text) {
  Reader reader{text, "shoe"};
  ShoeMessage shoe;
  shoe.book = reader.text("book", 64);
  shoe.seq = reader.whole("seq");
  shoe.after = reader.whole("after");
  shoe.scan.name = reader.text("scan", 64);
  shoe.scan.time = reader.whole("time_ms");
  shoe.scan.model = reader.text("model", 200);
  shoe.scan.verdict = reader.text("verdict", 20);
  shoe.scan.reason_code = reader.text("reason_code", 100);
  shoe.scan.reason = reader.text("reason");
  shoe.scan.length_mm = reader.number_if("length_mm");
  shoe.scan.confidence = reader.number_if("confidence");
  shoe.scan.u95_mm = reader.number_if("u95_mm");
  shoe.scan.cycle_s = reader.number_if("cycle_s");
  shoe.scan.process = reader.text("process", 200);
  shoe.scan.decision = reader.text("decision", 20);
  shoe.scan.sent = reader.truth("sent");
  shoe.scan.followed = reader.truth("followed");
  shoe.places = read_places(reader);
  if (shoe.seq <= shoe.after || shoe.scan.name.empty() || shoe.book.empty())
    reader.fault("seq, scan or book");
  BITELINE_TRY(reader.finish());
  return shoe;
}

std::string to_text(const HealthMessage& health) {
  return dump({{"online", health.online},
               {"version", health.version},
               {"book", health.book},
               {"waiting", health.waiting}});
}

Result<HealthMessage> read_health(std::string_view text) {
  Reader reader{text, "health"};
  HealthMessage health{.online = reader.truth("online"),
                       .version = reader.text("version", 64),
                       .book = reader.text("book", 64),
                       .waiting = reader.whole("waiting")};
  BITELINE_TRY(reader.finish());
  return health;
}

std::string to_text(const CommittedMessage& committed) {
  return dump({{"book", committed.book}, {"seq", committed.seq}});
}

Result<CommittedMessage> read_committed(std::string_view text) {
  Reader reader{text, "committed"};
  CommittedMessage committed{.book = reader.text("book", 64), .seq = reader.whole("seq")};
  BITELINE_TRY(reader.finish());
  return committed;
}

}  // namespace biteline::fleet
