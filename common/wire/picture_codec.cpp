// SPDX-License-Identifier: MIT
#include "common/wire/picture_codec.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "common/core/numbers.hpp"
#include "common/wire/column_codec.hpp"
#include "common/wire/schema_parts.hpp"

namespace biteline::wire {
namespace {

/// Below this a scaled picture would show nothing.
constexpr int k_max_step = 64;

fb::Region pack_region(const geometry::Region& region) {
  return {region.offset_u_px, region.offset_v_px, region.width_px, region.height_px};
}

geometry::Region read_region(const fb::Region& region) {
  return {.offset_u_px = region.offset_u_px(),
          .offset_v_px = region.offset_v_px(),
          .width_px = region.width_px(),
          .height_px = region.height_px()};
}

}  // namespace

bool PictureWish::operator==(const PictureWish& other) const {
  const auto all = [](const PictureWish& wish) {
    const geometry::Region& part = wish.region;
    return std::tuple{wish.rate_hz,     wish.width_max_px, wish.format,   wish.quality,
                      part.offset_u_px, part.offset_v_px,  part.width_px, part.height_px};
  };
  return all(*this) == all(other);
}

bool is_rate(double rate_hz) {
  return NumberRange{.minimum = 0, .maximum = 1000}.holds(rate_hz);
}

flatbuffers::Offset<fb::PictureWish> pack_wish(flatbuffers::FlatBufferBuilder& fbb, const PictureWish& wish) {
  const fb::Region region = pack_region(wish.region);
  return fb::CreatePictureWish(fbb, static_cast<float>(wish.rate_hz), wish.width_max_px,
                               static_cast<fb::PictureFormat>(wish.format),
                               static_cast<std::uint8_t>(std::clamp(wish.quality, 0, 255)), &region);
}

Result<PictureWish> read_wish(const fb::PictureWish* table) {
  PictureWish wish;
  if (table == nullptr) return wish;
  if (!is_rate(table->rate_hz()))
    return fail(Errc::ProtocolError, "observer: a rate of pictures below 0 or beyond 1000 Hz");
  if (table->format() > fb::PictureFormat_MAX)
    return fail(Errc::ProtocolError, "observer: unknown format of pictures");
  if (table->width_max_px() < 1 || table->quality() < 1 || table->quality() > 100)
    return fail(Errc::ProtocolError, "observer: pictures 1 px wide at least, of quality 1 to 100 expected");
  wish.rate_hz = table->rate_hz();
  wish.width_max_px = table->width_max_px();
  wish.format = static_cast<PictureFormat>(table->format());
  wish.quality = table->quality();
  if (table->region() == nullptr) return wish;
  wish.region = read_region(*table->region());
  const bool everything = wish.region.width_px == 0 && wish.region.height_px == 0;
  if (!everything && !plausible(wish.region))
    return fail(Errc::ProtocolError, "observer: pictures of an impossible region");
  return wish;
}

flatbuffers::Offset<fb::Picture> pack_picture(flatbuffers::FlatBufferBuilder& fbb, const Picture& picture) {
  const std::span<const PicturePeak> peaks{picture.peaks};
  const auto pixels = fbb.CreateVector(picture.pixels);
  const auto u =
      pack_column(fbb, peaks, k_counting, [](const PicturePeak& p) { return std::uint32_t{p.u_px}; });
  const auto v = pack_floats(fbb, peaks, [](const PicturePeak& p) { return p.v_px; });
  const auto flags =
      pack_column(fbb, peaks, k_constant, [](const PicturePeak& p) { return std::uint32_t{p.flags}; });
  const fb::Region region = pack_region(picture.region);
  return fb::CreatePicture(
      fbb, picture.frame_sequence, picture.profile_sequence, picture.exposure_mid.time_since_epoch().count(),
      &region, static_cast<std::uint16_t>(picture.step), static_cast<fb::PictureFormat>(picture.format),
      pixels, static_cast<std::uint32_t>(peaks.size()), u, v, flags);
}

Result<Picture> read_picture(const fb::Picture& table) {
  if (table.region() == nullptr || table.pixels() == nullptr || table.format() > fb::PictureFormat_MAX)
    return fail(Errc::ProtocolError, "picture without region or pixels, or of unknown format");
  if (table.peak_count() > profile::k_max_profile_points)
    return fail(Errc::ProtocolError, "picture with %u peaks", table.peak_count());
  Picture picture;
  picture.frame_sequence = table.frame_sequence();
  picture.profile_sequence = table.profile_sequence();
  picture.exposure_mid = SensorClock::time_point{Nanoseconds{table.exposure_mid_ns()}};
  picture.region = read_region(*table.region());
  picture.step = table.step();
  picture.format = static_cast<PictureFormat>(table.format());
  if (!plausible(picture.region) || picture.step < 1 || picture.step > k_max_step || picture.width_px() < 1 ||
      picture.height_px() < 1) {
    return fail(Errc::ProtocolError, "picture with an impossible region or scale");
  }
  const std::size_t raw_bytes =
      static_cast<std::size_t>(picture.width_px()) * static_cast<std::size_t>(picture.height_px());
  if (picture.format == PictureFormat::Raw && table.pixels()->size() != raw_bytes)
    return fail(Errc::ProtocolError, "picture of %zu bytes instead of %zu",
                std::size_t{table.pixels()->size()}, raw_bytes);
  picture.pixels.assign(table.pixels()->begin(), table.pixels()->end());
  picture.peaks.resize(table.peak_count());
  const std::span<PicturePeak> peaks{picture.peaks};
  BITELINE_TRY(unpack_integers<std::uint16_t>(table.peak_u_px(), k_counting, "picture.u_px", peaks,
                                              [](PicturePeak& p) -> std::uint16_t& { return p.u_px; }));
  BITELINE_TRY(unpack_floats(table.peak_v_px(), "picture.v_px", peaks,
                             [](PicturePeak& p) -> float& { return p.v_px; }));
  BITELINE_TRY(unpack_integers<std::uint16_t>(table.peak_flags(), k_constant, "picture.flags", peaks,
                                              [](PicturePeak& p) -> std::uint16_t& { return p.flags; }));
  return picture;
}

}  // namespace biteline::wire
