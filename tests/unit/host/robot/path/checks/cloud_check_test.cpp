// SPDX-License-Identifier: MIT
#include "host/robot/path/checks/cloud_check.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <limits>

#include "tests/unit/host/robot/path/made_line.hpp"

namespace biteline::path {

/// A sole's wall 25 mm high below the line, 4 mm outside it, and an upper 60 mm high that leans in above it.
TEST_GROUP(CloudCheck) {
  cloud::ClosedLine line = test::made_line();
  std::vector<Eigen::Vector3f> cloud;

  void setup() override {
    for (const cloud::LinePoint& p : line.points) {
      for (double z_mm = -25; z_mm <= 60; z_mm += 0.8) {
        const double out_mm = z_mm < 0 ? 4 : -0.15 * z_mm;
        cloud.push_back((p.position + out_mm * p.normal + z_mm * Vec3::UnitZ()).cast<float>());
      }
    }
  }

  bool passes(const cloud::ClosedLine& candidate) {
    const Check check = check_on_cloud(candidate, cloud);
    CHECK(check.passed == check.detail.empty());
    return check.passed;
  }
  cloud::ClosedLine moved(const Vec3& by_mm) const {
    cloud::ClosedLine out = line;
    for (cloud::LinePoint& p : out.points) p.position += by_mm;
    return out;
  }
};

TEST(CloudCheck, LineOnItsOwnScanPasses) {
  CHECK(passes(line));
  CHECK(passes(moved({0.4, 0.3, 0.2})));
}

TEST(CloudCheck, ShiftedLineIsNoneOfThisScan) {
  const Vec3 shifts[] = {{10, 0, 0},  {-10, 0, 0}, {0, 10, 0},  {0, 0, 15},
                         {0, 0, -15}, {5, 5, 0},   {0, 0, -100}};
  for (const Vec3& by_mm : shifts) CHECK(!passes(moved(by_mm)));
}

TEST(CloudCheck, BumpInwardsIsNone) {
  const double middle = 0.25 * static_cast<double>(line.points.size());
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const double d = (static_cast<double>(i) - middle) / 20;
    line.points[i].position -= 20 * std::exp(-0.5 * d * d) * line.points[i].normal;
  }
  CHECK(!passes(line));
}

TEST(CloudCheck, BridgedGapPassesAndAWiderOneDoesNot) {
  const auto cut = [&](double length_mm) {
    std::erase_if(cloud, [&](const Eigen::Vector3f& p) {
      return (p.cast<double>() - line.points[40].position).head<2>().norm() < length_mm / 2;
    });
  };
  cut(15);  // what a carried line bridges unasked
  CHECK(passes(line));
  cut(60);
  CHECK(!passes(line));
}

TEST(CloudCheck, CloudOfNothingAndOfNoNumbersHoldsNoLine) {
  cloud.assign(5, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  cloud.push_back(Eigen::Vector3f::Constant(3e38F));
  CHECK(!passes(line));
  std::feclearexcept(FE_ALL_EXCEPT);  // raised on purpose
}

}  // namespace biteline::path
