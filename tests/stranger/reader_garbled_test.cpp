// SPDX-License-Identifier: MIT
// The users' reader in C++ against the library's own messages: the same numbers; and garbled ones cost a
// message, no more.
#include "host/records/reader/biteline_scan.hpp"

#include <CppUTest/TestHarness.h>

#include <random>

#include "common/wire/messages.hpp"
#include "tests/support/made_head.hpp"
#include "tests/support/made_profile.hpp"

namespace biteline {

TEST_GROUP(UsersReader) {
  biteline_scan::Decoder decoder;

  static wire::Bytes encoded(wire::Body body) {
    wire::Bytes bytes;
    wire::encode({.scan_id = 0x1122'3344'5566'7788, .sequence = 9, .body = std::move(body)}, bytes);
    return bytes;
  }
  static void sign(wire::Bytes & bytes) {
    const std::uint32_t crc = biteline_scan::detail::crc32c(bytes.data(), bytes.size() - 4);
    for (std::size_t i = 0; i < 4; ++i)
      bytes[bytes.size() - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  }
};

TEST(UsersReader, HasEveryBitOfAProfile) {
  wire::SensorHello hello;
  hello.model = test::made_head(1626, 320);
  hello.model.T_flange_cam.translation() = Vec3{1, 2, 3};
  const wire::Bytes first = encoded(hello);
  CHECK(decoder.read(first.data(), first.size()).has_value());
  const profile::Profile made = test::made_profile(6, 700);
  const wire::Bytes bytes = encoded(made);
  const auto read = decoder.read(bytes.data(), bytes.size());
  CHECK(read && read->profile);
  const biteline_scan::Profile& profile = *read->profile;
  CHECK(profile.scan_id == 0x1122'3344'5566'7788 && read->sequence == 9);
  LONGS_EQUAL(made.header.flags, profile.flags);
  LONGS_EQUAL(made.header.exposure_mid.time_since_epoch().count(), profile.exposure_mid_ns);
  DOUBLES_EQUAL(3, profile.T_flange_cam[11], 0);
  CHECK(made.header.encoder_ticks && profile.encoder_ticks == made.header.encoder_ticks);
  CHECK(made.header.speckle_contrast && profile.speckle_contrast == made.header.speckle_contrast);
  LONGS_EQUAL(made.points.size(), profile.x.size());
  for (int i = 0; i < 12; ++i) {
    const SE3& flange = made.header.T_base_flange;
    DOUBLES_EQUAL(i < 9 ? flange.linear()(i / 3, i % 3) : flange.translation()[i - 9],
                  profile.T_base_flange[static_cast<std::size_t>(i)], 0);
  }
  for (std::size_t i = 0; i < made.points.size(); ++i) {
    const profile::ProfilePoint& point = made.points[i];
    CHECK(point.point_cam == Eigen::Vector3f(profile.x[i], profile.y[i], profile.z[i]));
    CHECK(point.sigma_mm == profile.sigma_mm[i] && point.row_px == profile.row_px[i]);
    CHECK(point.sigma_row_px == profile.sigma_row_px[i] && point.amplitude == profile.amplitude[i]);
    CHECK(point.width_px == profile.width_px[i] && point.column == profile.column[i]);
    CHECK(point.flags == profile.point_flags[i] && point.peak_count == profile.peak_count[i]);
  }
}

TEST(UsersReader, AnEncodersCountIsAbsentWhereNoneIsThePose) {
  const wire::Bytes bytes = encoded(test::made_profile(5, 3));
  const auto read = decoder.read(bytes.data(), bytes.size());
  CHECK(read && read->profile && !read->profile->encoder_ticks && !read->profile->speckle_contrast);
}

TEST(UsersReader, SaysWhatTheSensorUnderstands) {
  const auto hello = wire::decode(biteline_scan::host_hello());
  CHECK(hello && std::holds_alternative<wire::HostHello>(hello->body));
  CHECK_FALSE(std::get<wire::HostHello>(hello->body).resume);
  const auto control = wire::decode(biteline_scan::start_scan());
  CHECK(control && std::get<wire::Control>(control->body).command == wire::Command::StartScan);
  LONGS_EQUAL(1, std::get<wire::Control>(control->body).id);
  const auto ack = wire::decode(biteline_scan::ack(0x1122'3344'5566'7788, 0x0102'0304'0506));
  CHECK(ack && ack->scan_id == 0x1122'3344'5566'7788);
  CHECK(std::get<wire::Ack>(ack->body).safe_sequence == 0x0102'0304'0506);
}

TEST(UsersReader, GarbledMessagesCostThemselves) {
  const wire::Bytes good = encoded(test::made_profile(4, 60));
  std::mt19937 random{11};
  int taken = 0;
  for (int turn = 0; turn < 60'000; ++turn) {
    wire::Bytes bytes = good;
    for (std::uint32_t changes = 1 + random() % 3; changes > 0; --changes)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (random() % 8 == 0) bytes.resize(random() % bytes.size());
    // As a sensor that lies would sign it; else the checksum alone would find all.
    if (bytes.size() > 4) sign(bytes);
    // On the heap and of its own length, so that a sanitizer sees a byte too many.
    const auto read = decoder.read(bytes.data(), bytes.size());
    if (read && read->profile) {
      ++taken;
      LONGS_EQUAL(read->profile->x.size(), read->profile->peak_count.size());
    }
  }
  CHECK(taken > 0);
  wire::Bytes unsigned_bytes = good;
  unsigned_bytes[100] ^= 1U;
  CHECK_FALSE(decoder.read(unsigned_bytes.data(), unsigned_bytes.size()).has_value());
}

}  // namespace biteline
