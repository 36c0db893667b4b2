// SPDX-License-Identifier: MIT
// Both ends against each other: what one queues, the other consumes.
#include <CppUTest/TestHarness.h>

#include <random>
#include <span>
#include <string_view>

#include "common/rtde/client_session.hpp"
#include "common/rtde/controller_session.hpp"
#include "tests/support/fuzz.hpp"

namespace biteline::rtde {
namespace {

using namespace std::string_view_literals;

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
  using enum FieldType;
  return {.outputs = {{.variables = {{"timestamp", Double}, {"actual_q", Vector6d}}, .frequency_hz = 500},
                      {.variables = {{"robot_mode", Int32}, {"timestamp", Double}}, .frequency_hz = 10}},
          .inputs = {{{"speed_slider_mask", Uint32}, {"speed_slider_fraction", Double}}}};
}

Bytes bytes(std::string_view text) {
  return {text.begin(), text.end()};
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
  struct Exchange {
    std::string_view asked, answered;
  };
  /// Each request is answered by just these bytes.
  void check_answers(ControllerSession & controller, std::span<const Exchange> exchanges) {
    for (const Exchange& exchange : exchanges) {
      CHECK(controller.consume(bytes(exchange.asked), taken).has_value());
      CHECK(bytes(exchange.answered) == controller.outgoing());
      controller.outgoing().clear();
    }
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

/// A controller that skips late cycles skips no period of a slow recipe.
TEST(RtdeSessions, SlowRecipesLoseNothingToSkippedCycles) {
  ClientSession client{two_recipes()};
  ControllerSession controller{{}};
  client.start();
  controller.start();
  CHECK(talk(client, controller).has_value());
  for (std::uint64_t cycle = 3; cycle < 1000; cycle += 7) {  // 7 divides no period of 50 cycles
    controller.append_outputs(cycle, arm);
    CHECK(talk(client, controller).has_value());
  }
  std::size_t slow = 0;
  for (const auto& [recipe, values] : heard.data) slow += recipe == 1 ? 1 : 0;
  CHECK_EQUAL(20U, slow);
}

TEST(RtdeSessions, AnInputBelongsToOneClientUntilItGoes) {
  const auto owners = std::make_shared<InputOwners>();
  ControllerSession second{{.owners = owners}};
  ClientSession later{two_recipes()};
  {
    ControllerSession first{{.owners = owners}};
    ClientSession client{two_recipes()};
    client.start();
    first.start();
    CHECK(talk(client, first).has_value());
    later.start();
    second.start();
    const auto result = talk(later, second);
    CHECK_FALSE(result.has_value());
    STRCMP_EQUAL("RTDE variable speed_slider_mask: IN_USE", result.error().where.c_str());
    CHECK(later.refused());
  }
  later.start();
  second.start();
  CHECK(talk(later, second).has_value());
  CHECK(later.running());
}

/// The exchange of Universal Robots' Python client (record.py) byte by byte, as the guide lays it out.
TEST(RtdeSessions, GoldenBytesOfAPeersExchange) {
  ControllerSession controller{{}};
  controller.start();
  const Exchange exchanges[] = {
      {"\x00\x05V\x00\x02"sv, "\x00\x04V\x01"sv},
      {"\x00\x03v"sv, "\x00\x13v\x00\x00\x00\x05\x00\x00\x00\x0c\x00\x00\x00\x00\x00\x00\x00\x00"sv},
      {"\x00\x1fO\x40\x5f\x40\x00\x00\x00\x00\x00timestamp,robot_mode"sv,
       "\x00\x10O\x01"
       "DOUBLE,INT32"sv},
      {"\x00\x03S"sv, "\x00\x04S\x01"sv},
  };
  check_answers(controller, exchanges);
  arm.time_s = 1;
  controller.append_outputs(0, arm);
  CHECK(bytes("\x00\x10U\x01\x3f\xf0\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00"sv) == controller.outgoing());
}

/// What a CB3 of old hears and says: no numbers of recipes, no rate, and so Universal Robots' first guide.
TEST(RtdeSessions, GoldenBytesOfVersion1) {
  ControllerSession controller{{}};
  controller.start();
  const Exchange exchanges[] = {
      {"\x00\x05V\x00\x01"sv, "\x00\x04V\x01"sv},
      {"\x00\x17Otimestamp,robot_mode"sv, "\x00\x0fODOUBLE,INT32"sv},
      {"\x00\x03S"sv, "\x00\x04S\x01"sv},
  };
  check_answers(controller, exchanges);
  arm.time_s = 1;
  controller.append_outputs(0, arm);
  CHECK(bytes("\x00\x0fU\x3f\xf0\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00"sv) == controller.outgoing());
  controller.outgoing().clear();
  CHECK(controller.consume(bytes("\x00\x03P"sv), taken).has_value());
  CHECK(bytes("\x00\x04P\x01"sv) == controller.outgoing());
}

/// Inputs as the client libraries write them (RTDEWriter, RTDEIOInterface): the slider at a quarter.
TEST(RtdeSessions, GoldenBytesOfInputsAndTexts) {
  ControllerSession controller{{}};
  controller.start();
  const Exchange exchanges[] = {
      {"\x00\x05V\x00\x02"sv, "\x00\x04V\x01"sv},
      {"\x00\x2aIspeed_slider_mask,speed_slider_fraction"sv,
       "\x00\x11I\x01"
       "UINT32,DOUBLE"sv},
      {"\x00\x0dIno_such_in"sv,
       "\x00\x0dI\x00"
       "NOT_FOUND"sv},
      {"\x00\x10U\x01\x00\x00\x00\x01\x3f\xd0\x00\x00\x00\x00\x00\x00"sv, ""sv},
  };
  check_answers(controller, exchanges);
  controller.send_text({.level = TextLevel::Warning, .text = "slow", .source = "arm"});
  CHECK(bytes("\x00\x0dM\x04slow\x03"
              "arm\x02"sv) == controller.outgoing());
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
      {.outputs = {{.variables = {{"timestamp", FieldType::Double}, {"warp_factor", FieldType::Double}}}},
       .inputs = {}}};
  ControllerSession controller{{}};
  client.start();
  controller.start();
  const auto result = talk(client, controller);
  CHECK_FALSE(result.has_value());
  CHECK(result.error().where.view().find("warp_factor") != std::string_view::npos);
  CHECK(client.state() == ClientSession::State::Failed);
  CHECK(client.refused());
}

/// Each type for each other: named, refused for good, and nothing of another type is ever handed out.
TEST(RtdeSessions, VariableOfAnotherTypeIsRefusedByItsName) {
  for (int asked = 0; asked <= static_cast<int>(FieldType::Vector6u); ++asked) {
    for (int told = 0; told <= static_cast<int>(FieldType::Vector6u); ++told) {
      const auto wanted = static_cast<FieldType>(asked), given = static_cast<FieldType>(told);
      ClientSession client{
          {.outputs = {{.variables = {{"timestamp", FieldType::Double}, {"robot_mode", wanted}}}},
           .inputs = {}}};
      client.start();
      const std::string types = "DOUBLE," + std::string{wire_name(given)};
      Bytes answers{0, 4, 'V', 1, 0, 19, 'v', 0, 0, 0, 5, 0, 0, 0, 12, 0, 0, 0, 0, 0, 0, 0, 0};
      append(answers, ControllerMessage{SetupOutputsReply{.recipe_id = 1, .types = split(types)}},
             ProtocolVersion::V2);
      const auto result = client.consume(answers, heard);
      CHECK_EQUAL(wanted == given, result.has_value());
      if (result) continue;
      const std::string expected = "RTDE variable robot_mode: " + std::string{wire_name(given)} + ", " +
                                   std::string{wire_name(wanted)} + " expected";
      STRCMP_EQUAL(expected.c_str(), result.error().where.c_str());
      CHECK(result.error().code == Errc::PeerRefused);
      CHECK(client.refused());
    }
  }
}

/// A PolyScope X that is not switched on sends a text at once, in the form that is in force: version 1.
TEST(RtdeSessions, TextsBeforeBetweenAndAfterTheHandshakeCostNoConnection) {
  const auto text = [](const char* words, ProtocolVersion version) {
    Bytes bytes;
    append(bytes, ControllerMessage{TextMessage{.level = TextLevel::Warning, .text = words, .source = ""}},
           version);
    return bytes;
  };
  ClientSession client{two_recipes()};
  ControllerSession controller{{}};
  client.start();
  controller.start();
  CHECK(client.consume(text("robot is off", ProtocolVersion::V1), heard).has_value());
  // The answer to the version, then a text of version 2 before each further answer.
  for (int turn = 0; !client.running() && turn < 20; ++turn) {
    Bytes asked;
    asked.swap(client.outgoing());
    CHECK(controller.consume(asked, taken).has_value());
    Bytes answers;
    answers.swap(controller.outgoing());
    CHECK(client.consume(answers, heard).has_value());
    CHECK(client.consume(text("between", client.version()), heard).has_value());
  }
  CHECK(client.running());
  CHECK(client.version() == ProtocolVersion::V2);
  CHECK(heard.texts.size() > 3);
  STRCMP_EQUAL("robot is off", heard.texts[0].text.c_str());
  STRCMP_EQUAL("between", heard.texts[1].text.c_str());
  controller.append_outputs(0, arm);
  CHECK(talk(client, controller).has_value());
  CHECK_EQUAL(2U, heard.data.size());
}

TEST(RtdeSessions, TextsThatCannotBeReadAndUnknownPackagesAreCountedAndLeftOut) {
  ClientSession client{two_recipes()};
  ControllerSession controller{{}};
  client.start();
  controller.start();
  const Bytes cut_text{0, 8, 'M', 200, 'c', 'u', 't', '!'};  // announces 200 letters
  const Bytes no_text{0, 3, 'M'};
  const Bytes unknown{0, 6, 'Z', 1, 2, 3};
  // Before the version is agreed on any body but an empty one is a text of version 1.
  for (const Bytes* stray : {&no_text, &unknown}) CHECK(client.consume(*stray, heard).has_value());
  CHECK(talk(client, controller).has_value());
  CHECK(client.running());
  std::uint64_t cycle = 0;
  for (const Bytes* stray : {&cut_text, &no_text, &unknown, &unknown}) {
    CHECK(client.consume(*stray, heard).has_value());
    controller.append_outputs(cycle += 50, arm);  // both recipes are due
    CHECK(talk(client, controller).has_value());
  }
  CHECK_EQUAL(8U, heard.data.size());
  CHECK_EQUAL(3U, client.skipped().unreadable_texts);
  CHECK_EQUAL(3U, client.skipped().unknown_packages);
  CHECK_EQUAL(8U, client.data_packages());
  // The controller's side bears the same.
  for (const Bytes* stray : {&cut_text, &no_text, &unknown}) {
    CHECK(controller.consume(*stray, taken).has_value());
  }
}

TEST(RtdeSessions, OnlyWhatANewQuestionWouldMeetAgainIsRefusedForGood) {
  const auto refused_by = [&](const Bytes& answers) {
    ClientSession client{two_recipes()};
    client.start();
    CHECK_FALSE(client.consume(answers, heard).has_value());
    return client.refused();
  };
  CHECK(refused_by({0, 4, 'V', 0, 0, 4, 'V', 0}));  // neither version
  CHECK(refused_by({0, 4, 'V', 0, 0, 4, 'V', 1}));  // version 1, which has one recipe
  CHECK_FALSE(refused_by({0, 4, 'S', 1}));          // out of turn
  CHECK_FALSE(refused_by({0, 2, 'V'}));             // no package
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
