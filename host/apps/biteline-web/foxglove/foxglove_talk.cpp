// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/foxglove/foxglove_talk.hpp"

#include <google/protobuf/descriptor.pb.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "common/core/base64.hpp"
#include "foxglove/schemas.pb.h"
#include "host/interfaces/control/messages.hpp"

namespace biteline::web {
namespace {

using control::Json;

constexpr std::uint32_t k_camera_channel = 1;
constexpr std::uint32_t k_cloud_channel = 2;
constexpr char k_message_data = 1;  // the protocol's opcode
constexpr double k_metres_a_mm = 0.001;
// Offsets in the messages of /api/v1/live.
constexpr std::size_t k_picture_begin = 13;
constexpr std::size_t k_cloud_begin = 9;

/// The file and all that it imports, those first.
void collect(const google::protobuf::FileDescriptor& file, google::protobuf::FileDescriptorSet& set) {
  for (int i = 0; i < file.dependency_count(); ++i) collect(*file.dependency(i), set);
  file.CopyTo(set.add_file());
}

template <class Message>
std::string schema_of() {
  google::protobuf::FileDescriptorSet set;
  collect(*Message::descriptor()->file(), set);
  return to_base64(set.SerializeAsString());
}

template <class Message>
Json channel(std::uint32_t id, const char* topic) {
  return {{"id", id},
          {"topic", topic},
          {"encoding", "protobuf"},
          {"schemaName", Message::descriptor()->full_name()},
          {"schema", schema_of<Message>()},
          {"schemaEncoding", "protobuf"}};
}

template <class Message>
void stamp(Message& message, std::uint64_t now_ns) {
  message.mutable_timestamp()->set_seconds(static_cast<std::int64_t>(now_ns / 1'000'000'000));
  message.mutable_timestamp()->set_nanos(static_cast<std::int32_t>(now_ns % 1'000'000'000));
}

std::string image_message(const std::string& bytes, std::uint64_t now_ns) {
  foxglove::CompressedImage image;
  stamp(image, now_ns);
  image.set_frame_id("cam");
  image.set_format("jpeg");
  image.set_data(bytes.substr(k_picture_begin));
  return image.SerializeAsString();
}

std::string points_message(const std::string& bytes, std::uint64_t now_ns) {
  foxglove::PointCloud cloud;
  stamp(cloud, now_ns);
  cloud.set_frame_id("base");
  cloud.mutable_pose()->mutable_position();
  cloud.mutable_pose()->mutable_orientation()->set_w(1);
  constexpr std::size_t k_stride = 5 * sizeof(float);
  cloud.set_point_stride(k_stride);
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "curvature", "sigma"}) {
    foxglove::PackedElementField& field = *cloud.add_fields();
    field.set_name(name);
    field.set_offset(offset);
    field.set_type(foxglove::PackedElementField::FLOAT32);
    offset += sizeof(float);
  }
  std::string data = bytes.substr(k_cloud_begin);
  // In metres, and 1/m.
  for (std::size_t at = 0; at + k_stride <= data.size(); at += k_stride) {
    std::array<float, 5> point{};
    std::memcpy(point.data(), data.data() + at, sizeof point);
    constexpr auto k_scale = static_cast<float>(k_metres_a_mm);
    for (std::size_t i = 0; i < point.size(); ++i) point.at(i) *= i == 3 ? 1 / k_scale : k_scale;
    std::memcpy(data.data() + at, point.data(), sizeof point);
  }
  cloud.set_data(std::move(data));
  return cloud.SerializeAsString();
}

template <class Number>
void append(std::string& out, Number number) {
  std::array<char, sizeof number> raw;
  std::memcpy(raw.data(), &number, sizeof number);
  out.append(raw.data(), raw.size());
}

/// A whole number from 0 of an object; nothing: it has none.
std::optional<std::uint32_t> id_in(const Json& object, const char* field) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(field);
  if (found == object.end() || !found->is_number_unsigned()) return std::nullopt;
  return found->get<std::uint32_t>();
}

}  // namespace

std::string_view choose_foxglove_protocol(std::string_view offer) {
  while (!offer.empty()) {
    const std::size_t end = std::min(offer.find(','), offer.size());
    std::string_view name = offer.substr(0, end);
    while (name.starts_with(' ')) name.remove_prefix(1);
    while (name.ends_with(' ')) name.remove_suffix(1);
    const auto* const known = std::ranges::find(k_foxglove_protocols, name);
    if (known != k_foxglove_protocols.end()) return *known;
    offer.remove_prefix(std::min(end + 1, offer.size()));
  }
  return {};
}

std::vector<std::string> FoxgloveTalk::first_words() {
  const Json info{{"op", "serverInfo"}, {"name", "biteline-web"}, {"capabilities", Json::array()}};
  Json channels = Json::array();
  channels.push_back(channel<foxglove::CompressedImage>(k_camera_channel, "/camera"));
  channels.push_back(channel<foxglove::PointCloud>(k_cloud_channel, "/cloud"));
  const Json advertise{{"op", "advertise"}, {"channels", std::move(channels)}};
  return {info.dump(), advertise.dump()};
}

void FoxgloveTalk::hear(std::string_view text) {
  const std::optional<Json> said = control::parse_bounded(text);
  if (!said || !said->is_object() || !said->contains("op")) return;
  if ((*said)["op"] == "subscribe" && said->contains("subscriptions")) {
    for (const Json& entry : (*said)["subscriptions"]) {
      const auto id = id_in(entry, "id");
      const auto channel = id_in(entry, "channelId");
      if (id && channel && channel_of_.size() < k_most_subscriptions) channel_of_[*id] = *channel;
    }
  } else if ((*said)["op"] == "unsubscribe" && said->contains("subscriptionIds")) {
    for (const Json& id : (*said)["subscriptionIds"]) {
      if (id.is_number_unsigned()) channel_of_.erase(id.get<std::uint32_t>());
    }
  }
}

std::vector<std::string> FoxgloveTalk::messages(const std::string& bytes, std::uint64_t now_ns) const {
  const auto kind = bytes.empty() ? LiveKind{} : static_cast<LiveKind>(bytes.front());
  const std::uint32_t of_kind = kind == LiveKind::Picture && bytes.size() > k_picture_begin ? k_camera_channel
                                : kind == LiveKind::Cloud && bytes.size() > k_cloud_begin   ? k_cloud_channel
                                                                                            : 0;
  std::vector<std::string> out;
  std::string content;
  for (const auto& [subscription, channel] : channel_of_) {
    if (of_kind == 0 || channel != of_kind) continue;
    if (content.empty()) {
      content = kind == LiveKind::Picture ? image_message(bytes, now_ns) : points_message(bytes, now_ns);
    }
    std::string message(1, k_message_data);
    append(message, subscription);
    append(message, now_ns);
    out.push_back(message + content);
  }
  return out;
}

}  // namespace biteline::web
