// SPDX-License-Identifier: MIT
#include "host/fleet/release_messages.hpp"

#include <limits>

#include "host/fleet/fields.hpp"
#include "host/records/release/key_lines.hpp"
#include "host/records/release/manifest.hpp"
#include "host/records/release/order.hpp"

namespace biteline::fleet {
namespace {

constexpr std::size_t k_most_hashes = 16;
constexpr std::size_t k_most_head_bytes = 200;

std::string to_hex(std::string_view bytes) {
  constexpr const char* k_digits = "0123456789abcdef";
  std::string text;
  for (const char byte : bytes) {
    text += k_digits[static_cast<unsigned char>(byte) >> 4U];
    text += k_digits[static_cast<unsigned char>(byte) & 15U];
  }
  return text;
}

std::optional<std::string> from_hex(std::string_view text) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  std::string bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    const int high = digit(text[i]), low = digit(text[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    bytes += static_cast<char>(high * 16 + low);
  }
  return text.size() % 2 == 0 ? std::optional{bytes} : std::nullopt;
}

std::string hash(Fields& fields, const char* key) {
  std::string text = fields.text(key, 64);
  if (!release::is_sha256(text)) fields.fault(key);
  return text;
}

std::string signature(Fields& fields) {
  const std::optional<std::string> bytes = from_hex(fields.text("signature", 2 * release::k_signature_bytes));
  if (!bytes) fields.fault("signature");
  return bytes.value_or("");
}

}  // namespace

std::string to_text(const ReleasePlan& plan) {
  Json json{{"manifest", plan.manifest}, {"signature", to_hex(plan.signature)}, {"switch", nullptr}};
  if (plan.turn) {
    json["switch"] = {
        {"order", plan.turn->order}, {"signature", to_hex(plan.turn->signature)}, {"sure", plan.turn->sure}};
  }
  return dump(json);
}

Result<ReleasePlan> read_release_plan(std::string_view text) {
  Fields fields{text, "plan of the centre"};
  ReleasePlan plan;
  plan.manifest = fields.text("manifest", release::k_most_manifest_bytes);
  plan.signature = signature(fields);
  const Json* const turn = fields.find("switch");
  if (turn == nullptr) fields.fault("switch");
  BITELINE_TRY(fields.finish());
  if (turn->is_null()) return plan;
  Fields of{turn->dump(), "switch of the centre"};
  plan.turn = ReleasePlan::Switch{.order = of.text("order", release::k_most_order_bytes),
                                  .signature = signature(of),
                                  .sure = of.truth("sure")};
  BITELINE_TRY(of.finish());
  return plan;
}

std::string to_text(const ReleaseWord& word) {
  return dump({{"has", word.has},
               {"current", word.current},
               {"number", word.number},
               {"newest", word.newest},
               {"refused", word.refused},
               {"fault", word.fault},
               {"clock_ms", word.clock_ms}});
}

Result<ReleaseWord> read_release_word(std::string_view text) {
  Fields fields{text, "word of a cell on releases"};
  ReleaseWord word{.has = {},
                   .current = fields.text("current", 64),
                   .number = fields.whole("number"),
                   .newest = fields.whole("newest"),
                   .refused = fields.whole("refused"),
                   .fault = fields.text("fault"),
                   .clock_ms = fields.whole("clock_ms")};
  // Columns of the centre's: a number beyond them would end the work for all cells.
  if (word.number > std::numeric_limits<std::int32_t>::max()) fields.fault("number");
  if (word.newest > std::numeric_limits<std::int32_t>::max()) fields.fault("newest");
  if (word.refused > std::numeric_limits<std::int32_t>::max()) fields.fault("refused");
  if (!word.current.empty() && !release::is_sha256(word.current)) fields.fault("current");
  const Json* const has = fields.find("has");
  if (has == nullptr || !has->is_array() || has->size() > k_most_hashes) {
    fields.fault("has");
  } else {
    for (const Json& one : *has) {
      if (one.is_string() && release::is_sha256(one.get_ref<const std::string&>())) {
        word.has.push_back(one.get<std::string>());
      } else {
        fields.fault("has");
      }
    }
  }
  BITELINE_TRY(fields.finish());
  return word;
}

std::string to_text(const PartAsk& ask) {
  return dump({{"sha256", ask.sha256}, {"at", ask.at}});
}

Result<PartAsk> read_part_ask(std::string_view text) {
  Fields fields{text, "ask of a cell"};
  PartAsk ask{.sha256 = hash(fields, "sha256"), .at = fields.whole("at")};
  BITELINE_TRY(fields.finish());
  return ask;
}

std::string to_payload(const Part& part) {
  return dump({{"sha256", part.sha256}, {"at", part.at}}) + "\n" + part.bytes;
}

Result<Part> read_part(std::string_view payload) {
  const std::size_t end = payload.substr(0, k_most_head_bytes).find('\n');
  if (end == std::string_view::npos || payload.size() - end - 1 > k_part_bytes)
    return fail(Errc::ProtocolError, "part of a release: a line, then at most %zu bytes expected",
                k_part_bytes);
  Fields fields{payload.substr(0, end), "part of a release"};
  Part part{.sha256 = hash(fields, "sha256"),
            .at = fields.whole("at"),
            .bytes = std::string{payload.substr(end + 1)}};
  BITELINE_TRY(fields.finish());
  return part;
}

}  // namespace biteline::fleet
