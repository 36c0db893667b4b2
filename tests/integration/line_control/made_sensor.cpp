// SPDX-License-Identifier: MIT
// A sensor without devices: each StartScan makes one scan of a flat plate.  Tells its address, then each
// start.
//
//     biteline-made-sensor [no-poses|busy|refuses|slow]
//
// no-poses: no profile has a pose; busy: most were dropped before they were sent; refuses: no scan begins;
// slow: four seconds a scan.
#include <cstdio>
#include <string_view>

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

Result<test::ScanServer> plate_server(std::uint32_t flags) {
  test::ScanServer server{.identity = {}, .make = [flags](std::uint64_t) {
                            std::vector<profile::Profile> profiles;
                            const SensorClock::time_point begin = test::now_of_sensor();
                            for (std::uint64_t k = 0; k < k_profiles; ++k) {
                              profiles.push_back(line_of_plate(k, begin + std::chrono::milliseconds{k}));
                              profiles.back().header.flags |= flags;
                            }
                            return profiles;
                          }};
  server.identity.name = "plate";
  server.identity.simulated = true;
  server.identity.model.region = {.offset_u_px = 0, .offset_v_px = 0, .width_px = k_points, .height_px = 1};
  return server;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view fault{argc > 1 ? argv[1] : ""};
  if (argc > 2 ||
      (argc == 2 && fault != "no-poses" && fault != "busy" && fault != "refuses" && fault != "slow")) {
    std::fprintf(stderr, "usage: biteline-made-sensor [no-poses|busy|refuses|slow]\n");
    return 2;
  }
  return biteline::test::run_scan_server("biteline-made-sensor", [fault]() -> Result<test::ScanServer> {
    BITELINE_ASSIGN(test::ScanServer server,
                    plate_server(fault == "no-poses" ? profile::k_profile_pose_missing : 0U));
    if (fault == "busy") server.profiles_dropped = 10 * k_profiles;
    if (fault == "slow") server.between_profiles = std::chrono::milliseconds{100};
    if (fault == "refuses") server.refuses = "no camera answers";
    return server;
  });
}
