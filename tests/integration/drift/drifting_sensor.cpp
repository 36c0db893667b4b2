// SPDX-License-Identifier: MIT
// A sensor without devices: each StartScan makes one scan of a shoe on its table, by an elastic arm with a
// check lap.  After so many sound ones its head has slipped on the flange by 0.1 mm, and nobody told it.
//
//     biteline-drifting-sensor SOUND
#include <charconv>
#include <cstdio>
#include <string_view>

#include "tests/support/drift_scan.hpp"
#include "tests/support/scan_server.hpp"

namespace {

using namespace biteline;
using Looks = std::vector<test::DriftCell::Look>;

/// As close as a camera's columns, so that a path along the line is smooth.
constexpr int k_fan_rays = 1500;

/// What a scan sends, one after the other.
std::vector<profile::Profile> profiles_of(const test::DriftScan& scan, const geometry::SensorModel& head) {
  std::vector<profile::Profile> profiles;
  const SensorClock::time_point begin = test::now_of_sensor();
  std::size_t point = 0;
  for (const drift::PosedProfile& posed : scan.poses) {
    profile::Profile made;
    made.header.sequence = made.header.frame_sequence = posed.profile;
    made.header.exposure_mid = begin + Nanoseconds{static_cast<std::int64_t>(1e9 * posed.pose.time_s)};
    made.header.T_base_flange = posed.pose.T_base_flange;
    const SE3 T_cam_base = (posed.pose.T_base_flange * head.T_flange_cam).inverse(Eigen::Isometry);
    for (std::uint16_t column = 0; point < scan.profile.size() && scan.profile[point] == posed.profile;
         ++point, ++column) {
      profile::ProfilePoint seen;
      seen.point_cam = (T_cam_base * scan.points_base[point].cast<double>()).cast<float>();
      seen.sigma_mm = 0.01F;
      seen.column = column;
      seen.peak_count = 1;
      made.points.push_back(seen);
    }
    profiles.push_back(std::move(made));
  }
  return profiles;
}

Result<test::ScanServer> slipping_after(std::uint64_t sound) {
  BITELINE_ASSIGN(const test::DriftCell cell, test::DriftCell::make({.fan_rays = k_fan_rays}));
  constexpr int k_mounting_y = 7;
  const Looks straight = cell.looks({}), slipped = cell.looks({.drifted = drift::Vector::Unit(k_mounting_y)});
  const geometry::SensorModel& head = cell.calibrated();
  test::ScanServer server{.identity = {},
                          .make =
                              [=](std::uint64_t scan) {
                                return profiles_of(
                                    cell.scan(scan > sound ? slipped : straight, {.seed = scan}), head);
                              },
                          .between_profiles = std::chrono::milliseconds{1}};
  server.identity.name = "drifting";
  server.identity.simulated = true;
  server.identity.model = head;
  return server;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t sound = 0;
  const std::string_view text{argc == 2 ? argv[1] : ""};
  if (std::from_chars(text.begin(), text.end(), sound).ec != std::errc{}) {
    std::fprintf(stderr, "usage: biteline-drifting-sensor SOUND\n");
    return 2;
  }
  return biteline::test::run_scan_server("biteline-drifting-sensor",
                                         [sound] { return slipping_after(sound); });
}
