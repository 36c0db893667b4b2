// SPDX-License-Identifier: MIT
#pragma once
/// \file Reads a sensor's messages and recorded scans (scan.btln) for programs of your own: C++17, this file
/// alone.
///
///     for (const biteline_scan::Profile& profile : biteline_scan::read_scan("scan.btln")->profiles)
///       for (const biteline_scan::Place& place : biteline_scan::places_base(profile)) ...
///
/// Of a live sensor: hand each message that comes over ZeroMQ to a Decoder; host_hello(), start_scan() and
/// ack() are what you say (read_live.cpp is an example).  The format is described in docs/protocol.md.
///
/// Nothing that comes from outside is believed before it is checked: a damaged message gives no profile.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace biteline_scan {

/// Profiles with one of these flags stay out of a cloud; points likewise.
constexpr std::uint32_t k_not_usable = 0x1A3, k_not_surface = 0x322;

using Bytes = std::vector<std::uint8_t>;
/// Rotation row by row, then translation in mm.
using Motion = std::array<double, 12>;

/// Columns of equal length, one number for each point; units and flags as in docs/protocol.md.
struct Profile {
  std::uint64_t scan_id{0}, sequence{0}, frame_sequence{0};
  std::int64_t exposure_mid_ns{0};
  std::uint32_t flags{0};
  std::optional<std::int64_t> encoder_ticks{};  ///< where an encoder is the pose
  std::optional<float> speckle_contrast{};      ///< where the stripe shows it
  Motion T_base_flange{}, T_flange_cam{};
  std::vector<float> x, y, z, sigma_mm, row_px, sigma_row_px, amplitude, width_px;
  std::vector<std::uint16_t> column, point_flags;
  std::vector<std::uint8_t> peak_count;
};

struct Place {
  std::array<double, 3> mm{};
  std::uint16_t column{0};
};

enum class Kind : std::uint8_t {
  HostHello = 1,
  SensorHello,
  Profile,
  Health,
  EndOfScan,
  Ack,
  Control,
  ControlReply,
  Gap,
  Bye,
  ObserverHello,
  Picture
};

/// One whole message.
struct Message {
  Kind kind{Kind::Bye};
  std::uint64_t scan_id{0};
  std::uint64_t sequence{0};       ///< of profiles and a scan's end
  std::uint16_t errc{0};           ///< of a scan's end and a command's answer; 0: well
  std::optional<Profile> profile;  ///< of Kind::Profile
};

struct Scan {
  std::vector<Profile> profiles;
  bool complete{false};  ///< its end is there, and it ended by itself
};

namespace detail {

constexpr std::size_t k_most_bytes = 512 * 1024, k_most_points = 5184;

inline std::uint32_t crc32c(const std::uint8_t* data, std::size_t size) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      made[i] = i;
      for (int bit = 0; bit < 8; ++bit) made[i] = made[i] >> 1U ^ (0x82F63B78U & (0U - (made[i] & 1U)));
    }
    return made;
  }();
  std::uint32_t crc = 0xFFFFFFFF;
  for (std::size_t i = 0; i < size; ++i) crc = crc >> 8U ^ table[(crc ^ data[i]) & 0xFFU];
  return ~crc;
}

/// Little-endian numbers of a message; what lies beyond its end sets `broken`.
class Reader {
 public:
  Reader(const std::uint8_t* data, std::size_t size) : data_{data}, size_{size} {}

  template <class Number>
  Number number(std::size_t at) {
    Number value{};
    if (at > size_ || size_ - at < sizeof value) {
      broken = true;
      return value;
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof value; ++i) bits |= std::uint64_t{data_[at + i]} << (8 * i);
    std::array<std::uint8_t, 8> native{};
    const auto narrow = [&](auto narrowed) { std::memcpy(native.data(), &narrowed, sizeof narrowed); };
    if constexpr (sizeof value == 1) narrow(static_cast<std::uint8_t>(bits));
    if constexpr (sizeof value == 2) narrow(static_cast<std::uint16_t>(bits));
    if constexpr (sizeof value == 4) narrow(static_cast<std::uint32_t>(bits));
    if constexpr (sizeof value == 8) narrow(bits);
    std::memcpy(&value, native.data(), sizeof value);
    return value;
  }
  const std::uint8_t* bytes(std::size_t at, std::size_t count) {
    if (at > size_ || size_ - at < count) broken = true;
    return broken ? nullptr : data_ + at;
  }

  bool broken{false};

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

/// A FlatBuffers table; slots as in common/wire/protocol.fbs.
class Table {
 public:
  Table(Reader& reader, std::size_t at) : reader_{reader}, at_{at} {
    vtable_ = at - static_cast<std::size_t>(static_cast<std::int64_t>(reader.number<std::int32_t>(at)));
  }
  /// Nothing: the field is absent.
  std::optional<std::size_t> place(std::size_t slot) {
    const std::size_t entry = 4 + 2 * slot;
    if (entry + 2 > reader_.number<std::uint16_t>(vtable_)) return std::nullopt;
    const auto offset = reader_.number<std::uint16_t>(vtable_ + entry);
    if (offset == 0) return std::nullopt;
    return at_ + offset;
  }
  template <class Number>
  Number number(std::size_t slot) {
    const std::optional<std::size_t> at = place(slot);
    return at ? reader_.number<Number>(*at) : Number{};
  }
  Motion motion(std::size_t slot) {
    Motion motion{};
    const std::optional<std::size_t> at = place(slot);
    if (!at) reader_.broken = true;
    for (std::size_t i = 0; at && i < motion.size(); ++i) motion[i] = reader_.number<double>(*at + 8 * i);
    return motion;
  }
  /// Where a table or a vector stands.
  std::size_t follow(std::size_t slot) {
    const std::optional<std::size_t> at = place(slot);
    if (!at) reader_.broken = true;
    return at ? *at + reader_.number<std::uint32_t>(*at) : 0;
  }
  /// A packed column (docs/protocol.md, "A profile's numbers").
  std::vector<std::uint32_t> column(std::size_t slot, std::size_t count,
                                    const std::array<std::size_t, 4>& lengths, std::uint32_t step) {
    const std::size_t at = follow(slot);
    const auto size = reader_.number<std::uint32_t>(at);
    const std::uint8_t* packed = reader_.bytes(at + 4, size);
    std::vector<std::uint32_t> values;
    std::size_t next = (count + 3) / 4;
    if (packed == nullptr || size < next) {
      reader_.broken = true;
      return values;
    }
    values.reserve(count);
    std::uint32_t predicted = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t length = lengths[packed[i / 4] >> (2 * (i % 4)) & 3U];
      if (size - next < length) break;
      std::uint32_t coded = 0;
      for (std::size_t k = 0; k < length; ++k) coded |= std::uint32_t{packed[next + k]} << (8 * k);
      next += length;
      values.push_back(predicted + (coded >> 1U ^ (0U - (coded & 1U))));
      predicted = values.back() + step;
    }
    if (values.size() != count || next != size) reader_.broken = true;
    return values;
  }

 private:
  Reader& reader_;
  std::size_t at_, vtable_;
};

inline std::vector<float> floats(const std::vector<std::uint32_t>& bits) {
  std::vector<float> values(bits.size());
  if (!bits.empty()) std::memcpy(values.data(), bits.data(), 4 * bits.size());
  return values;
}

inline std::optional<Profile> read_profile(Reader& reader, Table& body) {
  constexpr std::array<std::size_t, 4> k_dense{1, 2, 3, 4}, k_sparse{0, 1, 2, 4};
  const auto count = body.number<std::uint32_t>(6);
  if (count > k_most_points) return std::nullopt;
  Profile profile;
  profile.sequence = body.number<std::uint64_t>(0);
  profile.frame_sequence = body.number<std::uint64_t>(1);
  profile.exposure_mid_ns = body.number<std::int64_t>(2);
  profile.T_base_flange = body.motion(3);
  profile.flags = body.number<std::uint32_t>(5);
  if (body.place(18)) profile.encoder_ticks = body.number<std::int64_t>(18);
  if (body.place(19)) profile.speckle_contrast = body.number<float>(19);
  std::size_t slot = 7;
  for (std::vector<float>* column : {&profile.x, &profile.y, &profile.z, &profile.sigma_mm, &profile.row_px,
                                     &profile.sigma_row_px, &profile.amplitude, &profile.width_px})
    *column = floats(body.column(slot++, count, k_dense, 0));
  for (const auto& [column, step] : {std::pair{&profile.column, 1U}, {&profile.point_flags, 0U}})
    for (const std::uint32_t value : body.column(slot++, count, k_sparse, step))
      column->push_back(static_cast<std::uint16_t>(value));
  for (const std::uint32_t value : body.column(slot, count, k_sparse, 0))
    profile.peak_count.push_back(static_cast<std::uint8_t>(value));
  if (reader.broken) return std::nullopt;
  return profile;
}

/// A message of whole numbers only: FlatBuffers' layout by hand, as in docs/protocol.md, "Example".
inline Bytes message(Kind kind, std::uint64_t scan_id, const Bytes& body_slots, const Bytes& body_data) {
  Bytes made{0x18, 0, 0,    0, 'B',  'T', 'L', 'N', 0x0e, 0, 0x20, 0, 4, 0, 8, 0,
             0x10, 0, 0x18, 0, 0x1c, 0,   0,   0,   0x10, 0, 0,    0, 1, 0, 0, 0};
  for (std::size_t i = 0; i < 8; ++i) made.push_back(static_cast<std::uint8_t>(scan_id >> (8 * i)));
  made.insert(made.end(), 8, 0);
  const auto slots = static_cast<std::uint8_t>(body_slots.size());
  // The body's type, and how far on its table stands: behind its own slots, which end at a multiple of 8.
  for (const std::uint8_t byte :
       {static_cast<std::uint8_t>(kind), std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0},
        static_cast<std::uint8_t>(4 + slots), std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}})
    made.push_back(byte);
  made.insert(made.end(), body_slots.begin(), body_slots.end());
  for (const std::uint8_t byte : {slots, std::uint8_t{0}, std::uint8_t{0}, std::uint8_t{0}})
    made.push_back(byte);
  made.insert(made.end(), body_data.begin(), body_data.end());
  const std::uint32_t crc = crc32c(made.data(), made.size());
  for (std::size_t i = 0; i < 4; ++i) made.push_back(static_cast<std::uint8_t>(crc >> (8 * i)));
  return made;
}

}  // namespace detail

/// Keeps what a scan's hello told of the head, for its profiles.
class Decoder {
 public:
  /// Nothing: damaged, of another protocol, or of a length that no message has.
  std::optional<Message> read(const std::uint8_t* data, std::size_t size) {
    if (size < 12 || size > detail::k_most_bytes || std::memcmp(data + 4, "BTLN", 4) != 0)
      return std::nullopt;
    detail::Reader reader{data, size - 4};
    detail::Reader end{data, size};
    if (end.number<std::uint32_t>(size - 4) != detail::crc32c(data, size - 4)) return std::nullopt;
    detail::Table envelope{reader, reader.number<std::uint32_t>(0)};
    if (envelope.number<std::uint16_t>(0) != 1) return std::nullopt;
    Message message;
    message.scan_id = envelope.number<std::uint64_t>(1);
    message.sequence = envelope.number<std::uint64_t>(2);
    message.kind = static_cast<Kind>(envelope.number<std::uint8_t>(3));
    detail::Table body{reader, envelope.follow(4)};
    if (message.kind == Kind::SensorHello) {
      detail::Table model{reader, body.follow(9)};
      T_flange_cam_ = model.motion(11);
    }
    if (message.kind == Kind::EndOfScan) message.errc = body.number<std::uint16_t>(0);
    if (message.kind == Kind::ControlReply) message.errc = body.number<std::uint16_t>(1);
    if (message.kind == Kind::Profile) {
      message.profile = detail::read_profile(reader, body);
      if (!message.profile) return std::nullopt;
      message.profile->scan_id = message.scan_id;
      message.profile->T_flange_cam = T_flange_cam_;
    }
    if (reader.broken) return std::nullopt;
    return message;
  }

 private:
  Motion T_flange_cam_{};
};

/// What a host says: first on a connection; to begin a scan; and that it has everything below `next`.
inline Bytes host_hello() {
  return detail::message(Kind::HostHello, 0, {4, 0, 4, 0, 0, 0, 0, 0}, Bytes(4));
}
inline Bytes start_scan() {
  return detail::message(Kind::Control, 0, {8, 0, 9, 0, 4, 0, 8, 0}, {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
}
inline Bytes ack(std::uint64_t scan_id, std::uint64_t next) {
  Bytes data(4);  // the number stands at a multiple of 8
  for (std::size_t i = 0; i < 8; ++i) data.push_back(static_cast<std::uint8_t>(next >> (8 * i)));
  return detail::message(Kind::Ack, scan_id, {6, 0, 16, 0, 8, 0, 0, 0}, data);
}

/// What stands before the first damage.  Nothing: no such file, or no recorded scan.
inline std::optional<Scan> read_scan(const std::string& file) {
  std::ifstream in{file, std::ios::binary};
  std::array<char, 8> head{};
  if (!in.read(head.data(), head.size()) || std::memcmp(head.data(), "BTLNSCAN", head.size()) != 0)
    return std::nullopt;
  Scan scan;
  Decoder decoder;
  Bytes data;
  while (in.read(head.data(), 4)) {
    detail::Reader length{reinterpret_cast<const std::uint8_t*>(head.data()), 4};
    const std::size_t bytes = length.number<std::uint32_t>(0);
    if (bytes > detail::k_most_bytes) break;
    data.resize(bytes);
    if (!in.read(reinterpret_cast<char*>(data.data()), static_cast<std::streamsize>(bytes))) break;
    std::optional<Message> message = decoder.read(data.data(), data.size());
    if (!message) break;
    if (message->kind == Kind::EndOfScan) scan.complete = message->errc == 0;
    if (message->profile) scan.profiles.push_back(std::move(*message->profile));
  }
  return scan;
}

inline std::array<double, 3> transformed(const Motion& motion, const std::array<double, 3>& place) {
  std::array<double, 3> moved{};
  for (std::size_t row = 0; row < 3; ++row)
    moved[row] = motion[3 * row] * place[0] + motion[3 * row + 1] * place[1] +
                 motion[3 * row + 2] * place[2] + motion[9 + row];
  return moved;
}

/// The surface's points of a usable profile in base, mm.
inline std::vector<Place> places_base(const Profile& profile) {
  std::vector<Place> places;
  if ((profile.flags & k_not_usable) != 0) return places;
  for (std::size_t i = 0; i < profile.x.size(); ++i) {
    if ((profile.point_flags[i] & k_not_surface) != 0) continue;
    const std::array<double, 3> cam{profile.x[i], profile.y[i], profile.z[i]};
    places.push_back(
        {transformed(profile.T_base_flange, transformed(profile.T_flange_cam, cam)), profile.column[i]});
  }
  return places;
}

}  // namespace biteline_scan
