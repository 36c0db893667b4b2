// SPDX-License-Identifier: MIT
#include "common/rtde/client_session.hpp"

#include "common/core/contracts.hpp"

namespace biteline::rtde {
namespace {

/// Types as agreed on, or the first variable that the controller does not have or another client holds.
Result<Recipe> agreed_recipe(std::uint8_t id, const std::vector<std::string>& names,
                             const std::vector<std::string>& types) {
  if (types.size() != names.size()) {
    return fail(Errc::ProtocolError, "RTDE recipe: %zu types for %zu variables", types.size(), names.size());
  }
  Recipe recipe{.id = id, .names = names, .types = {}};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::optional<FieldType> type = field_type_of(types[i]);
    if (!type) {
      return fail(Errc::PeerRefused, "RTDE variable %.100s: %.40s", names[i].c_str(), types[i].c_str());
    }
    recipe.types.push_back(*type);
  }
  return recipe;
}

}  // namespace

ClientSession::ClientSession(Config config) : config_{std::move(config)} {
  BITELINE_EXPECTS(!config_.outputs.empty() && config_.outputs.size() <= 255);
  values_.resize(config_.outputs.size());
}

void ClientSession::start() {
  splitter_.reset();
  outgoing_.clear();
  output_recipes_.clear();
  input_recipes_.clear();
  version_ = ProtocolVersion::V2;
  state_ = State::Version2;
  append(outgoing_, ProtocolVersionRequest{.version = 2}, version_);
}

Result<void> ClientSession::consume(ByteView bytes, ClientListener& listener) {
  if (state_ == State::Failed || state_ == State::Idle) {
    return fail(Errc::WrongState, "RTDE session is not started");
  }
  const auto advance = [&]() -> Result<void> {
    while (!bytes.empty()) {
      bytes = bytes.subspan(splitter_.feed(bytes));
      while (true) {
        BITELINE_ASSIGN(const std::optional<Package> package, splitter_.next());
        if (!package) break;
        BITELINE_TRY(handle(*package, listener));
      }
    }
    return {};
  };
  Result<void> result = advance();
  if (!result) state_ = State::Failed;
  return result;
}

Result<void> ClientSession::handle(const Package& package, ClientListener& listener) {
  if (package.type == PackageType::Data) {
    const DataHeader header = output_header(version_);
    BITELINE_ASSIGN(const std::size_t recipe, recipe_of(package, output_recipes_, header));
    BITELINE_TRY(read_data(package, output_recipes_[recipe], header, values_[recipe]));
    listener.on_data(recipe, values_[recipe]);
    return {};
  }
  BITELINE_ASSIGN(const ControllerMessage message, read_controller_message(package, version_));
  if (const auto* text = std::get_if<TextMessage>(&message)) {
    listener.on_text(*text);
    return {};
  }
  return handle_reply(message);
}

Result<void> ClientSession::handle_reply(const ControllerMessage& message) {
  if (const auto* reply = std::get_if<ProtocolVersionReply>(&message)) {
    if (state_ == State::Version2 && !reply->accepted) {
      version_ = ProtocolVersion::V1;
      state_ = State::Version1;
      append(outgoing_, ProtocolVersionRequest{.version = 1}, version_);
      return {};
    }
    if (state_ == State::Version1 && !reply->accepted) {
      return fail(Errc::PeerRefused, "controller takes neither RTDE version 2 nor 1");
    }
    if (state_ == State::Version2 || state_ == State::Version1) {
      if (version_ == ProtocolVersion::V1 && config_.outputs.size() > 1) {
        return fail(Errc::NotSupported, "controller speaks RTDE version 1, which has one recipe; %zu wanted",
                    config_.outputs.size());
      }
      state_ = State::Controller;
      append(outgoing_, ControllerVersionRequest{}, version_);
      return {};
    }
  }
  if (const auto* reply = std::get_if<ControllerVersionReply>(&message);
      reply && state_ == State::Controller) {
    controller_ = *reply;
    state_ = State::Outputs;
    request_next_recipe();
    return {};
  }
  if (const auto* reply = std::get_if<SetupOutputsReply>(&message); reply && state_ == State::Outputs) {
    return add_output_recipe(*reply);
  }
  if (const auto* reply = std::get_if<SetupInputsReply>(&message); reply && state_ == State::Inputs) {
    return add_input_recipe(*reply);
  }
  if (const auto* reply = std::get_if<StartReply>(&message); reply && state_ == State::Starting) {
    if (!reply->accepted) return fail(Errc::PeerRefused, "controller does not start RTDE");
    state_ = State::Running;
    return {};
  }
  return fail(Errc::ProtocolError, "RTDE reply out of turn (kind %zu in state %d)", message.index(),
              static_cast<int>(state_));
}

Result<void> ClientSession::add_output_recipe(const SetupOutputsReply& reply) {
  const ClientSession::OutputRecipe& wanted = config_.outputs[output_recipes_.size()];
  BITELINE_ASSIGN(Recipe recipe, agreed_recipe(reply.recipe_id, wanted.names, reply.types));
  for (const Recipe& other : output_recipes_) {
    if (other.id == recipe.id)
      return fail(Errc::ProtocolError, "RTDE recipe number %u given twice", recipe.id);
  }
  output_recipes_.push_back(std::move(recipe));
  request_next_recipe();
  return {};
}

Result<void> ClientSession::add_input_recipe(const SetupInputsReply& reply) {
  BITELINE_ASSIGN(Recipe recipe,
                  agreed_recipe(reply.recipe_id, config_.inputs[input_recipes_.size()], reply.types));
  input_recipes_.push_back(std::move(recipe));
  request_next_recipe();
  return {};
}

void ClientSession::request_next_recipe() {
  if (output_recipes_.size() < config_.outputs.size()) {
    const OutputRecipe& wanted = config_.outputs[output_recipes_.size()];
    append(outgoing_, SetupOutputsRequest{.frequency_hz = wanted.frequency_hz, .names = wanted.names},
           version_);
    return;
  }
  if (input_recipes_.size() < config_.inputs.size()) {
    state_ = State::Inputs;
    append(outgoing_, SetupInputsRequest{.names = config_.inputs[input_recipes_.size()]}, version_);
    return;
  }
  state_ = State::Starting;
  append(outgoing_, StartRequest{}, version_);
}

void ClientSession::send_inputs(std::size_t input, std::span<const Value> values) {
  BITELINE_EXPECTS(running() && input < input_recipes_.size());
  append_data(outgoing_, input_recipes_[input], values, DataHeader::RecipeId);
}

}  // namespace biteline::rtde
