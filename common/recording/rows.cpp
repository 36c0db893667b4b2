// SPDX-License-Identifier: MIT
#include "common/recording/rows.hpp"

#include <cstdio>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

namespace biteline::recording {
namespace {

using Json = nlohmann::ordered_json;

Result<Json> object_of(std::span<const std::uint8_t> message) {
  Json json = Json::parse(message.begin(), message.end(), nullptr, false);
  if (!json.is_object()) return fail(Errc::BadFormat, "a JSON object expected");
  return json;
}

Result<std::int64_t> signed_whole_of(const Json& json, const char* key) {
  const auto value = json.find(key);
  if (value == json.end() || !value->is_number_integer())
    return fail(Errc::BadValue, "%s: a whole number expected", key);
  return value->get<std::int64_t>();
}

Result<void> take_numbers(const Json& json, const char* key, std::span<double> out) {
  const auto list = json.find(key);
  if (list == json.end() || !list->is_array() || list->size() != out.size())
    return fail(Errc::BadValue, "%s: %zu numbers expected", key, out.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!(*list)[i].is_number()) return fail(Errc::BadValue, "%s: numbers expected", key);
    out[i] = (*list)[i].get<double>();
  }
  return {};
}

template <class Whole>
Result<Whole> whole_of(const Json& json, const char* key) {
  const auto value = json.find(key);
  constexpr auto k_most = static_cast<std::uint64_t>(std::numeric_limits<Whole>::max());
  if (value == json.end() || !value->is_number_unsigned() || value->get<std::uint64_t>() > k_most)
    return fail(Errc::BadValue, "%s: a whole number from 0 expected", key);
  return static_cast<Whole>(value->get<std::uint64_t>());
}

bool is_plain_name(const std::string& name) {
  return !name.empty() && name != "." && name != ".." &&
         name.find_first_of(std::string{"/,\"#\r\n\0", 8}) == std::string::npos && name.size() < 200;
}

}  // namespace

std::string message_of(const PoseRow& row) {
  const auto& v = row.values;
  Json json{{"stamp_ns", row.stamp_ns}, {"p_mm", {v[0], v[1], v[2]}}, {"q_wxyz", {v[3], v[4], v[5], v[6]}}};
  if (row.encoder_ticks) json["encoder_ticks"] = *row.encoder_ticks;
  return json.dump();
}

Result<PoseRow> pose_row_of(std::span<const std::uint8_t> message) {
  BITELINE_ASSIGN(const Json json, object_of(message));
  PoseRow row;
  BITELINE_ASSIGN(row.stamp_ns, signed_whole_of(json, "stamp_ns"));
  BITELINE_TRY(take_numbers(json, "p_mm", std::span{row.values}.first(3)));
  BITELINE_TRY(take_numbers(json, "q_wxyz", std::span{row.values}.last(4)));
  if (!json.contains("encoder_ticks")) return row;
  BITELINE_ASSIGN(row.encoder_ticks, signed_whole_of(json, "encoder_ticks"));
  return row;
}

std::string table_row(const PoseRow& row) {
  const auto& v = row.values;
  char line[320];
  std::snprintf(line, sizeof line, "%lld,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n",
                static_cast<long long>(row.stamp_ns), v[0], v[1], v[2], v[3], v[4], v[5], v[6]);
  return line;
}

std::string message_of(const FrameRow& row) {
  Json json{{"stamp_ns", row.stamp_ns}, {"file", row.file}};
  if (row.facts) {
    json["sequence"] = row.facts->sequence;
    json["flags"] = row.facts->flags;
    json["first_row_px"] = row.facts->first_row_px;
    json["rows_px"] = row.facts->rows_px;
  }
  // A name of a strange file system stays what it is but for bytes that are no UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<FrameRow> frame_row_of(std::span<const std::uint8_t> message) {
  BITELINE_ASSIGN(const Json json, object_of(message));
  FrameRow row;
  BITELINE_ASSIGN(row.stamp_ns, signed_whole_of(json, "stamp_ns"));
  const auto file = json.find("file");
  if (file == json.end() || !file->is_string() || !is_plain_name(file->get<std::string>()))
    return fail(Errc::BadValue, "file: a plain file name expected");
  row.file = file->get<std::string>();
  if (!json.contains("sequence")) return row;
  FrameRow::Facts facts;
  BITELINE_ASSIGN(facts.sequence, whole_of<std::uint64_t>(json, "sequence"));
  BITELINE_ASSIGN(facts.flags, whole_of<std::uint32_t>(json, "flags"));
  BITELINE_ASSIGN(facts.first_row_px, whole_of<int>(json, "first_row_px"));
  BITELINE_ASSIGN(facts.rows_px, whole_of<int>(json, "rows_px"));
  row.facts = facts;
  return row;
}

}  // namespace biteline::recording
