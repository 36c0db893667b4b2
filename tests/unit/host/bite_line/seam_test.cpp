// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/bite_line/find_bite_line.hpp"
#include "host/bite_line/side/seam.hpp"
#include "host/bite_line/side/side_outline.hpp"
#include "tests/support/made_cloud.hpp"

namespace biteline::bite_line {
namespace {

// Ten times a sound scan's, a tenth of what is refused.
constexpr double k_sound_mm = 0.1;
// The nearest of four directions is at most 22.5 degrees off the wall's normal (cosine 0.92), and the wall's
// own slant to the outline and its bend over what slid along it take or give a tenth.
constexpr double k_seen_ratio = 0.92, k_seen_within_ratio = 0.15;

cloud::PointCloud made(std::uint64_t seed) {
  return test::made_cloud(sim::ShoeClass::Deep, seed, test::somewhere()).cloud;
}

/// Goes on for so many profiles behind its end, over what it saw first.
cloud::PointCloud with_lap(cloud::PointCloud cloud, std::uint32_t profiles) {
  const std::size_t count = cloud.size();
  const std::uint32_t behind = cloud.profile.back() + 1 - cloud.profile.front();
  for (std::size_t i = 0; i < count && cloud.profile[i] < cloud.profile.front() + profiles; ++i) {
    cloud.points.push_back(cloud.points[i]);
    cloud.profile.push_back(cloud.profile[i] + behind);
  }
  return cloud;
}

std::optional<SeamStep> step_of(const cloud::PointCloud& cloud) {
  const PointRuns runs = runs_of(cloud);
  const ScanPoints scan = runs.scan(cloud.points);
  const OrRefusal<Shoe> shoe = find_shoe(scan.means);
  return seam_step(scan, *shoe, side_outline(*shoe));
}

/// As if the shoe had turned about its middle while it was scanned.
cloud::PointCloud turned(cloud::PointCloud cloud, double by_rad) {
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& point : cloud.points) middle += point / static_cast<float>(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double share = static_cast<double>(cloud.profile[i]) / cloud.profile.back();
    const Eigen::AngleAxisf turn{static_cast<float>(share * by_rad), Eigen::Vector3f::UnitZ()};
    cloud.points[i] = middle + turn * (cloud.points[i] - middle);
  }
  return cloud;
}

/// Most of the step over four ways in which a shoe may be pushed.
double most_mm(const cloud::PointCloud& cloud, double share, double by_mm) {
  double most = 0;
  for (int k = 0; k < 4; ++k) {
    const double angle = k * 0.785;
    const Eigen::Vector3d by{by_mm * std::cos(angle), by_mm * std::sin(angle), 0};
    most = std::max(
        most, std::abs(step_of(test::pushed(cloud, share, by.cast<float>())).value_or(SeamStep{}).out_mm));
  }
  return most;
}

}  // namespace

TEST_GROUP(Seam){};

TEST(Seam, ASoundScansEndLiesWhereItBegan) {
  for (const std::uint64_t seed : {11, 12, 13}) {
    DOUBLES_EQUAL(0, step_of(made(seed)).value().moved_mm, k_sound_mm);
    DOUBLES_EQUAL(0, step_of(with_lap(made(seed), 60)).value().moved_mm, k_sound_mm);
  }
}

TEST(Seam, AShoeThatIsPushedOnTheWayIsSeenBesideItself) {
  for (const double share : {0.2, 0.5, 0.8})
    DOUBLES_EQUAL(k_seen_ratio * 2, most_mm(made(11), share, 2), k_seen_within_ratio * 2);
}

TEST(Seam, BothLayersOfALapCountAlthoughOneLiesBehindTheOther) {
  DOUBLES_EQUAL(k_seen_ratio * 4, most_mm(with_lap(made(12), 30), 0.5, 4), k_seen_within_ratio * 4);
}

TEST(Seam, AShoeThatIsTurnedOnTheWayShowsByAnOverlapThatSlants) {
  constexpr double k_turn_rad = 0.02;
  const cloud::PointCloud sound = with_lap(made(12), 60);
  // Its ends move by 2.5 mm.  A turn about where the overlap's bend has its middle would not show at all.
  DOUBLES_EQUAL(1.7, step_of(turned(sound, k_turn_rad)).value().moved_mm, 0.8);
  CHECK(find_bite_line(sound, {}).found);
  const Extraction moved = find_bite_line(turned(sound, k_turn_rad), {});
  CHECK(moved.refusal && moved.refusal->code == Refused::DoesNotClose);
}

TEST(Seam, WithAnOverlapAShoeThatMovedAnyWayHasNoLine) {
  const cloud::PointCloud sound = with_lap(made(13), 60);
  for (int k = 0; k < 8; ++k) {
    const double angle = k * 0.3927;
    const Eigen::Vector3d by{3 * std::cos(angle), 3 * std::sin(angle), 0};
    const Extraction sut = find_bite_line(test::pushed(sound, 0.5, by.cast<float>()), {});
    CHECK(sut.refusal && sut.refusal->code == Refused::DoesNotClose);
  }
}

TEST(Seam, ACloudWithoutOrderAndAScanThatDoesNotComeRoundTellNothing) {
  cloud::PointCloud cloud = made(11);
  cloud::PointCloud part = cloud;
  while (part.profile.back() > 0.9 * cloud.profile.back()) {
    part.points.pop_back();
    part.profile.pop_back();
  }
  CHECK_FALSE(step_of(part).has_value());
  cloud.profile.clear();
  CHECK_FALSE(step_of(cloud).has_value());
}

TEST(Seam, AShoeThatMovedHasNoLine) {
  const cloud::PointCloud sound = made(13);
  CHECK(find_bite_line(sound, {}).found);
  int refused = 0;
  for (int k = 0; k < 4; ++k) {
    const double angle = k * 0.785;
    const Eigen::Vector3d by{3 * std::cos(angle), 3 * std::sin(angle), 0};
    const Extraction sut = find_bite_line(test::pushed(sound, 0.5, by.cast<float>()), {});
    if (sut.found) continue;  // along the wall at the seam, which nothing shows
    ++refused;
    CHECK(sut.refusal->code == Refused::DoesNotClose);
  }
  CHECK_COMPARE(refused, >=, 3);
}

}  // namespace biteline::bite_line
