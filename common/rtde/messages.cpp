// SPDX-License-Identifier: MIT
#include "common/rtde/messages.hpp"

#include <algorithm>
#include <cmath>

#include "common/core/contracts.hpp"
#include "common/rtde/fields.hpp"

namespace biteline::rtde {
namespace {

constexpr std::size_t k_max_text_bytes = 255;  // a version 2 text carries its length in one byte

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
// The fuzzing's compiler, clang 14, does not deduce it by itself.
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

tl::unexpected<Error> bad_body(const Package& package) {
  return fail(Errc::ProtocolError, "RTDE package '%c': body of %zu bytes does not fit its kind",
              static_cast<char>(package.type), package.payload.size());
}

Bytes body_of(const TextMessage& message, ProtocolVersion version) {
  Bytes body;
  Writer writer{body};
  if (version == ProtocolVersion::V1) {
    writer.put(static_cast<std::uint8_t>(message.level));
    writer.put_text(std::string_view{message.text}.substr(0, k_max_text_bytes));
    return body;
  }
  for (const std::string_view text : {std::string_view{message.text}, std::string_view{message.source}}) {
    const std::string_view cut = text.substr(0, k_max_text_bytes);
    writer.put(static_cast<std::uint8_t>(cut.size()));
    writer.put_text(cut);
  }
  writer.put(static_cast<std::uint8_t>(message.level));
  return body;
}

Result<TextMessage> read_text(const Package& package, ProtocolVersion version) {
  Reader reader{package.payload};
  TextMessage message;
  std::uint8_t level = 0;
  if (version == ProtocolVersion::V1) {
    level = reader.get<std::uint8_t>().value_or(0);
    message.text = reader.get_rest();
  } else {
    message.text = reader.get_text(reader.get<std::uint8_t>().value_or(0)).value_or("");
    message.source = reader.get_text(reader.get<std::uint8_t>().value_or(0)).value_or("");
    level = reader.get<std::uint8_t>().value_or(0);
  }
  if (!reader.complete()) return bad_body(package);
  // Later controllers may have further levels; an unknown one is taken as the mildest.
  message.level = static_cast<TextLevel>(std::min(level, static_cast<std::uint8_t>(TextLevel::Info)));
  return message;
}

Bytes accepted_body(bool accepted) {
  return {static_cast<std::uint8_t>(accepted ? 1 : 0)};
}

template <class Reply>
Result<ControllerMessage> read_accepted(const Package& package) {
  Reader reader{package.payload};
  const std::uint8_t accepted = reader.get<std::uint8_t>().value_or(0);
  if (!reader.complete()) return bad_body(package);
  return Reply{.accepted = accepted != 0};
}

}  // namespace

void append(Bytes& out, const ClientMessage& message, ProtocolVersion version) {
  Bytes body;
  Writer writer{body};
  PackageType type{};
  std::visit(Overloaded{
                 [&](const ProtocolVersionRequest& m) {
                   type = PackageType::ProtocolVersion;
                   writer.put(m.version);
                 },
                 [&](const ControllerVersionRequest&) { type = PackageType::ControllerVersion; },
                 [&](const SetupOutputsRequest& m) {
                   type = PackageType::SetupOutputs;
                   if (version == ProtocolVersion::V2) writer.put(m.frequency_hz);
                   writer.put_text(join(m.names));
                 },
                 [&](const SetupInputsRequest& m) {
                   type = PackageType::SetupInputs;
                   writer.put_text(join(m.names));
                 },
                 [&](const StartRequest&) { type = PackageType::Start; },
                 [&](const PauseRequest&) { type = PackageType::Pause; },
                 [&](const TextMessage& m) {
                   type = PackageType::TextMessage;
                   body = body_of(m, version);
                 },
             },
             message);
  append_package(out, type, body);
}

void append(Bytes& out, const ControllerMessage& message, ProtocolVersion version) {
  Bytes body;
  Writer writer{body};
  PackageType type{};
  std::visit(Overloaded{
                 [&](const ProtocolVersionReply& m) {
                   type = PackageType::ProtocolVersion;
                   body = accepted_body(m.accepted);
                 },
                 [&](const ControllerVersionReply& m) {
                   type = PackageType::ControllerVersion;
                   for (const std::uint32_t part : {m.major, m.minor, m.bugfix, m.build}) writer.put(part);
                 },
                 [&](const SetupOutputsReply& m) {
                   type = PackageType::SetupOutputs;
                   if (version == ProtocolVersion::V2) writer.put(m.recipe_id);
                   writer.put_text(join(m.types));
                 },
                 [&](const SetupInputsReply& m) {
                   type = PackageType::SetupInputs;
                   writer.put(m.recipe_id);
                   writer.put_text(join(m.types));
                 },
                 [&](const StartReply& m) {
                   type = PackageType::Start;
                   body = accepted_body(m.accepted);
                 },
                 [&](const PauseReply& m) {
                   type = PackageType::Pause;
                   body = accepted_body(m.accepted);
                 },
                 [&](const TextMessage& m) {
                   type = PackageType::TextMessage;
                   body = body_of(m, version);
                 },
             },
             message);
  append_package(out, type, body);
}

Result<ClientMessage> read_client_message(const Package& package, ProtocolVersion version) {
  Reader reader{package.payload};
  switch (package.type) {
    case PackageType::ProtocolVersion: {
      const ProtocolVersionRequest request{.version = reader.get<std::uint16_t>().value_or(0)};
      if (!reader.complete()) return bad_body(package);
      return request;
    }
    case PackageType::SetupOutputs: {
      SetupOutputsRequest request;
      if (version == ProtocolVersion::V2) request.frequency_hz = reader.get<double>().value_or(0);
      request.names = split(reader.get_rest());
      if (!reader.complete() || !std::isfinite(request.frequency_hz)) return bad_body(package);
      return request;
    }
    case PackageType::SetupInputs:
      return SetupInputsRequest{.names = split(reader.get_rest())};
    case PackageType::ControllerVersion:
      if (!reader.complete()) return bad_body(package);
      return ControllerVersionRequest{};
    case PackageType::Start:
      if (!reader.complete()) return bad_body(package);
      return StartRequest{};
    case PackageType::Pause:
      if (!reader.complete()) return bad_body(package);
      return PauseRequest{};
    case PackageType::TextMessage: {
      BITELINE_ASSIGN(TextMessage text, read_text(package, version));
      return text;
    }
    case PackageType::Data:
      break;
  }
  BITELINE_EXPECTS(!"a data package is no message");
  return bad_body(package);
}

Result<ControllerMessage> read_controller_message(const Package& package, ProtocolVersion version) {
  Reader reader{package.payload};
  switch (package.type) {
    case PackageType::ProtocolVersion:
      return read_accepted<ProtocolVersionReply>(package);
    case PackageType::Start:
      return read_accepted<StartReply>(package);
    case PackageType::Pause:
      return read_accepted<PauseReply>(package);
    case PackageType::ControllerVersion: {
      ControllerVersionReply reply;
      for (std::uint32_t* part : {&reply.major, &reply.minor, &reply.bugfix, &reply.build}) {
        *part = reader.get<std::uint32_t>().value_or(0);
      }
      if (!reader.complete()) return bad_body(package);
      return reply;
    }
    case PackageType::SetupOutputs: {
      SetupOutputsReply reply;
      if (version == ProtocolVersion::V2) reply.recipe_id = reader.get<std::uint8_t>().value_or(0);
      reply.types = split(reader.get_rest());
      if (!reader.complete()) return bad_body(package);
      return reply;
    }
    case PackageType::SetupInputs: {
      SetupInputsReply reply;
      reply.recipe_id = reader.get<std::uint8_t>().value_or(0);
      reply.types = split(reader.get_rest());
      if (!reader.complete()) return bad_body(package);
      return reply;
    }
    case PackageType::TextMessage: {
      BITELINE_ASSIGN(TextMessage text, read_text(package, version));
      return text;
    }
    case PackageType::Data:
      break;
  }
  BITELINE_EXPECTS(!"a data package is no message");
  return bad_body(package);
}

}  // namespace biteline::rtde
