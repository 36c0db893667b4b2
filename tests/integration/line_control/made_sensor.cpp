// SPDX-License-Identifier: MIT
// A sensor without devices: each StartScan makes one scan of a flat plate.  Tells its address, then each
// start.
#include "tests/support/scan_server.hpp"

namespace {

using namespace biteline;

constexpr std::uint64_t k_profiles = 40;
constexpr int k_points = 60;

profile::Profile line_of_plate(std::uint64_t sequence, SensorClock::time_point at) {
  profile::Profile profile;
  profile.header.sequence = profile.header.frame_sequence = sequence;
  profile.header.exposure_mid = at;
  profile.header.T_base_flange =
      geometry::make_se3(Eigen::Quaterniond::Identity(), {0, static_cast<double>(sequence), 0});
  for (int i = 0; i < k_points; ++i) {
    profile::ProfilePoint point;
    point.point_cam = {static_cast<float>(i), 0, 300};
    point.sigma_mm = 0.02F;
    point.column = static_cast<std::uint16_t>(i);
    point.peak_count = 1;
    profile.points.push_back(point);
  }
  return profile;
}

Result<test::ScanServer> plate_server() {
  test::ScanServer server{.identity = {}, .make = [](std::uint64_t) {
                            std::vector<profile::Profile> profiles;
                            const SensorClock::time_point begin = test::now_of_sensor();
                            for (std::uint64_t k = 0; k < k_profiles; ++k)
                              profiles.push_back(line_of_plate(k, begin + std::chrono::milliseconds{k}));
                            return profiles;
                          }};
  server.identity.name = "plate";
  server.identity.simulated = true;
  server.identity.model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = k_points, .height_px = 1};
  return server;
}

}  // namespace

int main() {
  return biteline::test::run_scan_server("biteline-made-sensor", plate_server);
}
