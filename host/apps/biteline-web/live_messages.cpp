// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/live_messages.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace biteline::web {
namespace {

static_assert(std::endian::native == std::endian::little, "the bytes are written as they lie in memory");

class Writer {
 public:
  Writer(LiveKind kind, std::size_t bytes) {
    bytes_.reserve(1 + bytes);
    bytes_ += static_cast<char>(kind);
  }
  template <class Number>
  void put(Number number) {
    std::array<char, sizeof number> raw;
    std::memcpy(raw.data(), &number, sizeof number);
    bytes_.append(raw.data(), raw.size());
  }
  void put(const Eigen::Vector3f& point) {
    for (const float value : point) put(value);
  }
  void put_bytes(std::span<const std::uint8_t> bytes) {
    bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  LiveBytes done() { return std::make_shared<const std::string>(std::move(bytes_)); }

 private:
  std::string bytes_;
};

/// Two marks stand above the low byte; the page knows them as clipped: evidence, no surface.
std::uint8_t page_flags(std::uint32_t flags) {
  const bool evidence = (flags & profile::k_point_not_surface) != 0;
  const std::uint32_t mark = evidence ? std::uint32_t{profile::k_point_clipped} : 0U;
  return static_cast<std::uint8_t>((flags & 0xFFU) | mark);
}

}  // namespace

LiveBytes picture_message(LiveStamp stamp, std::span<const std::uint8_t> jpeg) {
  Writer out{LiveKind::Picture, 12 + jpeg.size()};
  out.put(stamp.sequence);
  out.put(stamp.time_ns);
  out.put_bytes(jpeg);
  return out.done();
}

LiveBytes peaks_message(const wire::Picture& picture) {
  const std::size_t count = std::min(picture.peaks.size(), profile::k_max_profile_points);
  Writer out{LiveKind::Peaks, 16 + 7 * count};
  out.put(static_cast<std::uint32_t>(picture.frame_sequence));
  for (const int value : {picture.region.offset_u_px, picture.region.offset_v_px, picture.region.width_px,
                          picture.region.height_px, picture.step})
    out.put(static_cast<std::uint16_t>(value));
  out.put(static_cast<std::uint16_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const wire::PicturePeak& peak = picture.peaks[i];
    out.put(peak.u_px);
    out.put(peak.v_px);
    out.put(page_flags(peak.flags));
  }
  return out.done();
}

LiveBytes sensor_message(const std::string& json) {
  Writer out{LiveKind::Sensor, json.size()};
  out.put_bytes({reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
  return out.done();
}

LiveBytes profile_message(const profile::Profile& profile) {
  const std::size_t count = std::min(profile.points.size(), profile::k_max_profile_points);
  Writer out{LiveKind::Profile, 14 + 9 * count};
  out.put(static_cast<std::uint32_t>(profile.header.sequence));
  out.put(static_cast<std::uint64_t>(profile.header.exposure_mid.time_since_epoch().count()));
  out.put(static_cast<std::uint16_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const profile::ProfilePoint& point = profile.points[i];
    out.put(point.point_cam.x());
    out.put(point.point_cam.z());
    out.put(page_flags(point.flags));
  }
  return out.done();
}

LiveBytes cloud_message(std::uint32_t scan, std::span<const LivePoint> points) {
  Writer out{LiveKind::Cloud, 8 + 20 * points.size()};
  out.put(scan);
  out.put(static_cast<std::uint32_t>(points.size()));
  for (const LivePoint& point : points) {
    out.put(point.point_base);
    out.put(point.curvature_per_mm);
    out.put(point.sigma_mm);
  }
  return out.done();
}

LiveBytes line_message(const cloud::ClosedLine& line) {
  Writer out{LiveKind::Line, 4 + 20 * line.points.size()};
  out.put(static_cast<std::uint32_t>(line.points.size()));
  for (const cloud::LinePoint& point : line.points) {
    out.put(Eigen::Vector3f{point.position.cast<float>()});
    out.put(static_cast<float>(point.confidence));
    out.put(static_cast<float>(point.u95_mm.value_or(std::numeric_limits<double>::quiet_NaN())));
  }
  return out.done();
}

LiveBytes arm_message(const ArmPlace& place) {
  Writer out{LiveKind::Arm, 80};
  out.put(place.time_s);
  for (const double joint_rad : place.joints_rad) out.put(joint_rad);
  for (const double value_mm : place.tip_base_mm) out.put(value_mm);
  return out.done();
}

}  // namespace biteline::web
