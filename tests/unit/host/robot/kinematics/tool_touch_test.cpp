// SPDX-License-Identifier: MIT
#include "host/robot/kinematics/tool_touch.hpp"

#include <CppUTest/TestHarness.h>

#include <cstdio>
#include <fstream>
#include <random>
#include <string>

namespace biteline::kinematics {

TEST_GROUP(ToolTouch) {
  std::mt19937_64 random{61};
  std::normal_distribution<double> normal;
  const Vec3 tip_flange{12, -7, 183};
  const Vec3 point_base{420, -130, 60};

  /// Flange poses with the tip at the point, leaning up to `lean_rad` to all sides, off by noise.
  std::vector<SE3> touches(std::size_t count, double lean_rad, double noise_mm) {
    std::vector<SE3> out;
    for (std::size_t i = 0; i < count; ++i) {
      const double around_rad = 2.4 * static_cast<double>(i);
      SE3 T = SE3::Identity();
      T.linear() = geometry::exp_so3(lean_rad * Vec3{std::cos(around_rad), std::sin(around_rad), 0.3}) *
                   geometry::exp_so3(Vec3{3.1, 0, 0});
      T.translation() = point_base - T.linear() * tip_flange +
                        noise_mm * Vec3{normal(random), normal(random), normal(random)};
      out.push_back(T);
    }
    return out;
  }
};

TEST(ToolTouch, ExactTouchesGiveTheTip) {
  const auto fit = fit_tool_touch(touches(6, 0.5, 0), {});
  CHECK(fit.has_value());
  DOUBLES_EQUAL(0.0, (fit->tip_flange - tip_flange).norm(), 1e-9);
  DOUBLES_EQUAL(0.0, (fit->point_base - point_base).norm(), 1e-9);
  DOUBLES_EQUAL(0.0, fit->rms_mm, 1e-9);
}

TEST(ToolTouch, StatedDeviationIsWhatRepetitionShows) {
  // 300 repetitions: the empirical deviation is known to 1 / sqrt(600) = 4 %; three of those and the
  // estimate's own spread.
  constexpr int k_repetitions = 300;
  double sum2 = 0, stated2 = 0;
  for (int i = 0; i < k_repetitions; ++i) {
    const auto fit = fit_tool_touch(touches(8, 0.5, 0.1), {});
    CHECK(fit.has_value());
    sum2 += (fit->tip_flange - tip_flange).squaredNorm();
    stated2 += fit->sigma_mm.squaredNorm();
  }
  DOUBLES_EQUAL(1.0, std::sqrt(sum2 / stated2), 0.15);
}

TEST(ToolTouch, AlikeOrFewOrTurnedAboutOneAxisOnlyIsDegenerate) {
  CHECK(fit_tool_touch(touches(3, 0.5, 0), {}).error().code == Errc::Degenerate);
  CHECK(fit_tool_touch(touches(8, 0.01, 0), {}).error().code == Errc::Degenerate);
  std::vector<SE3> one_axis;
  for (int i = 0; i < 8; ++i) {
    SE3 T = SE3::Identity();
    T.linear() = geometry::exp_so3(Vec3{0, 0, 0.5 * i});
    T.translation() = point_base - T.linear() * tip_flange;
    one_axis.push_back(T);
  }
  CHECK(fit_tool_touch(one_axis, {}).error().code == Errc::Degenerate);
}

TEST(ToolTouch, OneSlippedTouchIsNamed) {
  std::vector<SE3> slipped = touches(8, 0.5, 0.05);
  slipped[5].translation().x() += 6;
  const auto fit = fit_tool_touch(slipped, {});
  CHECK_FALSE(fit.has_value());
  CHECK(fit.error().where.view().find("touch 5 worst") != std::string_view::npos);
}

TEST(ToolTouch, FileIsReadAndItsFaultsNamed) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "biteline_touch_test.csv";
  std::ofstream{file} << "#number,p_x [mm],p_y [mm],p_z [mm],q_w [],q_x [],q_y [],q_z []\n0,1,2,3,0,1,0,0\n";
  const auto good = read_touches(file);
  CHECK(good.has_value() && good->size() == 1);
  DOUBLES_EQUAL(-1, (*good)[0].linear()(2, 2), 1e-12);
  std::ofstream{file} << "0,1,2,3,0,1,0,0\n1,1,2,3,0,2,0,0\n";
  const auto bad = read_touches(file);
  CHECK_FALSE(bad.has_value());
  CHECK(bad.error().where.view().find("row 2") != std::string_view::npos);
  std::filesystem::remove(file);
}

}  // namespace biteline::kinematics
