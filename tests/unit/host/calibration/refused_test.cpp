// SPDX-License-Identifier: MIT
#include "host/calibration/head/refused.hpp"

#include "common/core/result.hpp"
#include "tests/support/refusals.hpp"

namespace biteline::calibration {

TEST_GROUP(CalibrationRefused){};

TEST(CalibrationRefused, EveryCodeHasItsRow) {
  biteline::test::check_refusal_table(Refused::PosesFrozen);
}

TEST(CalibrationRefused, NamesThePartAndTheKindOfTrouble) {
  const auto code = [](Part part, Errc errc) { return refusal_of(part, fail(errc, "words").value()).code; };
  CHECK(code(Part::Camera, Errc::Refused) == Refused::CameraNotTrusted);
  CHECK(code(Part::Laser, Errc::Degenerate) == Refused::LaserNotDetermined);
  CHECK(code(Part::HandEye, Errc::NotConverged) == Refused::HandEyeNotConverged);
  CHECK(code(Part::Together, Errc::Refused) == Refused::TogetherNotTrusted);
  CHECK(code(Part::Clock, Errc::NotConverged) == Refused::ClockNotConverged);
  STRCMP_EQUAL("words", refusal_of(Part::Clock, fail(Errc::Refused, "words").value()).reason.c_str());
}

}  // namespace biteline::calibration
