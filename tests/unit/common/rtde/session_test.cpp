// SPDX-License-Identifier: MIT
// Both ends against each other: what one queues, the other consumes.
#include <CppUTest/TestHarness.h>

#include <random>

#include "common/rtde/client_session.hpp"
#include "common/rtde/controller_session.hpp"
#include "tests/support/fuzz.hpp"

namespace biteline::rtde {
namespace {

struct Heard : ClientListener {
  std::vector<std::pair<std::size_t, std::vector<Value>>> data;
  std::vector<TextMessage> texts;
  void on_data(std::size_t recipe, std::span<const Value> values) override {
    data.emplace_back(recipe, std::vector<Value>(values.begin(), values.end()));
  }
  void on_text(const TextMessage& message) override { texts.push_back(message); }
};

struct Taken : ControllerListener {
  std::vector<std::vector<Value>> inputs;
  std::vector<TextMessage> texts;
  void on_inputs(const Recipe&, std::span<const Value> values) override {
    inputs.emplace_back(values.begin(), values.end());
  }
  void on_text(const TextMessage& message) override { texts.push_back(message); }
};

struct Arm : ValueSource {
  double time_s{0};
  Value value_of(std::string_view name) const override {
    if (name == "timestamp") return time_s;
    if (name == "actual_q") return Vector6{0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
    return zero_of(*output_type(name));
  }
};

ClientSession::Config two_recipes() {
  return {.outputs = {{.names = {"timestamp", "actual_q"}, .frequency_hz = 500},
                      {.names = {"robot_mode", "timestamp"}, .frequency_hz = 10}},
          .inputs = {{"speed_slider_mask", "speed_slider_fraction"}}};
}

}  // namespace

TEST_GROUP(RtdeSessions) {
  Heard heard;
  Taken taken;
  Arm arm;
  std::mt19937_64 random{5};

  /// Hands bytes over in pieces of at most `longest`, both ways, until nobody has anything to say.
  Result<void> talk(ClientSession & client, ControllerSession & controller, std::size_t longest = 3) {
    while (!client.outgoing().empty() || !controller.outgoing().empty()) {
      Bytes to_controller, to_client;
      to_controller.swap(client.outgoing());
      for (ByteView rest{to_controller}; !rest.empty();) {
        const std::size_t piece = std::min<std::size_t>(rest.size(), 1 + random() % longest);
        BITELINE_TRY(controller.consume(rest.first(piece), taken));
        rest = rest.subspan(piece);
      }
      to_client.swap(controller.outgoing());
      for (ByteView rest{to_client}; !rest.empty();) {
        const std::size_t piece = std::min<std::size_t>(rest.size(), 1 + random() % longest);
        BITELINE_TRY(client.consume(rest.first(piece), heard));
        rest = rest.subspan(piece);
      }
    }
    return {};
  }
};

TEST(RtdeSessions, TwoRecipesRunAtTheirOwnRates) {
  ClientSession client{two_recipes()};
  ControllerSession controller{{}};
  client.start();
  controller.start();
  CHECK(talk(client, controller).has_value());
  CHECK(client.running());
  CHECK_EQUAL(5U, client.controller().major);

  for (std::uint64_t cycle = 0; cycle < 100; ++cycle) {
    arm.time_s = static_cast<double>(cycle) / 500;
    controller.append_outputs(cycle, arm);
    CHECK(talk(client, controller).has_value());
  }
  std::size_t fast = 0, slow = 0;
  for (const auto& [recipe, values] : heard.data) ++(recipe == 0 ? fast : slow);
  CHECK_EQUAL(100U, fast);
  CHECK_EQUAL(2U, slow);
  DOUBLES_EQUAL(0.6, std::get<Vector6>(heard.data[0].second[1])[5], 0);
}

TEST(RtdeSessions, FallsBackToVersion1) {
  ClientSession::Config config = two_recipes();
  config.outputs.resize(1);
  ClientSession client{config};
  ControllerSession controller{{.version = {.major = 3, .minor = 2, .bugfix = 0, .build = 0},
                                .newest = ProtocolVersion::V1,
                                .rate_hz = 125}};
  client.start();
  controller.start();
  CHECK(talk(client, controller).has_value());
  CHECK(client.running());
  CHECK(client.version() == ProtocolVersion::V1);
  controller.append_outputs(0, arm);
  CHECK(talk(client, controller).has_value());
  CHECK_EQUAL(1U, heard.data.size());
}

TEST(RtdeSessions, SeveralRecipesOnVersion1AreRefusedByName) {
  ClientSession client{two_recipes()};
  ControllerSession controller{{.version = {}, .newest = ProtocolVersion::V1, .rate_hz = 125}};
  client.start();
  controller.start();
  const auto result = talk(client, controller);
  CHECK_FALSE(result.has_value());
  CHECK(result.error().code == Errc::NotSupported);
}

TEST(RtdeSessions, VariableThatTheControllerLacksIsNamed) {
  ClientSession client{
      {.outputs = {{.names = {"timestamp", "warp_factor"}, .frequency_hz = 0}}, .inputs = {}}};
  ControllerSession controller{{}};
  client.start();
  controller.start();
  const auto result = talk(client, controller);
  CHECK_FALSE(result.has_value());
  CHECK(result.error().where.view().find("warp_factor") != std::string_view::npos);
  CHECK(client.state() == ClientSession::State::Failed);
}

TEST(RtdeSessions, ReconnectRepeatsTheWholeHandshake) {
  ClientSession client{two_recipes()};
  ControllerSession first{{}}, second{{}};
  client.start();
  first.start();
  CHECK(talk(client, first).has_value());
  // The connection breaks in the middle of a package.
  first.append_outputs(0, arm);
  CHECK(client.consume(ByteView{first.outgoing()}.first(9), heard).has_value());
  second.start();
  client.start();
  CHECK(talk(client, second).has_value());
  CHECK(client.running());
  second.append_outputs(0, arm);
  CHECK(talk(client, second).has_value());
  CHECK_EQUAL(2U, heard.data.size());
}

TEST(RtdeSessions, InputsAndTextsArrive) {
  ClientSession client{two_recipes()};
  ControllerSession controller{{}};
  client.start();
  controller.start();
  CHECK(talk(client, controller).has_value());
  const std::vector<Value> half{std::uint32_t{1}, 0.5};
  client.send_inputs(0, half);
  controller.send_text({.level = TextLevel::Warning, .text = "slow", .source = "sim"});
  CHECK(talk(client, controller).has_value());
  CHECK(taken.inputs.size() == 1 && taken.inputs[0] == half);
  CHECK_EQUAL(1U, heard.texts.size());
  CHECK(heard.texts[0].text == "slow");
}

TEST(RtdeSessions, DataBeforeItsRecipeAndRepliesOutOfTurnEndTheSession) {
  for (const Bytes& stray : {Bytes{0, 4, 'U', 1}, Bytes{0, 4, 'S', 1}, Bytes{0, 5, 'O', 1, 'X'}}) {
    ClientSession client{two_recipes()};
    client.start();
    CHECK_FALSE(client.consume(stray, heard).has_value());
    CHECK(client.state() == ClientSession::State::Failed);
    CHECK_FALSE(client.consume(Bytes{0, 4, 'V', 1}, heard).has_value());
  }
}

TEST(RtdeSessions, AnInputRecipeNobodySetUpIsRefused) {
  ControllerSession controller{{}};
  controller.start();
  CHECK_FALSE(controller.consume(Bytes{0, 5, 'U', 1, 0}, taken).has_value());
}

TEST(RtdeSessions, PausedControllerIsSilent) {
  ControllerSession controller{{}};
  controller.start();
  Bytes asked;
  append(asked, ClientMessage{ProtocolVersionRequest{.version = 2}}, ProtocolVersion::V2);
  append(asked, ClientMessage{SetupOutputsRequest{.frequency_hz = 0, .names = {"timestamp"}}},
         ProtocolVersion::V2);
  append(asked, ClientMessage{StartRequest{}}, ProtocolVersion::V2);
  CHECK(controller.consume(asked, taken).has_value());
  CHECK(controller.streaming());
  Bytes pause;
  append(pause, ClientMessage{PauseRequest{}}, ProtocolVersion::V2);
  CHECK(controller.consume(pause, taken).has_value());
  controller.outgoing().clear();
  controller.append_outputs(0, arm);
  CHECK(controller.outgoing().empty());
}

/// Whatever a peer sends, of the protocol's own form or not: each end refuses or goes on, and never harms
/// (address and undefined-behaviour sanitizers), and a fresh connection works.
TEST(RtdeSessions, GarbledStreamsNeverHarmEitherEnd) {
  int refused = 0;
  for (int round = 0; round < 3000 * test::fuzz_factor(); ++round) {
    ClientSession client{two_recipes()};
    ControllerSession controller{{}};
    client.start();
    controller.start();
    const auto spoil = [&](Bytes& bytes) {
      if (random() % 4 == 0) test::garble(bytes, random);
    };
    bool alive = true;
    for (std::uint64_t turn = 0; turn < 12 && alive; ++turn) {
      Bytes to_controller, to_client;
      to_controller.swap(client.outgoing());
      spoil(to_controller);
      alive = controller.consume(to_controller, taken).has_value();
      controller.append_outputs(turn, arm);
      to_client.swap(controller.outgoing());
      spoil(to_client);
      alive = client.consume(to_client, heard).has_value() && alive;
    }
    refused += alive ? 0 : 1;
    for (const auto& [recipe, values] : heard.data) CHECK_EQUAL(2U, values.size());
    heard.data.clear();
    taken.inputs.clear();
    client.start();
    controller.start();
    CHECK(talk(client, controller).has_value());
    CHECK(client.running());
    heard.texts.clear();
    taken.texts.clear();
  }
  CHECK(refused > 100);
}

}  // namespace biteline::rtde
