// SPDX-License-Identifier: MIT
// A sensor without devices: each StartScan makes one scan of a shoe on its table, by an elastic arm with a
// check lap.  After so many sound ones, or at SIGUSR1, its head has slipped on the flange by 0.1 mm, the shoe
// was nudged by 0.3 mm, another shoe stands there, or three tenths of its line shine; and nobody told it.
//
//     biteline-drifting-sensor SOUND [slipped|nudged|exchanged|shining]
#include <charconv>
#include <csignal>
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

volatile std::sig_atomic_t g_told = 0;

Result<Looks> changed(const test::DriftCell& cell, std::string_view how) {
  constexpr int k_mounting_y = 7;
  if (how == "slipped") return cell.looks({.drifted = drift::Vector::Unit(k_mounting_y)});
  if (how == "nudged") {
    constexpr double k_each_mm = 0.3 / 1.4142135623730951;
    return cell.looks(
        {.T_shoe_put = geometry::make_se3(Eigen::Quaterniond::Identity(), {k_each_mm, k_each_mm, 0})});
  }
  if (how == "shining") return cell.looks({.shining_ratio = 0.3});
  if (how != "exchanged")
    return fail(Errc::InvalidArgument, "%.20s: neither slipped, nudged, exchanged nor shining",
                std::string{how}.c_str());
  BITELINE_ASSIGN(const test::DriftCell other,
                  test::DriftCell::make({.shoe_seed = 2, .fan_rays = k_fan_rays}));
  return other.looks({});
}

Result<test::ScanServer> changing_after(std::uint64_t sound, std::string_view how) {
  BITELINE_ASSIGN(const test::DriftCell cell, test::DriftCell::make({.fan_rays = k_fan_rays}));
  const Looks straight = cell.looks({});
  BITELINE_ASSIGN(const Looks after, changed(cell, how));
  const geometry::SensorModel& head = cell.calibrated();
  test::ScanServer server{.identity = {},
                          .make =
                              [=](std::uint64_t scan) {
                                const bool sees_it = scan > sound || g_told != 0;
                                return profiles_of(cell.scan(sees_it ? after : straight, {.seed = scan}),
                                                   head);
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
  const std::string_view text{argc == 2 || argc == 3 ? argv[1] : ""};
  if (std::from_chars(text.begin(), text.end(), sound).ec != std::errc{}) {
    std::fprintf(stderr, "usage: biteline-drifting-sensor SOUND [slipped|nudged|exchanged|shining]\n");
    return 2;
  }
  const std::string_view how{argc == 3 ? argv[2] : "slipped"};
  std::signal(SIGUSR1, [](int) { g_told = 1; });
  return biteline::test::run_scan_server("biteline-drifting-sensor",
                                         [=] { return changing_after(sound, how); });
}
