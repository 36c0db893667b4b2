// SPDX-License-Identifier: MIT
#include "host/fleet/messages.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/core/text.hpp"
#include "host/fleet/fields.hpp"

namespace biteline::fleet {
namespace {

constexpr std::string_view k_root = "biteline/1/cells/";

Json or_null(const std::optional<double>& number) {
  return number ? Json(*number) : Json{};
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
    if (!place.is_number() || std::abs(place.get<double>()) > 1e6) {
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
            {"release", shoe.release},
            {"places", nullptr}};
  if (shoe.places) json["places"] = *shoe.places;
  return dump(json);
}

Result<ShoeMessage> read_shoe(std::string_view text) {
  Fields reader{text, "shoe of a cell"};
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
  // Cells of before there were releases do not say it.
  if (reader.find("release") != nullptr) shoe.release = reader.text("release", 64);
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
  Fields reader{text, "health of a cell"};
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
  Fields reader{text, "committed of a cell"};
  CommittedMessage committed{.book = reader.text("book", 64), .seq = reader.whole("seq")};
  BITELINE_TRY(reader.finish());
  return committed;
}

}  // namespace biteline::fleet
