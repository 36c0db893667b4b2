// SPDX-License-Identifier: MIT
#include "common/rtde/messages.hpp"

#include <CppUTest/TestHarness.h>

#include <set>

#include "common/rtde/fields.hpp"

namespace biteline::rtde {
namespace {

template <class Message>
Bytes packed(const Message& message, ProtocolVersion version) {
  Bytes bytes;
  append(bytes, message, version);
  return bytes;
}

Package as_package(const Bytes& bytes) {
  return {.type = static_cast<PackageType>(bytes[2]), .payload = ByteView{bytes}.subspan(k_header_bytes)};
}

}  // namespace

TEST_GROUP(RtdeMessages){};

TEST(RtdeMessages, OutputSetupOfVersion2StartsWithItsFrequency) {
  const Bytes bytes =
      packed(ClientMessage{SetupOutputsRequest{.frequency_hz = 500, .names = {"timestamp", "actual_q"}}},
             ProtocolVersion::V2);
  Bytes expected{0, 29, 'O', 0x40, 0x7F, 0x40, 0, 0, 0, 0, 0};  // 500.0
  for (const char letter : std::string{"timestamp,actual_q"})
    expected.push_back(static_cast<std::uint8_t>(letter));
  CHECK(expected == bytes);
}

TEST(RtdeMessages, EveryKindComesBackInBothVersions) {
  for (const ProtocolVersion version : {ProtocolVersion::V1, ProtocolVersion::V2}) {
    const std::vector<ClientMessage> asked{
        ProtocolVersionRequest{.version = 2},
        ControllerVersionRequest{},
        SetupOutputsRequest{.frequency_hz = version == ProtocolVersion::V2 ? 125.0 : 0.0,
                            .names = {"a", "b"}},
        SetupInputsRequest{.names = {"c"}},
        StartRequest{},
        PauseRequest{},
        TextMessage{.level = TextLevel::Warning,
                    .text = "hello",
                    .source = version == ProtocolVersion::V2 ? "us" : ""}};
    for (const ClientMessage& message : asked) {
      const Bytes bytes = packed(message, version);
      const auto read = read_client_message(as_package(bytes), version);
      CHECK(read.has_value());
      CHECK(packed(*read, version) == bytes);
      CHECK_EQUAL(message.index(), read->index());
    }
    const std::vector<ControllerMessage> told{
        ProtocolVersionReply{.accepted = true},
        ControllerVersionReply{.major = 5, .minor = 11, .bugfix = 1, .build = 108318},
        SetupOutputsReply{.recipe_id = static_cast<std::uint8_t>(version == ProtocolVersion::V2 ? 4 : 0),
                          .types = {"DOUBLE", "VECTOR6D"}},
        SetupInputsReply{.recipe_id = 2, .types = {"UINT8"}},
        StartReply{.accepted = true},
        PauseReply{.accepted = false},
        TextMessage{
            .level = TextLevel::Error, .text = "x", .source = version == ProtocolVersion::V2 ? "RTDE" : ""}};
    for (const ControllerMessage& message : told) {
      const Bytes bytes = packed(message, version);
      const auto read = read_controller_message(as_package(bytes), version);
      CHECK(read.has_value());
      CHECK(packed(*read, version) == bytes);
      CHECK_EQUAL(message.index(), read->index());
    }
  }
}

TEST(RtdeMessages, BodiesCutAnywhereOrTooLongAreRefused) {
  const Bytes text =
      packed(ControllerMessage{TextMessage{.level = TextLevel::Info, .text = "abc", .source = "de"}},
             ProtocolVersion::V2);
  const ByteView body = ByteView{text}.subspan(k_header_bytes);
  for (std::size_t size = 0; size < body.size(); ++size) {
    const Package cut{.type = PackageType::TextMessage, .payload = body.first(size)};
    CHECK_FALSE(read_controller_message(cut, ProtocolVersion::V2).has_value());
  }
  const Bytes two{1, 1};
  CHECK_FALSE(
      read_controller_message({.type = PackageType::Start, .payload = two}, ProtocolVersion::V2).has_value());
  CHECK_FALSE(
      read_client_message({.type = PackageType::Start, .payload = two}, ProtocolVersion::V2).has_value());
  CHECK_FALSE(read_client_message({.type = PackageType::SetupOutputs, .payload = two}, ProtocolVersion::V2)
                  .has_value());
}

TEST(RtdeMessages, FrequencyThatIsNoNumberIsRefused) {
  const Bytes nan{0x7F, 0xF8, 0, 0, 0, 0, 0, 0, 'a'};
  CHECK_FALSE(read_client_message({.type = PackageType::SetupOutputs, .payload = nan}, ProtocolVersion::V2)
                  .has_value());
}

TEST(RtdeMessages, RegistersHaveTypesWithinTheirRange) {
  CHECK(output_type("output_double_register_47") == FieldType::Double);
  CHECK(input_type("input_int_register_0") == FieldType::Int32);
  CHECK_FALSE(output_type("output_double_register_48").has_value());
  CHECK_FALSE(output_type("output_double_register_").has_value());
  CHECK_FALSE(output_type("output_double_register_1x").has_value());
  CHECK(output_type("input_int_register_0") == FieldType::Int32);  // read back
  CHECK_FALSE(input_type("output_int_register_0").has_value());
  CHECK(output_type("actual_TCP_pose") == FieldType::Vector6d);
}

/// What recorders, drivers and libraries of others ask for by default.
TEST(RtdeMessages, FieldsOfTheGuideAreKnown) {
  const std::vector<std::string> outputs = output_names(), inputs = input_names();
  CHECK(outputs.size() >= 393);
  CHECK_EQUAL(175U, inputs.size());
  for (const auto* names : {&outputs, &inputs}) {
    std::set<std::string> once(names->begin(), names->end());
    CHECK_EQUAL(names->size(), once.size());
  }
  for (const std::string& name : outputs) CHECK_TEXT(output_type(name).has_value(), name.c_str());
  for (const std::string& name : inputs) CHECK_TEXT(input_type(name).has_value(), name.c_str());
  CHECK(output_type("joint_position_deviation_ratio") == FieldType::Double);
  CHECK(output_type("ft_raw_wrench") == FieldType::Vector6d);
  CHECK(output_type("tool_output_mode") == FieldType::Uint8);
  CHECK(output_type("tool_output_voltage") == FieldType::Int32);
  CHECK(output_type("actual_configurable_digital_input_bits") == FieldType::Uint64);
  CHECK(output_type("target_gravity") == FieldType::Vector3d);
  CHECK(input_type("standard_analog_output_mask") == FieldType::Uint8);
  CHECK(input_type("standard_analog_output_0") == FieldType::Double);
}

TEST(RtdeMessages, TypeNamesAreTheGuides) {
  for (const char* name : {"BOOL", "UINT8", "UINT32", "UINT64", "INT32", "DOUBLE", "VECTOR3D", "VECTOR6D",
                           "VECTOR6INT32", "VECTOR6UINT32"}) {
    const auto type = field_type_of(name);
    CHECK(type.has_value());
    CHECK(wire_name(*type) == name);
    CHECK_EQUAL(static_cast<std::size_t>(*type), zero_of(*type).index());
  }
  CHECK_FALSE(field_type_of("NOT_FOUND").has_value());
}

}  // namespace biteline::rtde
