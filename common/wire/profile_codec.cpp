// SPDX-License-Identifier: MIT
#include "common/wire/profile_codec.hpp"

#include <array>
#include <bit>
#include <cmath>

#include "common/core/numbers.hpp"
#include "common/wire/packing.hpp"
#include "common/wire/schema_parts.hpp"

namespace biteline::wire {
namespace {

using profile::ProfilePoint;
using ColumnOffset = flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>>;
using Numbers = std::array<std::uint32_t, profile::k_max_profile_points>;

/// How one column of a profile is packed.
struct ColumnForm {
  Lengths lengths{Lengths::Dense};
  std::uint32_t step{0};
};

constexpr ColumnForm k_measured{.lengths = Lengths::Dense, .step = 0};
constexpr ColumnForm k_constant{.lengths = Lengths::Sparse, .step = 0};
constexpr ColumnForm k_counting{.lengths = Lengths::Sparse,
                                .step = 1};  // image columns mostly follow one another

/// `bits_of(point)` is the column's number as 32 bits.
template <class BitsOf>
ColumnOffset pack_column(flatbuffers::FlatBufferBuilder& fbb, std::span<const ProfilePoint> points,
                         ColumnForm form, BitsOf&& bits_of) {
  thread_local Numbers numbers;
  thread_local std::vector<std::uint8_t> packed;
  for (std::size_t i = 0; i < points.size(); ++i) numbers[i] = bits_of(points[i]);
  packed.clear();
  pack({numbers.data(), points.size()}, form.lengths, form.step, packed);
  return fbb.CreateVector(packed.data(), packed.size());
}

template <class Member>
ColumnOffset pack_floats(flatbuffers::FlatBufferBuilder& fbb, std::span<const ProfilePoint> points,
                         Member&& member) {
  return pack_column(fbb, points, k_measured, [&](const ProfilePoint& point) {
    return std::bit_cast<std::uint32_t>(float{member(point)});
  });
}

/// `store(point, bits)` puts one number back, and is false when it cannot be one.
template <class Store>
Result<void> unpack_column(const flatbuffers::Vector<std::uint8_t>* packed, ColumnForm form, const char* name,
                           std::span<ProfilePoint> points, Store&& store) {
  thread_local Numbers numbers;
  const std::span<std::uint32_t> values{numbers.data(), points.size()};
  const std::span<const std::uint8_t> bytes =
      packed == nullptr ? std::span<const std::uint8_t>{} : std::span{packed->data(), packed->size()};
  if (!unpack(bytes, form.lengths, form.step, values)) {
    return fail(Errc::ProtocolError, "profile: column %s is not as long as its points", name);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!store(points[i], values[i]))
      return fail(Errc::ProtocolError, "profile: impossible number in column %s", name);
  }
  return {};
}

template <class Member>
Result<void> unpack_floats(const flatbuffers::Vector<std::uint8_t>* packed, const char* name,
                           std::span<ProfilePoint> points, Member&& member) {
  return unpack_column(packed, k_measured, name, points, [&](ProfilePoint& point, std::uint32_t bits) {
    const auto number = std::bit_cast<float>(bits);
    member(point) = number;
    return NumberRange{}.holds(number);
  });
}

template <class Integer, class Member>
Result<void> unpack_integers(const flatbuffers::Vector<std::uint8_t>* packed, ColumnForm form,
                             const char* name, std::span<ProfilePoint> points, Member&& member) {
  return unpack_column(packed, form, name, points, [&](ProfilePoint& point, std::uint32_t bits) {
    member(point) = static_cast<Integer>(bits);
    return bits <= std::numeric_limits<Integer>::max();
  });
}

}  // namespace

flatbuffers::Offset<fb::Profile> pack_profile(flatbuffers::FlatBufferBuilder& fbb,
                                              const profile::ProfileHeader& header,
                                              std::span<const ProfilePoint> points) {
  const auto x = pack_floats(fbb, points, [](const ProfilePoint& p) { return p.point_cam.x(); });
  const auto y = pack_floats(fbb, points, [](const ProfilePoint& p) { return p.point_cam.y(); });
  const auto z = pack_floats(fbb, points, [](const ProfilePoint& p) { return p.point_cam.z(); });
  const auto sigma = pack_floats(fbb, points, [](const ProfilePoint& p) { return p.sigma_mm; });
  const auto row = pack_floats(fbb, points, [](const ProfilePoint& p) { return p.row_px; });
  const auto sigma_row = pack_floats(fbb, points, [](const ProfilePoint& p) { return p.sigma_row_px; });
  const auto amplitude = pack_floats(fbb, points, [](const ProfilePoint& p) { return p.amplitude; });
  const auto width = pack_floats(fbb, points, [](const ProfilePoint& p) { return p.width_px; });
  const auto column =
      pack_column(fbb, points, k_counting, [](const ProfilePoint& p) { return std::uint32_t{p.column}; });
  const auto flags =
      pack_column(fbb, points, k_constant, [](const ProfilePoint& p) { return std::uint32_t{p.flags}; });
  const auto peaks =
      pack_column(fbb, points, k_constant, [](const ProfilePoint& p) { return std::uint32_t{p.peak_count}; });
  const fb::Motion T_base_flange = pack_motion(header.T_base_flange);
  return fb::CreateProfile(fbb, header.sequence, header.frame_sequence,
                           header.exposure_mid.time_since_epoch().count(), &T_base_flange,
                           header.pose_age.count(), header.flags, static_cast<std::uint32_t>(points.size()),
                           x, y, z, sigma, row, sigma_row, amplitude, width, column, flags, peaks);
}

Result<profile::Profile> read_profile(const fb::Profile& table) {
  if (table.point_count() > profile::k_max_profile_points) {
    return fail(Errc::ProtocolError, "profile of %u points", table.point_count());
  }
  if (table.flange() == nullptr) return fail(Errc::ProtocolError, "profile without a pose");
  profile::Profile profile;
  profile.header.sequence = table.profile_sequence();
  profile.header.frame_sequence = table.frame_sequence();
  profile.header.exposure_mid = SensorClock::time_point{Nanoseconds{table.exposure_mid_ns()}};
  BITELINE_ASSIGN(profile.header.T_base_flange, read_motion(*table.flange()));
  profile.header.pose_age = Nanoseconds{table.pose_age_ns()};
  profile.header.flags = table.flags();

  profile.points.resize(table.point_count());
  const std::span<ProfilePoint> points{profile.points};
  BITELINE_TRY(
      unpack_floats(table.x(), "x", points, [](ProfilePoint& p) -> float& { return p.point_cam.x(); }));
  BITELINE_TRY(
      unpack_floats(table.y(), "y", points, [](ProfilePoint& p) -> float& { return p.point_cam.y(); }));
  BITELINE_TRY(
      unpack_floats(table.z(), "z", points, [](ProfilePoint& p) -> float& { return p.point_cam.z(); }));
  BITELINE_TRY(unpack_floats(table.sigma_mm(), "sigma_mm", points,
                             [](ProfilePoint& p) -> float& { return p.sigma_mm; }));
  BITELINE_TRY(
      unpack_floats(table.row_px(), "row_px", points, [](ProfilePoint& p) -> float& { return p.row_px; }));
  BITELINE_TRY(unpack_floats(table.sigma_row_px(), "sigma_row_px", points,
                             [](ProfilePoint& p) -> float& { return p.sigma_row_px; }));
  BITELINE_TRY(unpack_floats(table.amplitude(), "amplitude", points,
                             [](ProfilePoint& p) -> float& { return p.amplitude; }));
  BITELINE_TRY(unpack_floats(table.width_px(), "width_px", points,
                             [](ProfilePoint& p) -> float& { return p.width_px; }));
  BITELINE_TRY(unpack_integers<std::uint16_t>(table.column(), k_counting, "column", points,
                                              [](ProfilePoint& p) -> std::uint16_t& { return p.column; }));
  BITELINE_TRY(unpack_integers<std::uint16_t>(table.point_flags(), k_constant, "point_flags", points,
                                              [](ProfilePoint& p) -> std::uint16_t& { return p.flags; }));
  BITELINE_TRY(unpack_integers<std::uint8_t>(table.peak_count(), k_constant, "peak_count", points,
                                             [](ProfilePoint& p) -> std::uint8_t& { return p.peak_count; }));
  return profile;
}

}  // namespace biteline::wire
