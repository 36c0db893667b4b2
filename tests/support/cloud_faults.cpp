// SPDX-License-Identifier: MIT
#include "tests/support/cloud_faults.hpp"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "hal/sim/shoe/random.hpp"

namespace biteline::test {

namespace {

void keep_if(cloud::PointCloud& cloud, const std::vector<bool>& keep) {
  std::size_t kept = 0;
  const bool stripe = !cloud.amplitude.empty();
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    cloud.points[kept] = cloud.points[i];
    if (stripe) {
      cloud.amplitude[kept] = cloud.amplitude[i];
      cloud.width_px[kept] = cloud.width_px[i];
    }
    ++kept;
  }
  cloud.points.resize(kept);
  if (!stripe) return;
  cloud.amplitude.resize(kept);
  cloud.width_px.resize(kept);
}

Eigen::Affine3d about(const Vec3& centre, const Mat3& M) {
  return Eigen::Translation3d(centre) * Eigen::Affine3d(M) * Eigen::Translation3d(-centre);
}

class Spoiler {
 public:
  Spoiler(cloud::PointCloud& cloud, std::uint64_t seed)
      : cloud_{cloud}, random_{seed * 131 + 9}, stripe_{seed * 137 + 11} {
    low_ = high_ = cloud.points.front();
    for (const Eigen::Vector3f& p : cloud.points) {
      low_ = low_.cwiseMin(p);
      high_ = high_.cwiseMax(p);
    }
    middle_ = 0.5F * (low_ + high_);
  }

  void add_noise() {
    const double noise_mm = random_.uniform({0.03, 0.08});
    for (Eigen::Vector3f& p : cloud_.points)
      p += (noise_mm * Vec3{random_.gaussian(), random_.gaussian(), random_.gaussian()}).cast<float>();
  }

  Eigen::Affine3d tilt() {
    const double direction = random_.uniform({0, 2 * std::numbers::pi});
    const double angle = random_.uniform({4, 10}) * std::numbers::pi / 180;
    return move(about(
        middle_.cast<double>(),
        Eigen::AngleAxisd(angle, Vec3{std::cos(direction), std::sin(direction), 0}).toRotationMatrix()));
  }

  Eigen::Affine3d mirror() {
    return move(about(middle_.cast<double>(), Vec3{1, -1, 1}.asDiagonal().toDenseMatrix()));
  }

  void add_table() {
    for (int i = 0; i < 200'000; ++i) {
      const double x = random_.uniform({-350, 350});
      const double y = random_.uniform({-300, 300});
      add(Vec3{middle_.x() + x, middle_.y() + y, low_.z() - 0.3 + 0.02 * random_.gaussian()});
    }
  }

  /// 25 mm beside the shoe.
  void add_post() {
    const double side = random_.chance(0.5) ? 1.0 : -1.0;
    const Vec3 foot{middle_.x() + 40.0,
                    middle_.y() + side * (0.5 * static_cast<double>(high_.y() - low_.y()) + 45.0),
                    static_cast<double>(low_.z())};
    for (int i = 0; i < 30'000; ++i) {
      const double angle = random_.uniform({0, 2 * std::numbers::pi});
      add(foot + Vec3{20 * std::cos(angle), 20 * std::sin(angle), random_.uniform({0, 120})});
    }
  }

  void add_strays() {
    for (std::size_t i = 0, n = cloud_.points.size() / 100; i < n; ++i) {
      if (i % 2 == 0) {
        add(Vec3{random_.uniform({low_.x() - 60.0, high_.x() + 60.0}),
                 random_.uniform({low_.y() - 60.0, high_.y() + 60.0}),
                 random_.uniform({low_.z() - 30.0, high_.z() + 60.0})});
      } else {
        const auto at =
            static_cast<std::size_t>(random_.integer(0, static_cast<int>(cloud_.points.size()) - 1));
        add(cloud_.points[at].cast<double>() +
            3.0 * Vec3{random_.gaussian(), random_.gaussian(), random_.gaussian()});
      }
    }
  }

  void cut_sector(std::span<const Vec3> line, std::uint64_t seed) {
    auto at = static_cast<std::size_t>(random_.integer(0, static_cast<int>(line.size()) - 1));
    if (seed % 2 == 0) {
      // At one of the narrow ends, where the line bends most: the truth begins at the heel.
      const std::size_t end = seed % 4 == 0 ? 0 : line.size() / 2;
      at = (end + at / 16) % line.size();
    }
    std::vector<bool> keep;
    for (const Eigen::Vector3f& p : cloud_.points)
      keep.push_back((p.cast<double>() - line[at]).head<2>().norm() > 20.0);
    keep_if(cloud_, keep);
  }

  void thin_out() {
    const double share = 50'000.0 / static_cast<double>(cloud_.points.size());
    std::vector<bool> keep;
    for (std::size_t i = 0; i < cloud_.points.size(); ++i) keep.push_back(random_.chance(share));
    keep_if(cloud_, keep);
  }

  void shuffle() {
    std::vector<Eigen::Vector3f>& points = cloud_.points;
    for (std::size_t i = points.size(); i-- > 1;) {
      const auto other = static_cast<std::size_t>(random_.integer(0, static_cast<int>(i)));
      std::swap(points[i], points[other]);
      if (cloud_.amplitude.empty()) continue;
      std::swap(cloud_.amplitude[i], cloud_.amplitude[other]);
      std::swap(cloud_.width_px[i], cloud_.width_px[other]);
    }
  }

 private:
  Eigen::Affine3d move(const Eigen::Affine3d& by) {
    for (Eigen::Vector3f& p : cloud_.points) p = (by * p.cast<double>()).cast<float>();
    return by;
  }
  /// Of something grey.
  void add(const Vec3& p) {
    cloud_.points.push_back(p.cast<float>());
    if (cloud_.amplitude.empty()) return;
    cloud_.amplitude.push_back(static_cast<float>(stripe_.uniform({20, 200})));
    cloud_.width_px.push_back(static_cast<float>(stripe_.uniform({4, 6})));
  }

  cloud::PointCloud& cloud_;
  sim::Random random_, stripe_;
  Eigen::Vector3f low_, high_, middle_;
};

}  // namespace

Eigen::Affine3d spoil(cloud::PointCloud& cloud, CloudFault fault, std::uint64_t seed,
                      std::span<const Vec3> line) {
  Spoiler spoiler{cloud, seed};
  Eigen::Affine3d moved = Eigen::Affine3d::Identity();
  bool in_scan_order = false;
  switch (fault) {
    case CloudFault::None:
      in_scan_order = true;
      break;
    case CloudFault::Noise:
      spoiler.add_noise();
      in_scan_order = true;
      break;
    case CloudFault::Tilt:
      moved = spoiler.tilt();
      in_scan_order = true;
      break;
    case CloudFault::Mirrored:
      moved = spoiler.mirror();
      in_scan_order = true;
      break;
    case CloudFault::Strays:
      spoiler.add_strays();
      break;
    case CloudFault::Sector:
      spoiler.cut_sector(line, seed);
      break;
    case CloudFault::Table:
      spoiler.add_table();
      break;
    case CloudFault::Post:
      spoiler.add_post();
      break;
    case CloudFault::Sparse:
      spoiler.thin_out();
      break;
    case CloudFault::Shuffled:
      spoiler.shuffle();
      break;
  }
  if (in_scan_order) return moved;
  cloud.profile.clear();
  cloud.column.clear();
  return moved;
}

}  // namespace biteline::test
