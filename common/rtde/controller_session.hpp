// SPDX-License-Identifier: MIT
#pragma once
/// \file The controller's side of one RTDE connection, without sockets: what a simulated robot answers.

#include <map>
#include <memory>
#include <optional>

#include "common/rtde/data.hpp"
#include "common/rtde/messages.hpp"

namespace biteline::rtde {

/// Called from within consume().
class ControllerListener {
 public:
  virtual ~ControllerListener() = default;
  virtual void on_inputs(const Recipe& recipe, std::span<const Value> values) = 0;
  virtual void on_text(const TextMessage& message) = 0;
};

/// Gives values by name; the controller's state at one instant.
class ValueSource {
 public:
  virtual ~ValueSource() = default;
  /// The value of an output variable, of the type that output_type(name) says.
  [[nodiscard]] virtual Value value_of(std::string_view name) const = 0;
};

/// Which connection writes which input: a controller lets one client at a time have each.  Thread: one owner.
class InputOwners {
 public:
  /// False: another one has it.
  [[nodiscard]] bool take(const std::string& name, const void* owner) {
    return owners_.try_emplace(name, owner).first->second == owner;
  }
  void release(const void* owner) {
    std::erase_if(owners_, [&](const auto& entry) { return entry.second == owner; });
  }

 private:
  std::map<std::string, const void*> owners_;
};

/// Answers the hand-shake and encodes outputs on each controller cycle.  Thread: one owner.
class ControllerSession {
 public:
  struct Config {
    ControllerVersionReply version{.major = 5, .minor = 12, .bugfix = 0, .build = 0};
    ProtocolVersion newest{ProtocolVersion::V2};  ///< V1: a CB3 of old
    double rate_hz{500};                          ///< 125 on CB3
    std::shared_ptr<InputOwners> owners{};        ///< of all connections of one controller
  };

  explicit ControllerSession(const Config& config) : config_{config} {
    if (!config_.owners) config_.owners = std::make_shared<InputOwners>();
  }
  ~ControllerSession() { config_.owners->release(this); }
  ControllerSession(const ControllerSession&) = delete;
  ControllerSession& operator=(const ControllerSession&) = delete;

  /// For a fresh connection.
  void start();

  /// Answers what arrived.  An error means: close the connection.
  [[nodiscard]] Result<void> consume(ByteView bytes, ControllerListener& listener);

  /// Appends the data packages that are due on controller cycle `cycle` (counted at Config::rate_hz) or were
  /// on one left out before it; nothing before the client started or while it paused.
  void append_outputs(std::uint64_t cycle, const ValueSource& source);

  /// Queues a text for the client.
  void send_text(const TextMessage& message) { append(outgoing_, ControllerMessage{message}, version_); }

  /// To be sent; the caller clears what it sent.
  [[nodiscard]] Bytes& outgoing() { return outgoing_; }
  [[nodiscard]] bool streaming() const { return streaming_; }
  [[nodiscard]] ProtocolVersion version() const { return version_; }

 private:
  struct Output {
    Recipe recipe;
    std::uint64_t every_cycles{1};
    std::optional<std::uint64_t> period_sent{};  ///< cycle over every_cycles, of the last package
  };

  Result<void> handle(const Package& package, ControllerListener& listener);
  void answer(const ClientMessage& message, ControllerListener& listener);
  void set_up_outputs(const SetupOutputsRequest& request);
  void set_up_inputs(const SetupInputsRequest& request);

  Config config_;
  PackageSplitter splitter_;
  Bytes outgoing_;
  ProtocolVersion version_{ProtocolVersion::V1};
  std::vector<Output> outputs_;
  std::vector<Recipe> inputs_;
  std::vector<Value> values_;
  bool streaming_{false};
};

}  // namespace biteline::rtde
