// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/told_kinematics.hpp"

#include <CppUTest/TestHarness.h>

#include <limits>
#include <vector>

#include "common/rtde/big_endian.hpp"
#include "tests/support/errors.hpp"
#include "tests/unit/host/robot/link/said_bytes.hpp"

namespace biteline::robot::ur {
namespace {

using test::Bytes;
using test::framed;
using test::joined;

/// theta i, a 10 + i, d 20 + i, alpha i / 10, each of joint i; a and d in metres.
Bytes info(double theta = 0) {
  Bytes out;
  rtde::Writer writer{out};
  for (int i = 0; i < 6; ++i) writer.put(std::uint32_t{7});
  for (int i = 0; i < 6; ++i) writer.put(theta + i);
  for (int i = 0; i < 6; ++i) writer.put(10.0 + i);
  for (int i = 0; i < 6; ++i) writer.put(20.0 + i);
  for (int i = 0; i < 6; ++i) writer.put(0.1 * i);
  writer.put(std::uint32_t{3});
  return out;
}

}  // namespace

TEST_GROUP(ToldKinematics){};

TEST(ToldKinematics, AreFoundAmongOtherPartsAndMessages) {
  const Bytes version = framed(20, Bytes(30, 1)), mode = framed(0, Bytes(42, 9));
  const Bytes stream = joined(
      {version, framed(16, mode), framed(16, joined({mode, framed(5, info()), framed(6, Bytes(80, 2))}))});
  const auto sut = kinematics_in(stream);
  SUCCEEDS(sut);
  CHECK(sut->has_value());
  for (int i = 0; i < 6; ++i) {
    const kinematics::DhRow& row = (*sut)->rows[static_cast<std::size_t>(i)];
    DOUBLES_EQUAL(i, row.theta_rad, 0);
    DOUBLES_EQUAL(10'000 + 1000 * i, row.a_mm, 0);
    DOUBLES_EQUAL(20'000 + 1000 * i, row.d_mm, 0);
    DOUBLES_EQUAL(0.1 * i, row.alpha_rad, 0);
  }
  LONGS_EQUAL(3, (*sut)->status);
}

TEST(ToldKinematics, NothingUntilTheMessageIsWhole) {
  const Bytes whole = framed(16, framed(5, info()));
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    const auto sut = kinematics_in(std::span{whole}.first(bytes));
    SUCCEEDS(sut);
    CHECK_FALSE(sut->has_value());
  }
  CHECK(kinematics_in(whole)->has_value());
}

TEST(ToldKinematics, WhatIsNoneOfThatInterfaceIsToldSo) {
  FAILS_NAMING(Errc::BadFormat, "a message of", kinematics_in(Bytes{'S', 'S', 'H', '-', '2', '.', '0'}));
  FAILS_NAMING(Errc::BadFormat, "a message of 4 bytes", kinematics_in(Bytes{0, 0, 0, 4, 16}));
  FAILS_NAMING(Errc::BadFormat, "kinematics info of 12 bytes",
               kinematics_in(framed(16, framed(5, Bytes(12)))));
  for (const double theta : {std::numeric_limits<double>::quiet_NaN(), 1e9})
    FAILS_NAMING(Errc::BadFormat, "no arm has", kinematics_in(framed(16, framed(5, info(theta)))));
}

}  // namespace biteline::robot::ur
