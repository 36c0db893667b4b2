// SPDX-License-Identifier: MIT
#include "common/rtde/client_session.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "common/core/contracts.hpp"

namespace biteline::rtde {
namespace {

std::vector<std::string> names_of(const std::vector<Variable>& variables) {
  std::vector<std::string> names;
  for (const Variable& variable : variables) names.push_back(variable.name);
  return names;
}

/// The first software of CB3 and of e-Series controllers that has a variable: Universal Robots' RTDE guide,
/// and the table of versions of their client library.
struct FirstVersion {
  const char* name;
  const char* software;
};
constexpr std::array k_first_versions{FirstVersion{"tcp_offset", "3.12.3 or 5.5.1"},
                                      FirstVersion{"payload", "3.11 or 5.5.1"},
                                      FirstVersion{"payload_cog", "3.11 or 5.5.1"}};

/// Why a variable is not to be had.
tl::unexpected<Error> lacking(const char* name, const std::string& said) {
  if (said != "NOT_FOUND") return fail(Errc::PeerRefused, "RTDE variable %.100s: %.40s", name, said.c_str());
  const auto* const first = std::ranges::find_if(
      k_first_versions, [&](const FirstVersion& version) { return std::string_view{name} == version.name; });
  if (first == k_first_versions.end()) {
    return fail(Errc::PeerRefused,
                "RTDE variable %.100s: NOT_FOUND: the controller's software does not know it", name);
  }
  return fail(
      Errc::PeerRefused,
      "RTDE variable %.100s: NOT_FOUND: the controller's software is too old, PolyScope %s or newer has it",
      name, first->software);
}

/// Types as asked for, or the first variable that the controller lacks, types otherwise or that another
/// client holds.
Result<Recipe> agreed_recipe(std::uint8_t id, const std::vector<Variable>& wanted,
                             const std::vector<std::string>& types) {
  if (types.size() != wanted.size()) {
    return fail(Errc::ProtocolError, "RTDE recipe: %zu types for %zu variables", types.size(), wanted.size());
  }
  Recipe recipe{.id = id, .names = names_of(wanted), .types = {}};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const char* const name = wanted[i].name.c_str();
    const std::optional<FieldType> type = field_type_of(types[i]);
    if (!type) return lacking(name, types[i]);
    if (*type != wanted[i].type) {
      const std::string_view expected = wire_name(wanted[i].type);
      return fail(Errc::PeerRefused, "RTDE variable %.100s: %.40s, %.*s expected", name, types[i].c_str(),
                  static_cast<int>(expected.size()), expected.data());
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
  version_ = ProtocolVersion::V1;
  refused_ = false;
  data_packages_ = 0;
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
  if (!result) {
    const bool asking = state_ != State::Starting && state_ != State::Running;
    const Errc code = result.error().code;
    refused_ = asking && (code == Errc::PeerRefused || code == Errc::NotSupported);
    state_ = State::Failed;
  }
  return result;
}

Result<void> ClientSession::handle(const Package& package, ClientListener& listener) {
  if (!is_known(package.type)) {
    ++skipped_.unknown_packages;
    return {};
  }
  if (package.type == PackageType::Data) {
    const DataHeader header = output_header(version_);
    BITELINE_ASSIGN(const std::size_t recipe, recipe_of(package, output_recipes_, header));
    BITELINE_TRY(read_data(package, output_recipes_[recipe], header, values_[recipe]));
    ++data_packages_;
    listener.on_data(recipe, values_[recipe]);
    return {};
  }
  const Result<ControllerMessage> message = read_controller_message(package, version_);
  if (package.type == PackageType::TextMessage) {
    // A text is there for people: one that cannot be read costs no connection.
    if (message) {
      listener.on_text(std::get<TextMessage>(*message));
    } else {
      ++skipped_.unreadable_texts;
    }
    return {};
  }
  if (!message) return tl::unexpected<Error>{message.error()};
  return handle_reply(*message);
}

Result<void> ClientSession::handle_version(bool accepted) {
  if (state_ == State::Version2 && !accepted) {
    state_ = State::Version1;
    append(outgoing_, ProtocolVersionRequest{.version = 1}, version_);
    return {};
  }
  if (!accepted) return fail(Errc::PeerRefused, "controller takes neither RTDE version 2 nor 1");
  if (state_ == State::Version2) version_ = ProtocolVersion::V2;
  if (version_ == ProtocolVersion::V1 && config_.outputs.size() > 1) {
    return fail(Errc::NotSupported, "controller speaks RTDE version 1, which has one recipe; %zu wanted",
                config_.outputs.size());
  }
  state_ = State::Controller;
  append(outgoing_, ControllerVersionRequest{}, version_);
  return {};
}

Result<void> ClientSession::handle_reply(const ControllerMessage& message) {
  if (const auto* reply = std::get_if<ProtocolVersionReply>(&message);
      reply && (state_ == State::Version2 || state_ == State::Version1)) {
    return handle_version(reply->accepted);
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
  BITELINE_ASSIGN(Recipe recipe, agreed_recipe(reply.recipe_id, wanted.variables, reply.types));
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
    append(outgoing_,
           SetupOutputsRequest{.frequency_hz = wanted.frequency_hz, .names = names_of(wanted.variables)},
           version_);
    return;
  }
  if (input_recipes_.size() < config_.inputs.size()) {
    state_ = State::Inputs;
    append(outgoing_, SetupInputsRequest{.names = names_of(config_.inputs[input_recipes_.size()])}, version_);
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
