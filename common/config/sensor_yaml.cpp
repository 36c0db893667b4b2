// SPDX-License-Identifier: MIT
#include "common/config/sensor_yaml.hpp"

#include <charconv>
#include <cmath>
#include <iterator>

#include "common/config/camera_state_yaml.hpp"
#include "common/config/yaml_reader.hpp"

namespace biteline::config {
namespace {

// A file written with nine decimals is off by 1e-9 per entry; 1e-4 still catches any matrix that is no
// rotation.
constexpr double k_rigid_tolerance = 1e-4;
// What was made exact once is left as it is: a file that is read and written again keeps its numbers to the
// last bit, and a replay its points.
constexpr double k_exact_tolerance = 1e-14;

SE3 read_rigid_motion(YamlReader& reader, const std::string& key) {
  const std::vector<double> values = reader.matrix(key, 4, 4, k_plausible_mm);
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
  const Mat3 R = matrix.topLeftCorner<3, 3>();
  const bool rigid =
      (R * R.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff() < k_rigid_tolerance &&
      R.determinant() > 0 &&
      (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() < k_rigid_tolerance;
  if (!rigid) {
    if (matrix != Eigen::Matrix4d::Zero())
      reader.fault(Errc::BadValue, key, "a rotation and a translation expected");
    return SE3::Identity();
  }
  SE3 T = SE3::Identity();
  T.linear() = R;
  T.translation() = matrix.topRightCorner<3, 1>();
  const bool exact = (R * R.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff() < k_exact_tolerance;
  return exact ? T : geometry::orthonormalised(T);
}

std::string number(double value) {
  // The fewest digits that read back as the same bits.
  char text[40];
  return {text, std::to_chars(std::begin(text), std::end(text), value).ptr};
}

}  // namespace

Result<geometry::SensorModel> read_sensor_yaml(const std::filesystem::path& path) {
  BITELINE_ASSIGN(YamlReader reader, YamlReader::open(path));
  geometry::SensorModel sensor;

  for (const char* descriptive : {"sensor_type", "comment"})
    static_cast<void>(reader.text_or(descriptive, ""));
  if (reader.text_or("camera_model", "pinhole") != "pinhole")
    reader.fault(Errc::NotSupported, "camera_model", "pinhole expected");
  if (reader.text_or("distortion_model", "radial-tangential") != "radial-tangential") {
    reader.fault(Errc::NotSupported, "distortion_model", "radial-tangential expected");
  }

  const std::vector<double> resolution = reader.numbers("resolution", 2);
  const std::vector<double> offset =
      reader.has("roi_offset")
          ? reader.numbers("roi_offset", 2)
          : (static_cast<void>(reader.text_or("roi_offset", "")), std::vector<double>{0, 0});
  // 16384: the largest line of any camera here, and far below what overflows a product of two.
  const auto pixels = [&](const std::vector<double>& pair, const char* key, int least, const char* expected) {
    const auto good = [&](double px) { return px == std::floor(px) && px >= least && px <= 16384; };
    if (good(pair[0]) && good(pair[1]))
      return std::pair{static_cast<int>(pair[0]), static_cast<int>(pair[1])};
    reader.fault(Errc::BadValue, key, expected);
    return std::pair{least, least};
  };
  const auto [width_px, height_px] =
      pixels(resolution, "resolution", 1, "two whole numbers from 1 to 16384 expected");
  const auto [offset_u_px, offset_v_px] =
      pixels(offset, "roi_offset", 0, "two whole numbers from 0 to 16384 expected");
  sensor.region = {
      .offset_u_px = offset_u_px, .offset_v_px = offset_v_px, .width_px = width_px, .height_px = height_px};

  // A focal length or an image centre beyond this many pixels is no camera's.
  const std::vector<double> intrinsics = reader.numbers("intrinsics", 4, {.minimum = -1e6, .maximum = 1e6});
  const std::vector<double> k =
      reader.numbers("distortion_coefficients", 5, {.minimum = -1e4, .maximum = 1e4});
  if (!(intrinsics[0] >= 1 && intrinsics[1] >= 1))
    reader.fault(Errc::BadValue, "intrinsics", "focal lengths of at least 1 px expected");
  sensor.camera = {.fu_px = intrinsics[0],
                   .fv_px = intrinsics[1],
                   .cu_px = intrinsics[2],
                   .cv_px = intrinsics[3],
                   .k1 = k[0],
                   .k2 = k[1],
                   .p1 = k[2],
                   .p2 = k[3],
                   .k3 = k[4]};

  const std::vector<double> plane = reader.numbers("laser_plane", 4, k_plausible_mm);
  const Vec3 normal_cam(plane[0], plane[1], plane[2]);
  if (!(std::abs(normal_cam.norm() - 1) <= k_rigid_tolerance)) {
    reader.fault(Errc::BadValue, "laser_plane", "a normal of unit length and a distance expected");
  } else if (std::abs(normal_cam.norm() - 1) <= k_exact_tolerance) {
    sensor.laser_plane = {.normal_cam = normal_cam, .distance_mm = plane[3]};
  } else {
    sensor.laser_plane = {.normal_cam = normal_cam.normalized(), .distance_mm = plane[3] / normal_cam.norm()};
  }
  sensor.T_flange_cam = read_rigid_motion(reader, "T_flange_cam");

  // An offset of more than an hour is two unrelated clocks, which nobody may interpolate across by mistake.
  constexpr double k_hour_ns = 3.6e12;
  // A session recorded for the clock's own calibration says that it does not know.
  if (reader.text_or("pose_clock_offset_ns", "unknown") != "unknown") {
    sensor.pose_clock_offset = Nanoseconds{
        reader.integer_or("pose_clock_offset_ns", 0, {.minimum = -k_hour_ns, .maximum = k_hour_ns})};
  }
  if (reader.has("rate_hz")) sensor.rate_hz = reader.number("rate_hz", {.minimum = 1e-3, .maximum = 1e5});
  if (reader.has("exposure_ns"))
    sensor.exposure = Nanoseconds{reader.integer("exposure_ns", {.minimum = 1, .maximum = 1e10})};
  static_cast<void>(reader.text_or("rate_hz", ""));
  static_cast<void>(reader.text_or("exposure_ns", ""));
  if (reader.has("speckle_contrast"))
    sensor.speckle_contrast = reader.number("speckle_contrast", {.minimum = 0, .maximum = 10});
  {
    YamlReader block = reader.child("camera_state", false);
    sensor.camera_state = read_camera_state(block);
  }
  BITELINE_TRY(reader.finish());
  return sensor;
}

std::string sensor_yaml_text(const geometry::SensorModel& sensor, const std::string& comment,
                             KnownParts known) {
  const geometry::Camera& camera = sensor.camera;
  const auto list = [](std::initializer_list<double> values) {
    std::string text = "[";
    for (const double value : values) text += (text.size() > 1 ? ", " : "") + number(value);
    return text + "]";
  };
  std::string text = "# Camera, laser plane and mounting of one scanner. Lengths in mm, angles in rad.\n";
  text += "sensor_type: camera\n";
  text += "comment: " + comment + "\n";
  text += "resolution: " + list({double(sensor.region.width_px), double(sensor.region.height_px)}) + "\n";
  text += "roi_offset: " + list({double(sensor.region.offset_u_px), double(sensor.region.offset_v_px)}) +
          "            # of this region in the full sensor; intrinsics below are for the full sensor\n";
  text += "camera_model: pinhole\n";
  text += "intrinsics: " + list({camera.fu_px, camera.fv_px, camera.cu_px, camera.cv_px}) +
          "   # fu, fv, cu, cv  [px]\n";
  text += "distortion_model: radial-tangential\n";
  text += "distortion_coefficients: " + list({camera.k1, camera.k2, camera.p1, camera.p2, camera.k3}) +
          "   # k1, k2, p1, p2, k3\n";
  const Vec3& n = sensor.laser_plane.normal_cam;
  if (known.laser_plane) {
    text += "laser_plane: " + list({n.x(), n.y(), n.z(), sensor.laser_plane.distance_mm}) +
            "     # n_x, n_y, n_z, d with n.X = d, camera frame, |n| = 1\n";
  }
  if (known.T_flange_cam)
    text += "T_flange_cam:                      # camera in the robot flange (hand-eye), row-major\n";
  for (int i = 0; known.T_flange_cam && i < 4; ++i) {
    const Eigen::Matrix4d& m = sensor.T_flange_cam.matrix();
    text += "  - " + list({m(i, 0), m(i, 1), m(i, 2), m(i, 3)}) + "\n";
  }
  text += "pose_clock_offset_ns: " + std::to_string(sensor.pose_clock_offset.count()) +
          "      # pose clock minus camera clock\n";
  if (sensor.rate_hz) text += "rate_hz: " + number(*sensor.rate_hz) + "\n";
  if (sensor.exposure) text += "exposure_ns: " + std::to_string(sensor.exposure->count()) + "\n";
  if (sensor.speckle_contrast) text += "speckle_contrast: " + number(*sensor.speckle_contrast) + "\n";
  if (sensor.camera_state.told())
    text += "camera_state:                      # what the camera does to its picture\n" +
            camera_state_text(sensor.camera_state, "  ");
  return text;
}

}  // namespace biteline::config
