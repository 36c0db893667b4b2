// SPDX-License-Identifier: MIT
#include "host/fleet/sparkplug/node.hpp"

#include <cmath>
#include <utility>

#include "sparkplug/payload.pb.h"

namespace biteline::fleet::sparkplug {
namespace {

// Data types of the specification (6.4.16).
constexpr std::uint32_t k_int64 = 4;
constexpr std::uint32_t k_double = 10;
constexpr std::uint32_t k_boolean = 11;
constexpr std::uint32_t k_string = 12;
constexpr std::uint32_t k_date_time = 13;

constexpr const char* k_birth_number = "bdSeq";
constexpr const char* k_rebirth = "Node Control/Rebirth";
constexpr int k_most_command_bytes = 64 * 1024;

}  // namespace

Node::Node(std::string group, std::string cell, std::string version, std::uint8_t last_line)
    : group_{std::move(group)}, cell_{std::move(cell)}, version_{std::move(version)}, line_{last_line} {}

void Node::begin_line() {
  ++line_;
  told_.clear();
}

std::string Node::topic(std::string_view kind) const {
  return "spBv1.0/" + group_ + "/" + std::string{kind} + "/" + cell_;
}

Node::All Node::metrics_of(const CellState& state) const {
  const auto number = [](const std::optional<double>& value) {
    return Told{.type = k_double, .value = value && std::isfinite(*value) ? Value{*value} : Value{}};
  };
  const memory::Scan none;
  const memory::Scan& last = state.last ? *state.last : none;
  const auto text = [&](const std::string& words) {
    return Told{.type = k_string, .value = state.last ? Value{words} : Value{}};
  };
  return {{"Cell/Version", {.type = k_string, .value = version_}},
          {"Cell/Shoes waiting for the centre", {.type = k_int64, .value = state.waiting}},
          {"Last shoe/Scan", text(last.name)},
          {"Last shoe/Time", {.type = k_date_time, .value = state.last ? Value{Time{last.time}} : Value{}}},
          {"Last shoe/Model", text(last.model)},
          {"Last shoe/Foot", text(last.foot)},
          {"Last shoe/Size", text(last.size)},
          {"Last shoe/Part", text(last.part)},
          {"Last shoe/Process", text(last.process)},
          {"Last shoe/Verdict", text(last.verdict)},
          {"Last shoe/Reason code", text(last.reason_code)},
          {"Last shoe/Decision", text(last.decision)},
          {"Last shoe/Sent", {.type = k_boolean, .value = state.last ? Value{last.sent} : Value{}}},
          {"Last shoe/Length mm", number(last.length_mm)},
          {"Last shoe/Confidence", number(last.confidence)},
          {"Last shoe/U95 mm", number(last.u95_mm)},
          {"Last shoe/Cycle s", number(last.cycle_s)}};
}

std::string Node::payload_of(const All& metrics, memory::UnixMs now, std::optional<std::uint64_t> seq) {
  Payload payload;
  const auto ms = static_cast<std::uint64_t>(now);
  payload.set_timestamp(ms);
  if (seq) payload.set_seq(*seq);
  for (const auto& [name, told] : metrics) {
    Metric& metric = *payload.add_metrics();
    metric.set_name(name);
    metric.set_timestamp(ms);
    metric.set_datatype(told.type);
    if (const auto* whole = std::get_if<std::int64_t>(&told.value)) {
      metric.set_long_value(static_cast<std::uint64_t>(*whole));
    } else if (const auto* number = std::get_if<double>(&told.value)) {
      metric.set_double_value(*number);
    } else if (const auto* truth = std::get_if<bool>(&told.value)) {
      metric.set_boolean_value(*truth);
    } else if (const auto* words = std::get_if<std::string>(&told.value)) {
      metric.set_string_value(*words);
    } else if (const auto* time = std::get_if<Time>(&told.value)) {
      metric.set_long_value(static_cast<std::uint64_t>(time->ms));
    } else {
      metric.set_is_null(true);
    }
  }
  return payload.SerializeAsString();
}

std::uint64_t Node::next_seq() {
  return seq_++;  // 255 is followed by 0
}

std::string Node::death() const {
  // A death has no seq.
  return payload_of({{k_birth_number, {.type = k_int64, .value = std::int64_t{line_}}}}, memory::now_ms(),
                    {});
}

std::string Node::birth(const CellState& state, memory::UnixMs now) {
  told_ = metrics_of(state);
  All all = told_;
  all[k_birth_number] = {.type = k_int64, .value = std::int64_t{line_}};
  all[k_rebirth] = {.type = k_boolean, .value = false};
  seq_ = 0;
  return payload_of(all, now, next_seq());
}

std::optional<std::string> Node::data(const CellState& state, memory::UnixMs now) {
  const All all = metrics_of(state);
  All changed;
  for (const auto& [name, told] : all) {
    const auto before = told_.find(name);
    if (before == told_.end() || !(before->second == told)) changed.emplace(name, told);
  }
  if (changed.empty()) return std::nullopt;
  told_ = all;
  return payload_of(changed, now, next_seq());
}

bool Node::asks_rebirth(std::string_view payload) {
  Payload command;
  if (payload.size() > k_most_command_bytes ||
      !command.ParseFromArray(payload.data(), static_cast<int>(payload.size())))
    return false;
  for (const Metric& metric : command.metrics()) {
    if (metric.name() == k_rebirth && metric.boolean_value()) return true;
  }
  return false;
}

}  // namespace biteline::fleet::sparkplug
