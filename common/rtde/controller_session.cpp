// SPDX-License-Identifier: MIT
#include "common/rtde/controller_session.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::rtde {
namespace {

constexpr std::size_t k_max_recipes = 255;  // their number is one byte, 0 means none

struct TypedList {
  std::vector<std::string> wire;
  std::vector<FieldType> types;
  bool complete{true};
};

template <class Lookup>
TypedList types_of(const std::vector<std::string>& names, Lookup lookup) {
  TypedList list;
  for (const std::string& name : names) {
    const std::optional<FieldType> type = lookup(name);
    list.wire.emplace_back(type ? wire_name(*type) : "NOT_FOUND");
    if (type) list.types.push_back(*type);
    list.complete = list.complete && type.has_value();
  }
  return list;
}

}  // namespace

void ControllerSession::start() {
  splitter_.reset();
  outgoing_.clear();
  outputs_.clear();
  inputs_.clear();
  config_.owners->release(this);
  version_ = ProtocolVersion::V1;  // what a client that never asks speaks
  streaming_ = false;
}

Result<void> ControllerSession::consume(ByteView bytes, ControllerListener& listener) {
  while (!bytes.empty()) {
    bytes = bytes.subspan(splitter_.feed(bytes));
    while (true) {
      BITELINE_ASSIGN(const std::optional<Package> package, splitter_.next());
      if (!package) break;
      BITELINE_TRY(handle(*package, listener));
    }
  }
  return {};
}

Result<void> ControllerSession::handle(const Package& package, ControllerListener& listener) {
  if (!is_known(package.type)) return {};
  if (package.type == PackageType::Data) {
    BITELINE_ASSIGN(const std::size_t index, recipe_of(package, inputs_, DataHeader::RecipeId));
    BITELINE_TRY(read_data(package, inputs_[index], DataHeader::RecipeId, values_));
    listener.on_inputs(inputs_[index], values_);
    return {};
  }
  const Result<ClientMessage> message = read_client_message(package, version_);
  if (message) {
    answer(*message, listener);
  } else if (package.type != PackageType::TextMessage) {
    return tl::unexpected<Error>{message.error()};
  }
  return {};
}

void ControllerSession::answer(const ClientMessage& message, ControllerListener& listener) {
  if (const auto* request = std::get_if<ProtocolVersionRequest>(&message)) {
    const bool accepted =
        request->version >= 1 && request->version <= static_cast<std::uint16_t>(config_.newest);
    append(outgoing_, ControllerMessage{ProtocolVersionReply{.accepted = accepted}}, version_);
    if (accepted) version_ = static_cast<ProtocolVersion>(request->version);
  } else if (std::holds_alternative<ControllerVersionRequest>(message)) {
    append(outgoing_, ControllerMessage{config_.version}, version_);
  } else if (const auto* outputs = std::get_if<SetupOutputsRequest>(&message)) {
    set_up_outputs(*outputs);
  } else if (const auto* inputs = std::get_if<SetupInputsRequest>(&message)) {
    set_up_inputs(*inputs);
  } else if (std::holds_alternative<StartRequest>(message)) {
    streaming_ = !outputs_.empty() || !inputs_.empty();
    append(outgoing_, ControllerMessage{StartReply{.accepted = streaming_}}, version_);
  } else if (std::holds_alternative<PauseRequest>(message)) {
    streaming_ = false;
    append(outgoing_, ControllerMessage{PauseReply{.accepted = true}}, version_);
  } else if (const auto* text = std::get_if<TextMessage>(&message)) {
    listener.on_text(*text);
  }
}

void ControllerSession::set_up_outputs(const SetupOutputsRequest& request) {
  const TypedList list = types_of(request.names, output_type);
  SetupOutputsReply reply{.recipe_id = 0, .types = list.wire};
  // Version 1 has one recipe, and asking again replaces it.
  if (version_ == ProtocolVersion::V1) outputs_.clear();
  if (list.complete && !request.names.empty() && outputs_.size() < k_max_recipes) {
    reply.recipe_id = static_cast<std::uint8_t>(outputs_.size() + 1);
    const double wanted_hz =
        request.frequency_hz > 0 ? std::min(request.frequency_hz, config_.rate_hz) : config_.rate_hz;
    // At least once an hour, so that a tiny frequency cannot overflow the cycle count.
    const double every = std::clamp(std::round(config_.rate_hz / std::max(wanted_hz, 1.0 / 3600)), 1.0, 1e7);
    outputs_.push_back({.recipe = {.id = reply.recipe_id, .names = request.names, .types = list.types},
                        .every_cycles = static_cast<std::uint64_t>(every)});
  }
  append(outgoing_, ControllerMessage{reply}, version_);
}

void ControllerSession::set_up_inputs(const SetupInputsRequest& request) {
  TypedList list = types_of(request.names, input_type);
  for (std::size_t i = 0; i < request.names.size() && list.complete; ++i) {
    if (config_.owners->take(request.names[i], this)) continue;
    list.wire[i] = "IN_USE";
    list.complete = false;
  }
  if (!list.complete && inputs_.empty()) config_.owners->release(this);
  SetupInputsReply reply{.recipe_id = 0, .types = list.wire};
  if (list.complete && !request.names.empty() && inputs_.size() < k_max_recipes) {
    reply.recipe_id = static_cast<std::uint8_t>(inputs_.size() + 1);
    inputs_.push_back({.id = reply.recipe_id, .names = request.names, .types = list.types});
  }
  append(outgoing_, ControllerMessage{reply}, version_);
}

void ControllerSession::append_outputs(std::uint64_t cycle, const ValueSource& source) {
  if (!streaming_) return;
  for (Output& output : outputs_) {
    const std::uint64_t period = cycle / output.every_cycles;
    if (output.period_sent && period <= *output.period_sent) continue;
    output.period_sent = period;
    values_.clear();
    for (const std::string& name : output.recipe.names) values_.push_back(source.value_of(name));
    append_data(outgoing_, output.recipe, values_, output_header(version_));
  }
}

}  // namespace biteline::rtde
