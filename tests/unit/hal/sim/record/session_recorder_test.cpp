// SPDX-License-Identifier: MIT
#include "hal/sim/record/session_recorder.hpp"

#include <CppUTest/TestHarness.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "common/image/grey_image.hpp"
#include "common/session/session.hpp"
#include "hal/sim/shoe/surface_distance.hpp"

namespace biteline::sim {

namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name)
      : path_(fs::temp_directory_path() / ("biteline-" + name + "-" + std::to_string(getpid()))) {
    fs::remove_all(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// A coarse scan of some ten pictures.
SceneSettings quick_scene(ShoeClass shoe_class) {
  return {.shoe = draw_shoe(shoe_class, 4),
          .scan_speed_mm_s = 1000,
          .rate_hz = 15,
          .fineness = {.column_mm = 1.5, .coarse_row_mm = 0.5}};
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

SE3 pose_at(const session::Session& session, SensorClock::time_point instant) {
  const auto after = std::find_if(session.poses.begin(), session.poses.end(), [&](const auto& pose) {
    return to_sensor_clock(pose.stamp, session.sensor.pose_clock_offset) >= instant;
  });
  const auto before = after - 1;
  const auto stamp = [&](const auto& pose) {
    return to_sensor_clock(pose.stamp, session.sensor.pose_clock_offset);
  };
  const double part = static_cast<double>((instant - stamp(*before)).count()) /
                      static_cast<double>((stamp(*after) - stamp(*before)).count());
  return geometry::interpolate(before->T_base_flange, after->T_base_flange, part);
}

/// Centre of gravity of a column's light, nothing where it is dark.
std::optional<double> centre_px(const image::GreyImage& picture, int column) {
  double sum = 0, moment = 0;
  for (int row = 0; row < picture.height_px; ++row) {
    const double value = picture.at(column, row);
    if (value < 6) continue;
    sum += value;
    moment += value * row;
  }
  if (sum < 300) return std::nullopt;
  return moment / sum;
}

/// What the session shows of the shoe's wall, in the shoe's frame.
std::vector<Vec3> wall_points(const fs::path& folder, const MadeScene& scene) {
  const auto session = *session::read_session(folder);
  std::vector<Vec3> points;
  for (const auto& frame : session.frames) {
    const auto picture = *image::read_png(frame.file);
    const SE3 T_shoe_cam =
        scene.T_base_shoe.inverse() * pose_at(session, frame.exposure_mid) * session.sensor.T_flange_cam;
    for (int column = 0; column < picture.width_px; column += 7) {
      const auto row_px = centre_px(picture, column);
      if (!row_px) continue;
      const Vec2 pixel_px(column + session.sensor.region.offset_u_px,
                          *row_px + session.sensor.region.offset_v_px);
      const Vec3 point =
          T_shoe_cam * geometry::triangulate(session.sensor.camera, session.sensor.laser_plane, pixel_px);
      if (point.z() > 1 && point.z() < scene.settings.shoe.upper.top_z_mm - 2) points.push_back(point);
    }
  }
  return points;
}

/// Root mean square distance from the shoe's wall of everything the session shows.
double cloud_rms_mm(const fs::path& folder, const MadeScene& scene) {
  const SurfaceDistance distance(scene.shoe);
  const std::vector<Vec3> points = wall_points(folder, scene);
  double square_sum = 0;
  for (const Vec3& point : points) {
    const double error_mm = std::clamp(distance.signed_distance_mm(point), -0.5, 0.5);
    square_sum += error_mm * error_mm;
  }
  CHECK(points.size() > 800);
  return std::sqrt(square_sum / static_cast<double>(points.size()));
}

}  // namespace

TEST_GROUP(SessionRecorder){};

TEST(SessionRecorder, ASessionReadBackAndTriangulatedLiesOnTheShoe) {
  const TemporaryFolder lamp("lamp"), laser("laser");
  SceneSettings settings = quick_scene(ShoeClass::Deep);
  settings.light.coherent = false;
  const auto scene = *make_scene(settings);
  CHECK(record_session(lamp.path(), *scene, {}, {}).has_value());
  // Poses 0.010 mm in each direction, turned by 0.003 degrees at 480 mm; peaks by a plain centre of gravity
  // 0.01 to 0.02 mm, worse on the groove's walls; facets of 1.5 mm at the toe's radius 0.01 mm; poses 2 ms
  // apart at ten times the usual speed.
  CHECK(cloud_rms_mm(lamp.path(), *scene) < 0.03);
  // A laser's speckle adds 0.030 mm at f/5.6 (optics::stripe_noise), along the laser plane.
  settings.light.coherent = true;
  const auto speckled = *make_scene(settings);
  CHECK(record_session(laser.path(), *speckled, {}, {}).has_value());
  CHECK(cloud_rms_mm(laser.path(), *speckled) < std::hypot(0.03, 0.03));
}

TEST(SessionRecorder, AClockOffsetThatIsNotToldSpoilsTheCloudAndOneThatIsToldDoesNot) {
  const TemporaryFolder told("told"), hidden("hidden");
  // By a lamp's light: 0.05 mm of clock would hardly show beside a laser's speckle.
  SceneSettings settings = quick_scene(ShoeClass::Deep);
  settings.light.coherent = false;
  const auto scene = *make_scene(settings);
  constexpr Nanoseconds k_offset{3'700'000};
  CHECK(record_session(told.path(), *scene, {.pose_clock_offset = k_offset, .tell_clock_offset = true}, {})
            .has_value());
  CHECK(record_session(hidden.path(), *scene, {.pose_clock_offset = k_offset, .tell_clock_offset = false}, {})
            .has_value());
  CHECK(cloud_rms_mm(hidden.path(), *scene) > 2 * cloud_rms_mm(told.path(), *scene));
}

TEST(SessionRecorder, SameSeedSameFiles) {
  const TemporaryFolder first("first"), second("second");
  for (const auto* folder : {&first, &second}) {
    CHECK(record_session(folder->path(), **make_scene(quick_scene(ShoeClass::Glossy)), {}, {}).has_value());
  }
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(first.path())) {
    if (!entry.is_regular_file()) continue;
    ++files;
    CHECK(bytes_of(entry.path()) == bytes_of(second.path() / fs::relative(entry.path(), first.path())));
  }
  CHECK(files > 10);
}

TEST(SessionRecorder, APartShowsThatPartAloneAndItsTruthIsTheSurfaceThere) {
  const TemporaryFolder folder("part"), nowhere("nowhere");
  SceneSettings settings = quick_scene(ShoeClass::Deep);
  settings.scan_speed_mm_s = 100;
  settings.rate_hz = 50;
  const auto scene = *make_scene(settings);
  const OutlinePart part{.from_s_mm = 100, .length_mm = 6};
  CHECK(record_session(folder.path(), *scene, {.part = part}, {}).has_value());
  const auto session = *session::read_session(folder.path());
  LONGS_EQUAL(3, session.frames.size());  // 2 mm apart

  const auto place = [&](double s_mm) { return scene->shoe.section(s_mm).place(); };
  const Vec2 along = place(103).point;
  for (const Vec3& point : wall_points(folder.path(), *scene))
    CHECK((point.head<2>() - along).norm() < part.length_mm / 2 + 15);  // the wall stands out by some 10 mm
  const auto bytes = [](const fs::path& file) { return static_cast<double>(fs::file_size(file)); };
  const MeshFineness& fineness = settings.fineness;
  const SurfaceMesh strip = mesh_of_part(scene->shoe, {.from_s_mm = 97, .length_mm = 12}, fineness);
  CHECK(strip.vertices.size() < scene->mesh.vertices.size() / 10);
  CHECK(bytes(folder.path() / "truth/reference.ply") > 12.0 * static_cast<double>(strip.vertices.size()));
  const SurfaceDistance distance(scene->shoe);
  for (std::size_t i = 0; i < strip.vertices.size(); i += 97) {
    const Vec3 vertex(strip.vertices[i][0], strip.vertices[i][1], strip.vertices[i][2]);
    if (vertex.z() > 1 && vertex.z() < settings.shoe.upper.top_z_mm - 1)
      DOUBLES_EQUAL(0, distance.signed_distance_mm(vertex), 1e-3);
  }

  CHECK_FALSE(record_session(nowhere.path(), *scene, {.part = OutlinePart{1900, 6}}, {}).has_value());
}

TEST(SessionRecorder, ABareUpperHasNoTrueLineOfItsOwn) {
  const TemporaryFolder folder("bare");
  const auto scene = *make_scene(quick_scene(ShoeClass::Bare));
  CHECK(write_truth(folder.path(), *scene).has_value());
  CHECK_FALSE(fs::exists(folder.path() / "groove.csv"));
  CHECK(fs::exists(folder.path() / "T_base_shoe.txt"));
}

TEST(SessionRecorder, WithoutATriggerTheSamePicturesAreStampedWhenTheyCome) {
  const auto scene = make_scene(quick_scene(ShoeClass::Deep));
  CHECK(scene.has_value());
  const TemporaryFolder triggered("triggered"), free("free");
  CHECK(record_session(triggered.path(), **scene, {}, {}).has_value());
  const ArrivalStamps arrival{.jitter_ms = 2};
  CHECK(record_session(free.path(), **scene, {.arrival = arrival}, {}).has_value());
  const auto exact = session::read_session(triggered.path()), late = session::read_session(free.path());
  CHECK(exact.has_value() && late.has_value());
  LONGS_EQUAL(exact->frames.size(), late->frames.size());
  std::vector<SensorClock::time_point> mids;
  for (const session::FrameEntry& frame : exact->frames) mids.push_back(frame.exposure_mid);
  const auto stamps = arrival_stamps(mids, arrival, RecordSettings{}.noise_seed);
  for (std::size_t i = 0; i < mids.size(); ++i) {
    CHECK(late->frames[i].exposure_mid == stamps[i]);
    CHECK(stamps[i] != mids[i]);
    CHECK(bytes_of(exact->frames[i].file) == bytes_of(late->frames[i].file));
  }
}

}  // namespace biteline::sim
