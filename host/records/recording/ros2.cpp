// SPDX-License-Identifier: MIT
#include "host/records/recording/ros2.hpp"

#include <array>
#include <cstring>

#include "common/recording/cdr.hpp"

namespace biteline::recording::ros2 {
namespace {

constexpr double k_metres_a_mm = 1e-3;
constexpr const char* k_frame = "base";
constexpr std::uint8_t k_float32 = 7;  // of sensor_msgs/PointField

std::string part(const char* name, const char* definition) {
  return std::string(80, '=') + "\nMSG: " + name + "\n" + definition;
}

std::string header_parts() {
  return part("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n") +
         part("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
}

}  // namespace

std::string pose_schema() {
  return "std_msgs/Header header\nPose pose\n" + header_parts() +
         part("geometry_msgs/Pose", "Point position\nQuaternion orientation\n") +
         part("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n") +
         part("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
}

std::string points_schema() {
  return "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\n"
         "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n" +
         header_parts() +
         part("sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count\n");
}

std::vector<std::uint8_t> pose_message(std::int64_t camera_ns, const PoseRow& row) {
  CdrWriter out{128};
  out.put_header(camera_ns, k_frame);
  for (std::size_t i = 0; i < 3; ++i) out.put(row.values.at(i) * k_metres_a_mm);
  // The table has w first, ROS has it last.
  for (const std::size_t i : {4U, 5U, 6U, 3U}) out.put(row.values.at(i));
  return out.take();
}

std::vector<std::uint8_t> points_message(const profile::Profile& profile, const SE3& T_flange_cam) {
  constexpr std::array k_fields{"x", "y", "z", "intensity"};
  constexpr std::uint32_t k_step = k_fields.size() * sizeof(float);
  const SE3 T_base_cam = profile.header.T_base_flange * T_flange_cam;
  std::vector<std::uint8_t> data;
  data.reserve(profile.points.size() * k_step);
  for (const profile::ProfilePoint& point : profile.points) {
    if ((point.flags & profile::k_point_not_surface) != 0) continue;
    const Vec3 place_m = k_metres_a_mm * (T_base_cam * point.point_cam.cast<double>());
    const std::array values{static_cast<float>(place_m.x()), static_cast<float>(place_m.y()),
                            static_cast<float>(place_m.z()), point.amplitude};
    const std::size_t at = data.size();
    data.resize(at + k_step);
    std::memcpy(data.data() + at, values.data(), k_step);
  }
  CdrWriter out{data.size() + 256};
  out.put_header(profile.header.exposure_mid.time_since_epoch().count(), k_frame);
  out.put(std::uint32_t{1});
  out.put(static_cast<std::uint32_t>(data.size() / k_step));
  out.put(static_cast<std::uint32_t>(k_fields.size()));
  std::uint32_t offset = 0;
  for (const char* name : k_fields) {
    out.put_text(name);
    out.put(offset);
    out.put(k_float32);
    out.put(std::uint32_t{1});
    offset += sizeof(float);
  }
  out.put(std::uint8_t{0});  // little-endian
  out.put(k_step);
  out.put(static_cast<std::uint32_t>(data.size()));
  out.put_bytes(data);
  out.put(std::uint8_t{1});  // no point without a place
  return out.take();
}

}  // namespace biteline::recording::ros2
