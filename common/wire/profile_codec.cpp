// SPDX-License-Identifier: MIT
#include "common/wire/profile_codec.hpp"

#include "common/wire/column_codec.hpp"
#include "common/wire/schema_parts.hpp"

namespace biteline::wire {

using profile::ProfilePoint;

namespace {

/// One polarisation at rest has 1; few columns err.
constexpr NumberRange k_contrast{.minimum = 0, .maximum = 10};

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
                           x, y, z, sigma, row, sigma_row, amplitude, width, column, flags, peaks,
                           header.encoder_ticks, header.speckle_contrast);
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
  profile.header.encoder_ticks = table.encoder_ticks();
  profile.header.speckle_contrast = table.speckle_contrast();
  if (profile.header.speckle_contrast &&
      !k_contrast.holds(static_cast<double>(*profile.header.speckle_contrast)))
    return fail(Errc::ProtocolError, "impossible speckle contrast");

  profile.points.resize(table.point_count());
  const std::span<ProfilePoint> points{profile.points};
  BITELINE_TRY(unpack_floats(table.x(), "profile.x", points,
                             [](ProfilePoint& p) -> float& { return p.point_cam.x(); }));
  BITELINE_TRY(unpack_floats(table.y(), "profile.y", points,
                             [](ProfilePoint& p) -> float& { return p.point_cam.y(); }));
  BITELINE_TRY(unpack_floats(table.z(), "profile.z", points,
                             [](ProfilePoint& p) -> float& { return p.point_cam.z(); }));
  BITELINE_TRY(unpack_floats(table.sigma_mm(), "profile.sigma_mm", points,
                             [](ProfilePoint& p) -> float& { return p.sigma_mm; }));
  BITELINE_TRY(unpack_floats(table.row_px(), "profile.row_px", points,
                             [](ProfilePoint& p) -> float& { return p.row_px; }));
  BITELINE_TRY(unpack_floats(table.sigma_row_px(), "profile.sigma_row_px", points,
                             [](ProfilePoint& p) -> float& { return p.sigma_row_px; }));
  BITELINE_TRY(unpack_floats(table.amplitude(), "profile.amplitude", points,
                             [](ProfilePoint& p) -> float& { return p.amplitude; }));
  BITELINE_TRY(unpack_floats(table.width_px(), "profile.width_px", points,
                             [](ProfilePoint& p) -> float& { return p.width_px; }));
  BITELINE_TRY(unpack_integers<std::uint16_t>(table.column(), k_counting, "profile.column", points,
                                              [](ProfilePoint& p) -> std::uint16_t& { return p.column; }));
  BITELINE_TRY(unpack_integers<std::uint16_t>(table.point_flags(), k_constant, "profile.point_flags", points,
                                              [](ProfilePoint& p) -> std::uint16_t& { return p.flags; }));
  BITELINE_TRY(unpack_integers<std::uint8_t>(table.peak_count(), k_constant, "profile.peak_count", points,
                                             [](ProfilePoint& p) -> std::uint8_t& { return p.peak_count; }));
  return profile;
}

}  // namespace biteline::wire
