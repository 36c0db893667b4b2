// SPDX-License-Identifier: MIT
#include "host/intake/live_line.hpp"

#include <CppUTest/TestHarness.h>

#include <algorithm>
#include <random>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/scanned_cloud.hpp"
#include "host/bite_line/evaluation/line_error.hpp"
#include "host/intake/whole_scan.hpp"

namespace biteline::intake {
namespace {

const bite_line::Config k_line_only{};
/// What a running scan may differ from the finished cloud by, at any point.
constexpr double k_same_mm = 0.02;

/// A coarse scan keeps the test fast.
cloud::PointCloud scan_of(sim::ShoeClass shoe_class) {
  const sim::MadeShoe shoe{sim::draw_shoe(shoe_class, 61)};
  SE3 T_base_shoe = SE3::Identity();
  T_base_shoe.linear() = Eigen::AngleAxisd(-0.8, Vec3::UnitZ()).toRotationMatrix();
  T_base_shoe.translation() = Vec3{380, 90, 40};
  const sim::ScannedCloud scan =
      sim::scan_quickly(shoe, {.profile_step_mm = 1.3, .column_step_mm = 0.15}, T_base_shoe);
  cloud::PointCloud cloud;
  cloud.points = scan.points;
  cloud.profile = scan.profile;
  cloud.column = scan.column;
  return cloud;
}

/// Index ranges of the profiles, in scan order.
struct Range {
  std::size_t first, end;
};
std::vector<Range> profiles_of(const cloud::PointCloud& cloud) {
  std::vector<Range> ranges;
  for (std::size_t first = 0; first < cloud.size();) {
    std::size_t end = first;
    while (end < cloud.size() && cloud.profile[end] == cloud.profile[first]) ++end;
    ranges.push_back({first, end});
    first = end;
  }
  return ranges;
}

void add(LiveLine& line, const cloud::PointCloud& cloud, const Range& range) {
  line.add_profile(cloud.profile[range.first], {cloud.points.data() + range.first, range.end - range.first});
}

void check_same(const bite_line::Extraction& finished, const bite_line::Extraction& live) {
  CHECK_TEXT(finished.found, finished.reason().c_str());
  CHECK_TEXT(live.found, live.reason().c_str());
  CHECK_COMPARE(evaluation::line_error(live.line, finished.line).max_mm, <=, k_same_mm);
  DOUBLES_EQUAL(finished.confidence, live.confidence, 0.01);
}

}  // namespace

TEST_GROUP(LiveLine){};

TEST(LiveLine, LineOfEachClassIsThatOfTheFinishedCloud) {
  for (const auto shoe_class :
       {sim::ShoeClass::Deep, sim::ShoeClass::Shallow, sim::ShoeClass::Step, sim::ShoeClass::Stitched}) {
    const cloud::PointCloud cloud = scan_of(shoe_class);
    LiveLine sut{k_line_only};
    sut.add_profiles(cloud);
    sut.close();
    const LiveLine::Outcome outcome = sut.wait();
    LONGS_EQUAL(profiles_of(cloud).size(), outcome.profiles);
    CHECK(outcome.last_profile_to_line_s > 0);
    check_same(bite_line::find_bite_line(cloud, k_line_only), outcome.extraction);
  }
}

TEST(LiveLine, ACloudTakenUpAgainKeepsItsPoses) {
  const cloud::PointCloud cloud = scan_of(sim::ShoeClass::Deep);
  // Every other profile has one; the arm sways along its way.
  std::vector<TakenFrom> poses;
  for (const Range& range : profiles_of(cloud)) {
    const std::uint32_t number = cloud.profile[range.first];
    if (number % 2 != 0) continue;
    TakenFrom taken{.profile = number, .pose = {.time_s = 0.01 * number}};
    taken.pose.T_base_flange.translation().x() = std::sin(50 * taken.pose.time_s);
    poses.push_back(taken);
  }
  LiveLine sut{k_line_only};
  sut.add_profiles(cloud, poses);
  sut.close({}, uncertainty::ArmGive{.mm_per_m_s2 = 0.05, .source = uncertainty::ArmSource::EarlierScans});
  const bite_line::Extraction line = sut.wait().extraction;
  CHECK(line.arm.has_value());
  CHECK_EQUAL(poses.size(), line.arm->places.size());
  // A scan in which no line is looked for tells the same.
  ScanOutcome scan;
  scan.cloud = cloud;
  CHECK_FALSE(whole_scan_of(scan, {}, {}).known());
  scan.poses = poses;
  const uncertainty::WholeScan whole = whole_scan_of(
      scan, {}, uncertainty::ArmGive{.mm_per_m_s2 = 0.05, .source = uncertainty::ArmSource::EarlierScans});
  CHECK(whole.arm && !whole.head);
  DOUBLES_EQUAL(line.arm->sigma_mm, whole.arm->sigma_mm, 1e-12);
  CHECK_EQUAL(line.arm->places.size(), whole.arm->places.size());
  CHECK(whole_scan_of(scan, uncertainty::HeadUncertainty{}, {}).head.has_value());
  CHECK(line.arm->source == uncertainty::ArmSource::EarlierScans);
  DOUBLES_EQUAL(0.05, line.arm->give_mm_per_m_s2, 1e-12);
  LiveLine without{k_line_only};
  without.add_profiles(cloud);
  without.close();
  CHECK_FALSE(without.wait().extraction.arm.has_value());
}

TEST(LiveLine, AnArmThatNothingTellsOfIsAssumedAndWhatIsStatedGoesFirst) {
  const cloud::PointCloud cloud = scan_of(sim::ShoeClass::Deep);
  std::vector<TakenFrom> poses;
  for (const Range& range : profiles_of(cloud)) {
    const std::uint32_t number = cloud.profile[range.first];
    poses.push_back({.profile = number, .pose = {.time_s = 0.01 * number}});
    poses.back().pose.T_base_flange.translation().x() = 10 * std::sin(10 * poses.back().pose.time_s);
  }
  const auto line_of = [&](std::shared_ptr<const uncertainty::KnownHead> head,
                           std::optional<uncertainty::ArmGive> earlier) {
    LiveLine sut{k_line_only};
    sut.add_profiles(cloud, poses);
    sut.close(std::move(head), earlier);
    return sut.wait().extraction;
  };
  const bite_line::Extraction assumed = line_of({}, {});
  CHECK(assumed.arm.has_value());
  CHECK(assumed.arm->source == uncertainty::ArmSource::Assumed);
  // A coordinate's deviation is in the radius of every place.
  for (const cloud::LinePoint& p : assumed.line.points)
    CHECK_COMPARE(p.u95_mm.value_or(0), >, assumed.arm->sigma_mm_at(p.position));
  const uncertainty::ArmGive earlier{.mm_per_m_s2 = 0.05, .source = uncertainty::ArmSource::EarlierScans};
  uncertainty::KnownHead head{};
  head.uncertainty.arm_give_mm_per_m_s2 = 0.01;
  const bite_line::Extraction stated = line_of(std::make_shared<const uncertainty::KnownHead>(head), earlier);
  CHECK(stated.arm->source == uncertainty::ArmSource::Stated);
  DOUBLES_EQUAL(0.01, stated.arm->give_mm_per_m_s2, 1e-12);
}

TEST(LiveLine, RefusesWhatTheFinishedCloudIsRefusedForAndSaysTheSame) {
  const cloud::PointCloud bare = scan_of(sim::ShoeClass::Bare);
  LiveLine sut{k_line_only};
  sut.add_profiles(bare);
  sut.close();
  const bite_line::Extraction finished = bite_line::find_bite_line(bare, k_line_only);
  const bite_line::Extraction live = sut.wait().extraction;
  CHECK_FALSE(finished.found);
  CHECK_FALSE(live.found);
  STRCMP_EQUAL(finished.reason().substr(0, 20).c_str(), live.reason().substr(0, 20).c_str());
  CHECK(live.line.points.empty());
}

TEST(LiveLine, ProfilesThatComeTwiceAndOutOfOrderChangeNothing) {
  const cloud::PointCloud cloud = scan_of(sim::ShoeClass::Faded);
  std::vector<Range> ranges = profiles_of(cloud);
  LiveLine sut{k_line_only};
  std::mt19937 random{3};
  // A connection that breaks and comes back twice over, and stretches that overtake one another.
  for (std::size_t first = 0; first < ranges.size(); first += 7)
    std::shuffle(ranges.begin() + static_cast<std::ptrdiff_t>(first),
                 ranges.begin() + static_cast<std::ptrdiff_t>(std::min(first + 7, ranges.size())), random);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    add(sut, cloud, ranges[i]);
    if (i == 90 || i == 200) {
      for (std::size_t again = i - 40; again <= i; ++again) add(sut, cloud, ranges[again]);
    }
  }
  sut.close();
  const LiveLine::Outcome outcome = sut.wait();
  LONGS_EQUAL(ranges.size(), outcome.profiles);
  check_same(bite_line::find_bite_line(cloud, k_line_only), outcome.extraction);
}

TEST(LiveLine, ScanThatIsGivenUpIsDroppedWhereItStands) {
  const cloud::PointCloud cloud = scan_of(sim::ShoeClass::Deep);
  {
    LiveLine given_up{k_line_only};
    for (const Range& range : profiles_of(cloud)) add(given_up, cloud, range);
  }
  {
    LiveLine closed{k_line_only};
    closed.add_profiles(cloud);
    closed.close();
  }
  LiveLine never_used{k_line_only};
}

TEST(LiveLine, ScanWithoutAnythingIsRefused) {
  LiveLine sut{k_line_only};
  sut.close();
  const LiveLine::Outcome outcome = sut.wait();
  LONGS_EQUAL(0, outcome.profiles);
  CHECK_FALSE(outcome.extraction.found);
  CHECK_FALSE(outcome.extraction.reason().empty());
}

}  // namespace biteline::intake
