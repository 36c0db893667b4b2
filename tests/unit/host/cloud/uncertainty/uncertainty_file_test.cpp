// SPDX-License-Identifier: MIT
#include "host/cloud/uncertainty/uncertainty_file.hpp"

#include <CppUTest/TestHarness.h>

#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/uncertain_scan.hpp"

namespace biteline::uncertainty {

TEST_GROUP(UncertaintyFile) {
  test::TemporaryFolder folder;
  const HeadUncertainty known = test::uncertain_scan({.profile_step_mm = 60}).head.uncertainty;

  /// The file with one text in place of another.
  std::filesystem::path changed(const std::string& what, const std::string& to) const {
    std::string text = uncertainty_text(known);
    const std::size_t at = text.find(what);
    CHECK_TEXT(at != std::string::npos, what.c_str());
    return folder.write(k_file_name, text.replace(at, what.size(), to));
  }
};

TEST(UncertaintyFile, IsReadAsItWasWritten) {
  const auto sut = read_uncertainty(folder.write(k_file_name, uncertainty_text(known)));
  SUCCEEDS(sut);
  // Nine digits.
  CHECK((sut->covariance - known.covariance).norm() <= 1e-8 * known.covariance.norm());
  CHECK((sut->plane_axes - known.plane_axes).norm() < 1e-8);
  CHECK((sut->plane_middle_cam - known.plane_middle_cam).norm() < 1e-6);
  DOUBLES_EQUAL(known.pose_sigma_mm, sut->pose_sigma_mm, 1e-9);
  DOUBLES_EQUAL(known.pose_sigma_rad, sut->pose_sigma_rad, 1e-12);
}

TEST(UncertaintyFile, AnArmMayBeStatedAndNeedNot) {
  HeadUncertainty stated = known;
  stated.arm_give_mm_per_m_s2 = 0.034;
  const auto sut = read_uncertainty(folder.write(k_file_name, uncertainty_text(stated)));
  SUCCEEDS(sut);
  DOUBLES_EQUAL(0.034, sut->arm_give_mm_per_m_s2.value_or(-1), 1e-12);
  stated.arm_give_mm_per_m_s2.reset();
  const auto none = read_uncertainty(folder.write(k_file_name, uncertainty_text(stated)));
  SUCCEEDS(none);
  CHECK_FALSE(none->arm_give_mm_per_m_s2.has_value());
  stated.arm_give_mm_per_m_s2 = -1;
  FAILS_NAMING(Errc::BadValue, "arm_give_mm_per_m_s2",
               read_uncertainty(folder.write(k_file_name, uncertainty_text(stated))));
}

TEST(UncertaintyFile, BesideASensorYamlThereMayBeNone) {
  const auto none = read_uncertainty_beside(folder.path() / "sensor.yaml");
  SUCCEEDS(none);
  CHECK_FALSE(none->has_value());
  folder.write(k_file_name, uncertainty_text(known));
  const auto sut = read_uncertainty_beside(folder.path() / "sensor.yaml");
  SUCCEEDS(sut);
  CHECK(sut->has_value());
}

TEST(UncertaintyFile, RefusesWhatIsNoCovariance) {
  FAILS_NAMING(Errc::BadValue, "covariance",
               read_uncertainty(changed("covariance:\n  - [", "covariance:\n  - [-")));
  FAILS_NAMING(Errc::BadValue, "pose_sigma_mm",
               read_uncertainty(changed("pose_sigma_mm: ", "pose_sigma_mm: -")));
  CHECK_FALSE(read_uncertainty(changed("pose_sigma_rad", "pose_sigma_deg")).has_value());
  CHECK_FALSE(read_uncertainty(changed("covariance:\n", "covariance:\n  - [1, 2]\n")).has_value());
  FAILS_NAMING(Errc::FileNotFound, "nothing.yaml", read_uncertainty(folder.path() / "nothing.yaml"));
}

}  // namespace biteline::uncertainty
