// SPDX-License-Identifier: MIT
// Registration of two clouds of 100 000 points, of which one lacks a part, beside PCL, Open3D and small_gicp:
// speed on one thread and error; mesh and rays beside Embree; the whole transfer of an upper, to the line and
// to the path.
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <random>
#include <string>

#include "host/bite_line/evaluation/reference_surface.hpp"
#include "host/cloud/ply.hpp"
#include "host/robot/path/plan.hpp"
#include "host/transfer/align/icp.hpp"
#include "host/transfer/carry/scan_mesh.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/bench/transfer/peers.hpp"
#include "tests/support/made_pair.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline::bench {
namespace {

constexpr int k_rounds = 5;
// The product's own, and a finer one; the peers' voxels are 2 mm, as in their published figures.
constexpr float k_shipped_pitch_mm = 2, k_fine_pitch_mm = 1.5F;

void row(const char* bench, const std::string& what, double ours, const char* unit, const char* peer,
         double peer_value, double target) {
  std::printf("{\"bench\":\"%s\",\"what\":\"%s\",\"ours\":%.4g,\"unit\":\"%s\"", bench, what.c_str(), ours,
              unit);
  if (peer != nullptr)
    std::printf(",\"peer\":\"%s\",\"peer_value\":%.4g,\"ratio\":%.4g", peer, peer_value, ours / peer_value);
  if (target > 0) std::printf(",\"target\":%g", target);
  std::printf("}\n");
}

/// Least of some rounds.  One thread's own time where `thread_only`: what else runs on the machine does not
/// count.
template <class Work>
double seconds(bool thread_only, Work&& work) {
  const auto now = [&] {
    timespec t{};
    clock_gettime(thread_only ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  double best = 1e9;
  for (int round = 0; round < k_rounds; ++round) {
    const double begin = now();
    work();
    best = std::min(best, now() - begin);
  }
  return best;
}

std::vector<Eigen::Vector3f> subset(std::vector<Eigen::Vector3f> points, std::size_t count,
                                    std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::shuffle(points.begin(), points.end(), random);
  points.resize(std::min(count, points.size()));
  return points;
}

struct Error {
  double mm, deg;
};

Error error_of(const SE3& T_found, const SE3& T_true, const Vec3& centre) {
  return {.mm = (T_found * centre - T_true * centre).norm(),
          .deg = geometry::angle_between_rad(T_found.linear(), T_true.linear()) * 57.29577951308232};
}

SE3 our_align(std::span<const Eigen::Vector3f> source_points, std::span<const Eigen::Vector3f> target_points,
              float pitch_mm) {
  using namespace transfer;
  const Surfels source = surfels_of(source_points, pitch_mm), target = surfels_of(target_points, pitch_mm);
  const Surfels source_coarse = coarsened(source, 8), target_coarse = coarsened(target, 8);
  const NearestTable coarse_table{target_coarse, 30}, table{target, 5};
  const IcpResult coarse =
      run_icp({.source = source_coarse, .target = target_coarse, .target_table = coarse_table}, {},
              {.reach_mm = 30, .least_scale_mm = 0.5, .max_iterations = 20});
  return run_icp({.source = source, .target = target, .target_table = table}, coarse.placement,
                 {.reach_mm = 5})
      .placement.T_target_source;
}

/// Points of the same surface, 100 000 of each at most; the source lacks a part of its length.
struct Halves {
  std::string name;
  std::vector<Eigen::Vector3f> source, target;
};

/// The halves of a cloud share no point, and each point has a noise of its own.
Halves halves_of(const std::string& name, std::vector<Eigen::Vector3f> points) {
  constexpr float k_noise_mm = 0.02F, k_missing_share = 0.2F;
  std::mt19937_64 random{3};
  std::normal_distribution<float> noise{0, k_noise_mm};
  std::shuffle(points.begin(), points.end(), random);
  float low = points.front().x(), high = low;
  for (Eigen::Vector3f& p : points) {
    p += Eigen::Vector3f{noise(random), noise(random), noise(random)};
    low = std::min(low, p.x());
    high = std::max(high, p.x());
  }
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::vector<Eigen::Vector3f> source{points.begin(), middle};
  std::erase_if(source,
                [&](const Eigen::Vector3f& p) { return p.x() < low + k_missing_share * (high - low); });
  return {.name = name,
          .source = subset(std::move(source), 100'000, 2),
          .target = subset({middle, points.end()}, 100'000, 1)};
}

Halves made_halves() {
  const sim::ShoeParameters shoe = sim::draw_shoe(sim::ShoeClass::Stitched, 5);
  const sim::ScanSettings first{.seed = 1}, second{.profile_step_mm = 0.9, .seed = 2};
  std::vector<Eigen::Vector3f> all = test::scanned(shoe, SE3::Identity(), second).points;
  std::erase_if(all, [](const Eigen::Vector3f& p) { return p.x() < 60; });
  return {.name = "made shoe",
          .source = subset(std::move(all), 100'000, 2),
          .target = subset(test::scanned(shoe, SE3::Identity(), first).points, 100'000, 1)};
}

/// `halves.source` lies 8 mm and 6 degrees off.
void registration_rows(Halves halves) {
  Twist xi;
  xi << 5, -5, 3, 0.03, -0.02, 0.09;
  Vec3 centre = Vec3::Zero();
  for (const Eigen::Vector3f& p : halves.source)
    centre += p.cast<double>() / static_cast<double>(halves.source.size());
  // Turned about its own middle: clouds of other hands lie anywhere.
  SE3 T_middle = SE3::Identity();
  T_middle.translation() = centre;
  const SE3 T_target_source = T_middle * geometry::exp_se3(xi) * T_middle.inverse();
  centre = T_target_source.inverse() * centre;
  for (Eigen::Vector3f& p : halves.source) p = (T_target_source.inverse() * p.cast<double>()).cast<float>();

  const tbb::global_control one_thread{tbb::global_control::max_allowed_parallelism, 1};
  const std::string what = halves.name + ", 2 x 100 000 points, a part missing, one thread";
  for (const float pitch_mm : {k_shipped_pitch_mm, k_fine_pitch_mm}) {
    SE3 T_ours, T_peer;
    const double ours_s = seconds(true, [&] { T_ours = our_align(halves.source, halves.target, pitch_mm); });
    const Error ours = error_of(T_ours, T_target_source, centre);
    char pitch[40];
    std::snprintf(pitch, sizeof pitch, ", surfels of %.1f mm", static_cast<double>(pitch_mm));
    const auto beside = [&](const char* peer, double peer_s) {
      const Error error = error_of(T_peer, T_target_source, centre);
      row("registration.speed", what + pitch + ", the peer's voxels of 2 mm", ours_s, "s", peer, peer_s, 0.5);
      row("registration.translation", halves.name + pitch + ", error at the centre", ours.mm, "mm", peer,
          error.mm, 1);
      row("registration.rotation", halves.name + pitch, ours.deg, "deg", peer, error.deg, 1);
    };
    const peers::Problem problem{.source = halves.source, .target = halves.target};
    if (peers::has_pcl()) {
      const double pcl_s = seconds(true, [&] { T_peer = peers::pcl_align(problem); });
      beside("PCL", pcl_s);
    }
    if (peers::has_open3d()) {
      const double open3d_s = seconds(true, [&] { T_peer = peers::open3d_align(problem); });
      beside("Open3D", open3d_s);
    }
    if (peers::has_small_gicp()) {
      const double small_gicp_s = seconds(true, [&] { T_peer = peers::small_gicp_align(problem); });
      beside("small_gicp", small_gicp_s);
    }
    if (!peers::has_pcl() && !peers::has_open3d() && !peers::has_small_gicp())
      row("registration.speed", what + pitch + "; no peer in this build (BITELINE_SMALL_GICP, a checkout)",
          ours_s, "s", nullptr, 0, 0);
  }
}

/// A made shoe, and shapes of other hands where they are.
void all_registration_rows() {
  registration_rows(made_halves());
  for (const char* shape : {"s31_leather_hightop", "s33_canvas_hightop", "s34_trail_scan"}) {
    const auto file = test::shared_data("shoes/" + std::string{shape} + "/cloud.ply");
    if (!file) continue;
    auto cloud = cloud::read_cloud(*file);
    if (cloud) registration_rows(halves_of(shape, std::move(cloud->points)));
  }
}

/// As many points as the bar names: those beyond are left out, the scan's last ones.
void cut(cloud::PointCloud& cloud) {
  constexpr std::size_t k_points = 600'000;
  const std::size_t size = std::min(k_points, cloud.size());
  cloud.points.resize(size);
  cloud.profile.resize(size);
  cloud.column.resize(size);
}

/// From the two clouds to a path that passed every check.
bool transfer_and_plan(const transfer::SampleFiles& sample, const cloud::PointCloud& upper,
                       const kinematics::ArmModel& arm, const path::Process& process) {
  const transfer::Transfer transfer = transfer::transfer_line(sample, upper, {});
  if (!transfer.found) return false;
  path::PlanRequest request;
  request.line = transfer.carried.line;
  request.process = process;
  request.arm = arm;
  request.cloud = upper.points;
  return path::plan(request).path.has_value();
}

void surface_rows() {
  // Where a UR5e gets its tool all the way round.
  const SE3 T_base_upper =
      geometry::make_se3(Eigen::Quaterniond{Eigen::AngleAxisd{1.5708, Vec3::UnitZ()}}, {450, -85, 30});
  test::MadePair pair = test::made_pair(
      {.seed = 5, .T_base_upper = T_base_upper, .scan = {.profile_step_mm = 0.57, .column_step_mm = 0.06}});
  cut(pair.upper_cloud);
  const std::size_t points = pair.upper_cloud.size();
  std::vector<transfer::Ray> rays;
  for (std::size_t i = 0; i < 2000; ++i) {
    const cloud::LinePoint& p = pair.upper_line.points[i % pair.upper_line.points.size()];
    const Vec3 direction = Vec3{p.normal.x(), p.normal.y(), 0}.normalized();
    rays.push_back({.origin = p.position - 2 * direction + 0.01 * static_cast<double>(i) * Vec3::UnitZ(),
                    .direction = direction,
                    .reach_mm = 15});
  }
  std::size_t hits = 0, peer_hits = 0;
  const double ours_s = seconds(false, [&] {
    const transfer::ScanMesh mesh = *transfer::ScanMesh::create(pair.upper_cloud);
    hits = 0;
    for (const transfer::Ray& ray : rays) hits += mesh.cast(ray) ? 1 : 0;
  });
  const transfer::ScanMesh mesh = *transfer::ScanMesh::create(pair.upper_cloud);
  const double embree_s = seconds(false, [&] {
    const evaluation::ReferenceSurface embree{{.vertices = mesh.points(), .faces = mesh.triangles()}};
    peer_hits = 0;
    for (const transfer::Ray& ray : rays) {
      peer_hits +=
          embree.first_hit(
              {.origin = ray.origin - 15 * ray.direction, .direction = ray.direction, .length_mm = 30})
              ? 1
              : 0;
    }
  });
  row("surface.mesh_rays",
      "mesh of " + std::to_string(points) + " points and 2000 rays (" + std::to_string(hits) + " and " +
          std::to_string(peer_hits) + " hits)",
      ours_s, "s", "Embree", embree_s, 1);
  row("surface.mesh_rays.bar", "same", ours_s, "s", "bar", 0.06, 1);

  const transfer::SampleFiles sample{.cloud = pair.sample_cloud, .line = pair.sample_line};
  bool found = false;
  const double transfer_s =
      seconds(false, [&] { found = transfer::transfer_line(sample, pair.upper_cloud, {}).found; });
  const std::string what = "sample of " + std::to_string(sample.cloud.size()) + ", upper of " +
                           std::to_string(points) + " points, clouds to ";
  row("transfer.whole", what + "line" + (found ? "" : ", REFUSED"), transfer_s, "s", "bar", 0.5, 1);
  const auto arm = kinematics::arm_model("UR5e");
  const auto process = path::read_process(std::filesystem::path{BITELINE_PROCESSES} / "grind.yaml");
  bool planned = false;
  const double path_s =
      seconds(false, [&] { planned = transfer_and_plan(sample, pair.upper_cloud, *arm, *process); });
  row("transfer.to_path", what + "checked path" + (planned ? "" : ", REFUSED"), path_s, "s", "bar", 0.5, 1);
}

}  // namespace
}  // namespace biteline::bench

int main() {
  biteline::bench::all_registration_rows();
  biteline::bench::surface_rows();
}
