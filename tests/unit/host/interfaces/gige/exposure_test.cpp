// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/exposure.hpp"

#include <CppUTest/TestHarness.h>

#include <bit>

#include "host/interfaces/gige/frame.hpp"

namespace biteline {

TEST_GROUP(GigeExposure){static std::uint64_t long_at(const std::vector<std::uint8_t>& record,
                                                      std::size_t at){std::uint64_t value = 0;
for (std::size_t i = 0; i < 8; ++i) value = value << 8U | record[at + i];
return value;
}  // namespace biteline
}
;

TEST(GigeExposure, WhatIsInForceGoesBeforeWhatTheHeadWasTold) {
  constexpr Nanoseconds k_before{1'000};
  wire::SensorHello hello;
  CHECK(gige::exposure_of(hello) == Nanoseconds{0});
  hello.model.exposure = Nanoseconds{400'000};
  CHECK(gige::exposure_of(hello) == Nanoseconds{400'000});
  wire::Health health;
  CHECK(gige::exposure_of(health, k_before) == k_before);
  health.settings = wire::SettingsState{.text = "camera:\n  rate_hz: 50\n...\n"};
  CHECK(gige::exposure_of(health, k_before) == k_before);
  health.settings->text = "camera: [";
  CHECK(gige::exposure_of(health, k_before) == k_before);
  health.settings->text = "camera:\n  exposure_us: 250.5\n...\n";
  CHECK(gige::exposure_of(health, k_before) == Nanoseconds{250'500});
  // The automatic exposure goes its own way.
  health.devices.capture = wire::CaptureState{.exposure = Nanoseconds{300'000}};
  CHECK(gige::exposure_of(health, k_before) == Nanoseconds{300'000});
}

TEST(GigeExposure, ARecordTellsItAndTheCountsBehindThePose) {
  profile::ProfileHeader header;
  header.sequence = 5;
  header.frame_sequence = 0x1122334455667788;
  const auto record = gige::line_record(3, header, Nanoseconds{250'500});
  LONGS_EQUAL(160, record.size());
  CHECK(long_at(record, 16) == 5);
  DOUBLES_EQUAL(250.5, std::bit_cast<double>(long_at(record, 128)), 0);
  CHECK(long_at(record, 136) == 0x1122334455667788);
  CHECK(long_at(record, 144) == 0 && long_at(record, 152) == 0);
  header.encoder_ticks = -3;
  const auto counted = gige::line_record(3, header, Nanoseconds{250'500});
  CHECK(long_at(counted, 144) == ~std::uint64_t{2});
  CHECK(long_at(counted, 152) == 1ULL << 32U);
}

}  // namespace biteline
