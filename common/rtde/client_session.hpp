// SPDX-License-Identifier: MIT
#pragma once
/// \file The client's side of one RTDE connection, without sockets: bytes in, bytes out.
///
/// The owner of the socket calls start() when it is connected, consume() with what arrives, and sends
/// whatever stands in outgoing().  A reconnect is start() again: the whole hand-shake, recipes among it, is
/// repeated.

#include <optional>

#include "common/rtde/data.hpp"
#include "common/rtde/messages.hpp"

namespace biteline::rtde {

/// What a session tells; called from within consume().
class ClientListener {
 public:
  virtual ~ClientListener() = default;
  /// `recipe` indexes Config::outputs; values in the order and of the types of its variables, valid during
  /// the call.
  virtual void on_data(std::size_t recipe, std::span<const Value> values) = 0;
  virtual void on_text(const TextMessage& message) = 0;
};

/// What arrived and was left out; none of it ends a connection.
struct Skipped {
  std::uint64_t unreadable_texts{0};
  std::uint64_t unknown_packages{0};  ///< of a kind that the guide does not have
};

/// Hand-shake: version 2 if the peer takes it and else version 1, controller version, recipes one by one,
/// start.  Version 1's form is in force until the controller accepts version 2: some send a text first.
/// A variable of another type than asked for is refused by its name.
///
/// Thread: one owner.  Memory: no allocation per data package once every recipe was seen.
class ClientSession {
 public:
  struct OutputRecipe {
    std::vector<Variable> variables;
    double frequency_hz{0};  ///< 0: the controller's own rate; version 1 cannot choose
  };
  struct Config {
    std::vector<OutputRecipe> outputs;  ///< version 1 peers allow one
    std::vector<std::vector<Variable>> inputs;
  };
  enum class State { Idle, Version2, Version1, Controller, Outputs, Inputs, Starting, Running, Failed };

  explicit ClientSession(Config config);

  /// For a fresh connection, the first or a later one.
  void start();

  /// Reads what arrived, in whatever pieces.  An error is final until start().
  [[nodiscard]] Result<void> consume(ByteView bytes, ClientListener& listener);

  /// To be sent; the caller clears what it sent.
  [[nodiscard]] Bytes& outgoing() { return outgoing_; }

  /// Queues the values of an input recipe.  Pre: Running; one value per name, of its type.
  void send_inputs(std::size_t input, std::span<const Value> values);

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] bool running() const { return state_ == State::Running; }
  /// Failed for a reason that the same question meets again: a variable, a type, a version.
  [[nodiscard]] bool refused() const { return refused_; }
  /// Data packages since start().
  [[nodiscard]] std::uint64_t data_packages() const { return data_packages_; }
  /// Since the session was made.
  [[nodiscard]] const Skipped& skipped() const { return skipped_; }
  [[nodiscard]] ProtocolVersion version() const { return version_; }
  [[nodiscard]] const ControllerVersionReply& controller() const { return controller_; }

 private:
  Result<void> handle(const Package& package, ClientListener& listener);
  Result<void> handle_reply(const ControllerMessage& message);
  Result<void> handle_version(bool accepted);
  Result<void> add_output_recipe(const SetupOutputsReply& reply);
  Result<void> add_input_recipe(const SetupInputsReply& reply);
  void request_next_recipe();

  Config config_;
  PackageSplitter splitter_;
  Bytes outgoing_;
  State state_{State::Idle};
  ProtocolVersion version_{ProtocolVersion::V1};
  bool refused_{false};
  std::uint64_t data_packages_{0};
  Skipped skipped_;
  ControllerVersionReply controller_;
  std::vector<Recipe> output_recipes_;
  std::vector<Recipe> input_recipes_;
  std::vector<std::vector<Value>> values_;
};

}  // namespace biteline::rtde
