// SPDX-License-Identifier: MIT
#include "common/wire/messages.hpp"

#include <cstring>

#include "common/wire/checksum.hpp"
#include "common/wire/picture_codec.hpp"
#include "common/wire/profile_codec.hpp"
#include "common/wire/protocol_generated.h"
#include "common/wire/schema_parts.hpp"
#include "common/wire/settings_codec.hpp"

namespace biteline::wire {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

// The schema is four tables deep; a hello holds some ten of them and a health message one per stage.
constexpr flatbuffers::uoffset_t k_max_depth = 8;
constexpr flatbuffers::uoffset_t k_max_tables = 256;

constexpr std::size_t k_checksum_bytes =
    sizeof(std::uint32_t);  ///< CRC-32C of all before, little-endian, at the end

struct PackedBody {
  fb::Body type{fb::Body_NONE};
  Offset<void> offset;
};

template <class Table>
PackedBody packed(fb::Body type, Offset<Table> table) {
  return {.type = type, .offset = table.Union()};
}

PackedBody pack_body(FlatBufferBuilder& fbb, const HostHello& hello) {
  return packed(fb::Body_HostHello,
                fb::CreateHostHello(fbb, text(fbb, hello.name), hello.resume, hello.resume_scan_id,
                                    hello.next_sequence, hello.safe_sequence));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const SensorHello& hello) {
  const auto name = text(fbb, hello.name);
  const auto version = text(fbb, hello.version);
  const auto scan_name = text(fbb, hello.scan_name);
  const auto model = pack_model(fbb, hello.model);
  const auto state = pack_camera_state(fbb, hello.camera_state);
  return packed(fb::Body_SensorHello,
                fb::CreateSensorHello(fbb, name, version, scan_name, hello.frames_expected, hello.lossless,
                                      hello.simulated, hello.scanning, hello.held_from, hello.held_to, model,
                                      hello.protocol_minor, hello.test_pattern, state));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const profile::Profile& profile) {
  return packed(fb::Body_Profile, pack_profile(fbb, profile.header, profile.points));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const Health& health) {
  const auto counters = pack_counters(fbb, health.counters);
  const auto stages = pack_stages(fbb, health.stages);
  const auto reason = text(fbb, health.laser_reason);
  const auto devices = pack_devices(fbb, health.devices);
  const auto settings = pack_settings(fbb, health.settings);
  const auto upkeep = pack_upkeep(fbb, health.upkeep);
  return packed(
      fb::Body_Health,
      fb::CreateHealth(fbb, counters, stages, static_cast<fb::LaserState>(health.laser), reason,
                       health.scanning, devices, health.observers, health.pictures, settings, upkeep));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const EndOfScan& end) {
  const auto where = text(fbb, end.where);
  const auto counters = pack_counters(fbb, end.counters);
  const auto stages = pack_stages(fbb, end.stages);
  const auto devices = pack_devices(fbb, end.devices);
  return packed(fb::Body_EndOfScan, fb::CreateEndOfScan(fbb, end.errc, where, counters, stages, devices));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const Ack& ack) {
  return packed(fb::Body_Ack, fb::CreateAck(fbb, ack.safe_sequence));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const Control& control) {
  const auto settings = settings_text(fbb, control.settings);
  return packed(fb::Body_Control,
                fb::CreateControl(fbb, control.id, static_cast<fb::Command>(control.command), settings));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const ControlReply& reply) {
  return packed(fb::Body_ControlReply,
                fb::CreateControlReply(fbb, reply.id, reply.errc, text(fbb, reply.where)));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const Gap& gap) {
  return packed(fb::Body_Gap, fb::CreateGap(fbb, gap.first, gap.count));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const Bye& bye) {
  return packed(fb::Body_Bye, fb::CreateBye(fbb, static_cast<fb::ByeReason>(bye.reason), text(fbb, bye.text),
                                            bye.protocol));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const ObserverHello& hello) {
  const auto name = text(fbb, hello.name);
  const auto picture = pack_wish(fbb, hello.picture);
  return packed(
      fb::Body_ObserverHello,
      fb::CreateObserverHello(fbb, name, static_cast<float>(hello.profile_rate_hz), picture, hello.received));
}

PackedBody pack_body(FlatBufferBuilder& fbb, const Picture& picture) {
  return packed(fb::Body_Picture, pack_picture(fbb, picture));
}

void finish(FlatBufferBuilder& fbb, const Message& address, PackedBody body, Bytes& out) {
  const auto envelope =
      fb::CreateEnvelope(fbb, address.protocol, address.scan_id, address.sequence, body.type, body.offset);
  fb::FinishEnvelopeBuffer(fbb, envelope);
  const std::span<const std::uint8_t> content{fbb.GetBufferPointer(), fbb.GetSize()};
  const std::uint32_t checksum = crc32c(content);
  out.resize(content.size() + k_checksum_bytes);
  std::memcpy(out.data(), content.data(), content.size());
  std::memcpy(out.data() + content.size(), &checksum, k_checksum_bytes);
}

Result<Body> read_body(const fb::HostHello& table) {
  return HostHello{.name = to_string(table.name()),
                   .resume = table.resume(),
                   .resume_scan_id = table.resume_scan_id(),
                   .next_sequence = table.next_sequence(),
                   .safe_sequence = table.safe_sequence()};
}

Result<Body> read_body(const fb::SensorHello& table) {
  if (table.model() == nullptr) return fail(Errc::ProtocolError, "hello without a sensor model");
  BITELINE_ASSIGN(const geometry::SensorModel model, read_model(*table.model()));
  BITELINE_ASSIGN(const geometry::CameraState camera_state, read_camera_state(table.camera_state()));
  if (table.held_to() < table.held_from())
    return fail(Errc::ProtocolError, "hello with a reversed range of messages");
  return SensorHello{.name = to_string(table.name()),
                     .version = to_string(table.version()),
                     .scan_name = to_string(table.scan_name()),
                     .frames_expected = table.frames_expected(),
                     .lossless = table.lossless(),
                     .simulated = table.simulated(),
                     .scanning = table.scanning(),
                     .held_from = table.held_from(),
                     .held_to = table.held_to(),
                     .model = model,
                     .protocol_minor = table.protocol_minor(),
                     .test_pattern = table.test_pattern(),
                     .camera_state = camera_state};
}

Result<Body> read_body(const fb::Profile& table) {
  BITELINE_ASSIGN(profile::Profile profile, read_profile(table));
  return profile;
}

Result<Body> read_body(const fb::Health& table) {
  if (table.laser() > fb::LaserState_MAX) return fail(Errc::ProtocolError, "health: unknown laser state");
  BITELINE_ASSIGN(Devices devices, read_devices(table.devices()));
  BITELINE_ASSIGN(std::optional<SettingsState> settings, read_settings(table.settings()));
  BITELINE_ASSIGN(const std::optional<UpkeepState> upkeep, read_upkeep(table.upkeep()));
  return Health{.counters = read_counters(table.counters()),
                .stages = read_stages(table.stages()),
                .laser = static_cast<LaserState>(table.laser()),
                .laser_reason = to_string(table.laser_reason()),
                .scanning = table.scanning(),
                .devices = std::move(devices),
                .observers = table.observers(),
                .pictures = table.pictures(),
                .settings = std::move(settings),
                .upkeep = upkeep};
}

Result<Body> read_body(const fb::EndOfScan& table) {
  BITELINE_ASSIGN(Devices devices, read_devices(table.devices()));
  return EndOfScan{.errc = table.errc(),
                   .where = to_string(table.where()),
                   .counters = read_counters(table.counters()),
                   .stages = read_stages(table.stages()),
                   .devices = std::move(devices)};
}

Result<Body> read_body(const fb::Ack& table) {
  return Ack{.safe_sequence = table.safe_sequence()};
}

Result<Body> read_body(const fb::Control& table) {
  if (table.command() > fb::Command_MAX) return fail(Errc::ProtocolError, "control: unknown command");
  BITELINE_ASSIGN(std::string settings, to_settings_text(table.settings()));
  return Control{
      .id = table.id(), .command = static_cast<Command>(table.command()), .settings = std::move(settings)};
}

Result<Body> read_body(const fb::ControlReply& table) {
  return ControlReply{.id = table.id(), .errc = table.errc(), .where = to_string(table.where())};
}

Result<Body> read_body(const fb::Gap& table) {
  if (table.count() > UINT64_MAX - table.first()) return fail(Errc::ProtocolError, "gap: range overflows");
  return Gap{.first = table.first(), .count = table.count()};
}

Result<Body> read_body(const fb::Bye& table) {
  if (table.reason() > fb::ByeReason_MAX) return fail(Errc::ProtocolError, "bye: unknown reason");
  return Bye{.reason = static_cast<ByeReason>(table.reason()),
             .text = to_string(table.text()),
             .protocol = table.protocol()};
}

Result<Body> read_body(const fb::ObserverHello& table) {
  BITELINE_ASSIGN(const PictureWish picture, read_wish(table.picture()));
  if (!is_rate(table.profile_rate_hz()))
    return fail(Errc::ProtocolError, "observer: a rate of profiles below 0 or beyond 1000 Hz");
  return ObserverHello{.name = to_string(table.name()),
                       .profile_rate_hz = table.profile_rate_hz(),
                       .picture = picture,
                       .received = table.received()};
}

Result<Body> read_body(const fb::Picture& table) {
  BITELINE_ASSIGN(Picture picture, read_picture(table));
  return picture;
}

/// The message without its checksum.
Result<std::span<const std::uint8_t>> unsealed(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > k_max_message_bytes)
    return fail(Errc::ProtocolError, "message of %zu bytes", bytes.size());
  // An offset and the identifier come first; the identifier is read before anything is verified.
  if (bytes.size() < 2 * sizeof(flatbuffers::uoffset_t) + k_checksum_bytes ||
      !fb::EnvelopeBufferHasIdentifier(bytes.data())) {
    return fail(Errc::ProtocolError, "not a Biteline message");
  }
  const std::span<const std::uint8_t> content = bytes.first(bytes.size() - k_checksum_bytes);
  std::uint32_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + content.size(), k_checksum_bytes);
  if (crc32c(content) != checksum) return fail(Errc::ProtocolError, "message damaged on its way");
  return content;
}

Result<Body> read_union(const fb::Envelope& envelope) {
  // The verifier has checked that a known type comes with a table of that type.
  switch (envelope.body_type()) {
    case fb::Body_HostHello:
      return read_body(*envelope.body_as_HostHello());
    case fb::Body_SensorHello:
      return read_body(*envelope.body_as_SensorHello());
    case fb::Body_Profile:
      return read_body(*envelope.body_as_Profile());
    case fb::Body_Health:
      return read_body(*envelope.body_as_Health());
    case fb::Body_EndOfScan:
      return read_body(*envelope.body_as_EndOfScan());
    case fb::Body_Ack:
      return read_body(*envelope.body_as_Ack());
    case fb::Body_Control:
      return read_body(*envelope.body_as_Control());
    case fb::Body_ControlReply:
      return read_body(*envelope.body_as_ControlReply());
    case fb::Body_Gap:
      return read_body(*envelope.body_as_Gap());
    case fb::Body_Bye:
      return read_body(*envelope.body_as_Bye());
    case fb::Body_ObserverHello:
      return read_body(*envelope.body_as_ObserverHello());
    case fb::Body_Picture:
      return read_body(*envelope.body_as_Picture());
    case fb::Body_NONE:
      break;
  }
  return fail(Errc::ProtocolError, "message of unknown kind %d", static_cast<int>(envelope.body_type()));
}

}  // namespace

Result<Message> decode(std::span<const std::uint8_t> bytes) {
  BITELINE_ASSIGN(const std::span<const std::uint8_t> content, unsealed(bytes));
  flatbuffers::Verifier verifier{content.data(), content.size(), k_max_depth, k_max_tables};
  if (!fb::VerifyEnvelopeBuffer(verifier))
    return fail(Errc::ProtocolError, "message with a broken structure");
  const fb::Envelope& envelope = *fb::GetEnvelope(content.data());
  // A farewell is readable in every version: it says why the other side does not go on.
  const bool farewell = envelope.body_type() == fb::Body_Bye;
  if (envelope.protocol() != k_protocol && !farewell) {
    return fail(Errc::NotSupported, "the peer speaks protocol %d, this program %d",
                static_cast<int>(envelope.protocol()), static_cast<int>(k_protocol));
  }
  if (envelope.body() == nullptr) return fail(Errc::ProtocolError, "message without a body");
  Message message{.protocol = envelope.protocol(),
                  .scan_id = envelope.scan_id(),
                  .sequence = envelope.sequence(),
                  .body = {}};
  BITELINE_ASSIGN(message.body, read_union(envelope));
  return message;
}

void encode(const Message& message, Bytes& out) {
  FlatBufferBuilder fbb;
  const PackedBody body = std::visit([&](const auto& kind) { return pack_body(fbb, kind); }, message.body);
  finish(fbb, message, body, out);
}

void encode_profile(ProfileAddress address, const profile::ProfileHeader& header,
                    std::span<const profile::ProfilePoint> points, Bytes& out) {
  FlatBufferBuilder fbb{64 * 1024};
  const PackedBody body = packed(fb::Body_Profile, pack_profile(fbb, header, points));
  finish(fbb, {.scan_id = address.scan_id, .sequence = address.sequence, .body = {}}, body, out);
}

}  // namespace biteline::wire
