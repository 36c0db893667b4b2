// SPDX-License-Identifier: MIT
#include "host/calibration/consistency/picture_check.hpp"

#include <CppUTest/TestHarness.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "tests/support/drift_scan.hpp"
#include "tests/support/spoilt_pictures.hpp"

namespace biteline::consistency {
namespace {

using Kind = test::Spoil::Kind;
using Status = PictureCheck::Status;

/// A cell and what its camera sees; made once, since all tests look at it.
struct Seen {
  explicit Seen(const test::DriftCell::Settings& settings)
      : cell{*test::DriftCell::make(settings)}, looks{cell.looks({})} {}
  test::DriftCell cell;
  std::vector<test::DriftCell::Look> looks;

  [[nodiscard]] PictureCheck check(const test::Spoil& spoil, const test::DriftCell::Draw& draw = {}) const {
    const geometry::Region& region = cell.calibrated().region;
    std::vector<test::DriftCell::Look> came;
    for (test::DriftCell::Look look : looks) {
      look.pixel = test::spoilt(look.pixel, region, spoil);
      const Vec2 at = look.pixel - Vec2{region.offset_u_px, region.offset_v_px};
      if (at.minCoeff() >= 0 && at.x() < region.width_px && at.y() < region.height_px) came.push_back(look);
    }
    const test::DriftScan scan = cell.scan(came, draw);
    return check_pictures(scan.view(), cell.calibrated(), {});
  }
};

const Seen& with_lap() {
  static const Seen seen{{}};
  return seen;
}
const Seen& without_lap() {
  static const Seen seen{{.check = {}}};
  return seen;
}
const Seen& in_the_dark() {
  static const Seen seen{{.table = false, .check = {}}};
  return seen;
}

void check_status(Status expected, const PictureCheck& check, const test::Spoil& spoil) {
  const std::string told = spoil.name() + ": " + as_json(check, false).dump();
  CHECK_TEXT(check.status == expected, told.c_str());
}

void check_told(const test::Spoil& spoil, const std::string& words) {
  const PictureCheck sut = with_lap().check(spoil);
  check_status(Status::Contradict, sut, spoil);
  CHECK_TEXT(sut.words.find(words) != std::string::npos, sut.words.c_str());
  CHECK(refusal_of(sut).has_value());
}

}  // namespace

TEST_GROUP(CheckPictures){};

TEST(CheckPictures, ASoundScanAgrees) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const PictureCheck sut = with_lap().check({}, {.seed = seed});
    check_status(Status::Agree, sut, {});
    CHECK_FALSE(refusal_of(sut).has_value());
    // Far from the limit.
    CHECK(sut.as_told.statistic < sut.as_told.limit / 2);
    CHECK(sut.as_told.moved_statistic.maxCoeff() < sut.as_told.moved_limit / 2);
  }
}

TEST(CheckPictures, MirroredOnesAreNamed) {
  check_told({Kind::Mirrored}, "as if the pictures were mirrored left to right");
}

TEST(CheckPictures, OnesUpsideDownAreNamed) {
  check_told({Kind::UpsideDown}, "as if the pictures were mirrored top to bottom");
}

TEST(CheckPictures, TurnedOnesAreNamed) {
  check_told({Kind::Turned}, "as if the pictures were turned by 180 degrees");
}

TEST(CheckPictures, BinnedOnesAreNamed) {
  check_told({Kind::Halved}, "binned");
}

TEST(CheckPictures, OnesOfAnotherRegionAreNamedByTheirRows) {
  check_told({Kind::Rows, 20}, "as if the pictures were moved by ");
  check_told({Kind::Rows, -20}, "rows");
  check_told({Kind::Rows, 50}, "rows");
  check_told({Kind::Columns, 40}, "columns");
}

TEST(CheckPictures, ItSaysFromHowManyRowsOnItTells) {
  const PictureCheck sut = with_lap().check({Kind::Rows, 2});
  check_status(Status::Agree, sut, {Kind::Rows, 2});
  CHECK(sut.as_told.tells_rows.has_value());
  CHECK(*sut.as_told.tells_rows > 2);
  CHECK(*sut.as_told.tells_rows < 12);
}

TEST(CheckPictures, ALapTellsColumnsToo) {
  const PictureCheck sut = with_lap().check({});
  CHECK(sut.as_told.tells_columns.has_value());
  CHECK(*sut.as_told.tells_columns < 12);
}

TEST(CheckPictures, ACameraThatTellsItsStateVouches) {
  const PictureCheck lap = with_lap().check({}), dark = in_the_dark().check({});
  CHECK(vouched_by(lap, false) == VouchedBy::Places);
  CHECK(vouched_by(dark, true) == VouchedBy::CameraState);
  CHECK(vouched_by(dark, false) == VouchedBy::Nobody);
  STRCMP_EQUAL("nobody", as_json(dark, false)["vouched_by"].get<std::string>().c_str());
}

TEST(CheckPictures, AWellKnownHeadTellsFewerRows) {
  uncertainty::HeadUncertainty stated = drift::axes_of(with_lap().cell.calibrated());
  const auto map = drift::parameters_per_quantity();
  constexpr double k_well = 0.03;  // of a fault worth telling in each quantity
  stated.covariance = k_well * k_well * map.leftCols<drift::k_head_quantities>() *
                      map.leftCols<drift::k_head_quantities>().transpose();
  const test::DriftScan sound = with_lap().cell.scan(with_lap().looks, {});
  const PictureCheck sut =
      check_pictures(sound.view(), with_lap().cell.calibrated(), {.head = stated, .arm = {}});
  check_status(Status::Agree, sut, {});
  CHECK(*sut.as_told.tells_rows <
        *check_pictures(sound.view(), with_lap().cell.calibrated(), {}).as_told.tells_rows);
}

TEST(CheckPictures, WithoutALapTheTableTellsWhichWayUp) {
  check_status(Status::NotSeen, without_lap().check({}), {});
  for (const Kind kind : {Kind::Mirrored, Kind::UpsideDown, Kind::Turned}) {
    const PictureCheck sut = without_lap().check({kind});
    check_status(Status::Contradict, sut, {kind});
    CHECK(sut.words.find("table") != std::string::npos);
  }
}

TEST(CheckPictures, WithoutLapAndTableItCannotTellAndSaysSo) {
  for (const Kind kind : {Kind::AsTheyAre, Kind::Mirrored, Kind::Turned}) {
    const PictureCheck sut = in_the_dark().check({kind});
    check_status(Status::NotSeen, sut, {kind});
    CHECK(sut.words.find("check lap") != std::string::npos);
    CHECK_FALSE(refusal_of(sut).has_value());
  }
}

TEST(CheckPictures, NoPointsAndNoPosesAreNotSeen) {
  const geometry::SensorModel& head = with_lap().cell.calibrated();
  check_status(Status::NotSeen, check_pictures({}, head, {}), {});
  const test::DriftScan scan = with_lap().cell.scan(with_lap().looks, {});
  check_status(Status::NotSeen, check_pictures({scan.points_base, scan.profile, {}}, head, {}), {});
}

}  // namespace biteline::consistency
