// SPDX-License-Identifier: MIT
#include "common/settings/settings.hpp"

#include <CppUTest/TestHarness.h>

#include <limits>

#include "common/stripe/peak_extractor.hpp"
#include "tests/support/errors.hpp"

namespace biteline::settings {

TEST_GROUP(Settings){static Result<SettingsSet> parse(const std::string& body){
    return parse_settings(body + "\n...\n", "set.yaml");
}
}
;

TEST(Settings, WhatIsWrittenIsReadAgain) {
  SettingsSet set;
  set.note = "black \"leather\"";
  for (std::size_t i = 0; i < k_key_count; ++i) {
    const Key key = static_cast<Key>(i);
    const KeyRow& row = row_of(key);
    // Neither second exposure nor laser-off frames: they exclude each other.
    if (key == Key::SecondExposureUs) continue;
    Value value{.number = row.kind == KeyRow::Kind::Whole ? 64 : 4.0 / 3 + static_cast<double>(i) * 7};
    if (row.kind == KeyRow::Kind::Word) value.word = row.words.back();
    set.set(key, value);
  }
  const auto again = parse_settings(settings_text(set), "again.yaml");
  SUCCEEDS(again);
  STRCMP_EQUAL("black leather", again->note.c_str());
  for (std::size_t i = 0; i < k_key_count; ++i) {
    const Key key = static_cast<Key>(i);
    CHECK_EQUAL(set.at(key).has_value(), again->at(key).has_value());
    if (!set.at(key)) continue;
    if (row_of(key).kind == KeyRow::Kind::OnOff) {
      CHECK_EQUAL(set.at(key)->on, again->at(key)->on);
    } else {
      STRCMP_EQUAL(value_text(key, *set.at(key)).c_str(), value_text(key, *again->at(key)).c_str());
    }
    CHECK(again->at(key)->line > 0);
  }
}

TEST(Settings, AnEmptySetIsASet) {
  const auto set = parse_settings(settings_text({}), "empty.yaml");
  SUCCEEDS(set);
  CHECK(set->empty());
}

TEST(Settings, EachFaultNamesLineKeyAndWhatIsExpected) {
  FAILS_NAMING(Errc::BadValue,
               "set.yaml line 2, camera.exposure_us: a finite number from 1 to 1e+07 expected",
               parse("camera:\n  exposure_us: .nan"));
  FAILS_NAMING(Errc::BadValue, "set.yaml line 2, camera.exposure_us: a finite number",
               parse("camera:\n  exposure_us: 400 ms"));
  FAILS_NAMING(Errc::UnknownKey, "set.yaml line 2, camera.exposure_ms: not a key of this file",
               parse("camera:\n  exposure_ms: 0.4"));
  FAILS_NAMING(Errc::BadValue, "set.yaml line 3, camera.rate_hz: a finite number from 0.001 to 100000",
               parse("camera:\n  exposure_us: 400\n  rate_hz: -1"));
  FAILS_NAMING(Errc::BadValue, "peaks.mode: one of centre-of-gravity, fir, matched, maximum, threshold",
               parse("peaks: {mode: best}"));
  FAILS_NAMING(Errc::BadValue, "region.width_px: a whole number",
               parse("region: {left_px: 0, top_px: 0, width_px: 20.5, height_px: 32}"));
  FAILS_NAMING(Errc::UnknownKey, "set.yaml line 1, laser_plane: not a key",
               parse("laser_plane: [0, 0, 1, 2]"));
}

TEST(Settings, WhatExcludesEachOtherIsTold) {
  for (const char* other :
       {"laser_off_frames: true", "auto_exposure: true", "follow_stripe: true", "second_exposure_us: 800"})
    FAILS_NAMING(Errc::BadValue, "camera.test_pattern: none of auto_exposure",
                 parse("camera:\n  test_pattern: true\n  " + std::string{other}));
  SUCCEEDS(parse("camera:\n  test_pattern: false\n  auto_exposure: true"));
  FAILS_NAMING(Errc::BadValue, "set.yaml line 3, camera.second_exposure_us: no laser_off_frames beside it",
               parse("camera:\n  laser_off_frames: true\n  second_exposure_us: 800"));
  FAILS_NAMING(Errc::BadValue, "camera.auto_exposure",
               parse("camera: {auto_exposure: on, second_exposure_us: 9}"));
  FAILS_NAMING(Errc::BadValue, "more than exposure_us",
               parse("camera: {exposure_us: 400, second_exposure_us: 300}"));
  FAILS_NAMING(Errc::BadValue, "together", parse("region: {left_px: 8}"));
  FAILS_NAMING(Errc::BadValue, "more than width_min_px", parse("peaks: {width_min_px: 9, width_max_px: 4}"));
}

TEST(Settings, ACutFileIsRefusedWhereverItIsCut) {
  const auto whole =
      parse("note: night shift\ncamera:\n  exposure_us: 400\n  rate_hz: 50\npeaks:\n  choice: first");
  SUCCEEDS(whole);
  const std::string text = settings_text(*whole);
  // Without its last line end nothing is missing.
  for (std::size_t size = 0; size + 1 < text.size(); ++size) {
    const auto cut = parse_settings(text.substr(0, size), "cut.yaml");
    CHECK_FALSE(cut.has_value());
    LONGS_EQUAL(static_cast<int>(Errc::Truncated), static_cast<int>(cut.error().code));
  }
}

TEST(Settings, ComparedByWhatHoldsInTheEnd) {
  const auto left = parse("camera: {exposure_us: 400, gain: 2}\npeaks: {mode: fir}"),
             right = parse("camera: {exposure_us: 500}\npeaks: {mode: fir}");
  const auto differences = compare(*left, *right);
  LONGS_EQUAL(2, differences.size());
  CHECK(differences[0].key == Key::ExposureUs);
  STRCMP_EQUAL("400 us", differences[0].left.c_str());
  STRCMP_EQUAL("500 us", differences[0].right.c_str());
  CHECK(differences[1].key == Key::Gain);
  STRCMP_EQUAL(row_of(Key::Gain).usual, differences[1].right.c_str());
  CHECK(compare(*left, *left).empty());
  const auto told = parse("camera: {exposure_us: 500, auto_exposure: false}\npeaks: {mode: fir}");
  CHECK(compare(*told, *right).empty());
}

TEST(Settings, ToldDefaultsAreThoseOfTheCode) {
  const stripe::PeakConfig peaks;
  const auto is = [](Key key, float value) {
    DOUBLES_EQUAL(static_cast<double>(value), std::stod(row_of(key).usual), 1e-6);
  };
  is(Key::PeakThreshold, peaks.threshold_grey);
  is(Key::PeakWidthMin, peaks.width_min_px);
  is(Key::PeakWidthMax, peaks.width_max_px);
}

}  // namespace biteline::settings
