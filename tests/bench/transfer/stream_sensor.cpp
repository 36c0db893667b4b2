// SPDX-License-Identifier: MIT
// A sensor without devices: each StartScan makes one scan of the next upper of a stream (stream_shoes.hpp).
//
//     bench_stream_sensor SEED MODELS LIBRARY TRUTH
//
// It teaches the LIBRARY first.  Into TRUTH it writes before each scan what comes: shoe-N.json, and its true
// line, shoe-N.csv.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "tests/bench/transfer/stream_shoes.hpp"
#include "tests/support/scan_server.hpp"

namespace {

using namespace biteline;

/// Of the stripe's middle to the camera, as sim::ScanSettings has it.
constexpr double k_camera_distance_mm = 141, k_camera_above_mm = 55;

/// A head that looks at the middle of these points from outside.
SE3 camera_before(const Vec3& middle, const Vec3& shoe) {
  const Vec3 out = Vec3{middle.x() - shoe.x(), middle.y() - shoe.y(), 0}.normalized();
  const Vec3 at = middle + k_camera_distance_mm * out + k_camera_above_mm * Vec3::UnitZ();
  Mat3 axes;
  axes.col(2) = (middle - at).normalized();
  axes.col(0) = axes.col(2).cross(Vec3::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  SE3 T_base_cam = SE3::Identity();
  T_base_cam.linear() = axes;
  T_base_cam.translation() = at;
  return T_base_cam;
}

std::vector<profile::Profile> profiles_of(const cloud::PointCloud& cloud) {
  Vec3 shoe = Vec3::Zero();
  for (const Eigen::Vector3f& point : cloud.points) shoe += point.cast<double>();
  shoe /= static_cast<double>(cloud.size());
  std::vector<profile::Profile> profiles;
  const SensorClock::time_point begin = test::now_of_sensor();
  for (std::size_t first = 0; first < cloud.size();) {
    std::size_t last = first;
    Vec3 middle = Vec3::Zero();
    for (; last < cloud.size() && cloud.profile[last] == cloud.profile[first]; ++last)
      middle += cloud.points[last].cast<double>();
    const SE3 T_base_cam = camera_before(middle / static_cast<double>(last - first), shoe);
    const SE3 T_cam_base = T_base_cam.inverse(Eigen::Isometry);
    profile::Profile made;
    made.header.sequence = made.header.frame_sequence = cloud.profile[first];
    made.header.exposure_mid = begin + std::chrono::milliseconds{10} * cloud.profile[first];
    made.header.T_base_flange = T_base_cam;
    for (; first < last; ++first) {
      profile::ProfilePoint seen;
      seen.point_cam = (T_cam_base * cloud.points[first].cast<double>()).cast<float>();
      seen.sigma_mm = cloud.sigma_mm.empty() ? 0.015F : cloud.sigma_mm[first];
      seen.column = cloud.column[first];
      seen.peak_count = 1;
      made.points.push_back(seen);
    }
    profiles.push_back(std::move(made));
  }
  return profiles;
}

void tell(const std::filesystem::path& truth, std::uint64_t scan, const bench::StreamShoe& shoe,
          const cloud::ClosedLine& line) {
  const std::string name = "shoe-" + std::to_string(scan);
  std::ofstream csv{truth / (name + ".csv")};
  for (const cloud::LinePoint& point : line.points)
    csv << point.position.x() << ' ' << point.position.y() << ' ' << point.position.z() << '\n';
  const nlohmann::json told{
      {"model", shoe.name},
      {"foot", shoe.foot()},
      {"size", bench::size_text(shoe.size)},
      {"order_is_wrong", shoe.order_is_wrong},
      {"order", {{"model", shoe.order.model}, {"foot", shoe.order.foot}, {"size", shoe.order.size}}}};
  std::ofstream{truth / (name + ".part")} << told.dump();
  // Whoever waits for it finds it whole.
  std::filesystem::rename(truth / (name + ".part"), truth / (name + ".json"));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: bench_stream_sensor SEED MODELS LIBRARY TRUTH\n");
    return 2;
  }
  const std::uint64_t seed = std::strtoull(argv[1], nullptr, 10);
  const auto stream = std::make_shared<bench::ShoeStream>(seed, std::atoi(argv[2]));
  const std::filesystem::path truth{argv[4]};
  if (!stream->teach(transfer::Library{argv[3]})) return 1;
  const auto draw = [stream, seed, truth](std::uint64_t scan) {
    const bench::StreamShoe shoe = stream->next();
    const transfer::SampleFiles upper = bench::ShoeStream::upper_of(shoe, seed + 999 + scan);
    tell(truth, scan, shoe, upper.line);
    return profiles_of(upper.cloud);
  };
  // An order is said before its scan: each shoe is drawn before it is asked for.
  const auto next = std::make_shared<std::vector<profile::Profile>>(draw(1));
  return test::run_scan_server("bench_stream_sensor", [&]() -> Result<test::ScanServer> {
    test::ScanServer server{.identity = {},
                            .make =
                                [next, draw](std::uint64_t scan) {
                                  std::vector<profile::Profile> now = std::move(*next);
                                  *next = draw(scan + 1);
                                  return now;
                                },
                            .between_profiles = std::chrono::milliseconds{1}};
    server.identity.name = "stream";
    server.identity.simulated = true;
    server.identity.model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = 2048, .height_px = 1088};
    return server;
  });
}
