// SPDX-License-Identifier: MIT
#include "common/arm_link/messages.hpp"

#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <random>
#include <string_view>

#include "tests/support/errors.hpp"
#include "tests/support/fuzz.hpp"
#include "tests/support/transforms.hpp"

namespace biteline::arm_link {
namespace {

// 32-bit numbers: half a step at 1000 mm and at 1 rad.
constexpr double k_tol_mm = 1e-4, k_tol_rad = 1e-6, k_tol_ratio = 1e-6;

SE3 somewhere() {
  SE3 T = SE3::Identity();
  T.translation() = Vec3{812.5, -340.25, 120.125};
  T.linear() = geometry::exp_so3({0.4, -1.2, 0.9});
  return T;
}

Joints posture() {
  Joints q_rad;
  q_rad << 0.5, -1.8, 1.6, -1.4, -1.57, 6.1;
  return q_rad;
}

template <class Kind>
Kind back(const Kind& body) {
  const Result<Received> received = decode(encode(7, body));
  SUCCEEDS(received);
  CHECK_EQUAL(7U, received->number);
  CHECK(std::holds_alternative<Kind>(received->body));
  return std::get<Kind>(received->body);
}

Message with_sum(Message message) {
  Sum sum;
  sum.add(std::span{message}.first(k_message_bytes - k_sum_bytes));
  for (std::size_t i = 0; i < k_sum_bytes; ++i)
    message[k_message_bytes - k_sum_bytes + i] = static_cast<std::uint8_t>(sum.value() >> (8 * i));
  return message;
}

TEST_GROUP(ArmLinkMessages){};

TEST(ArmLinkMessages, ComeBackAsTheyWere) {
  const PathBegin begin = back(PathBegin{.path = 9,
                                         .points = 700,
                                         .T_flange_tcp = somewhere(),
                                         .mass_kg = 1.25,
                                         .centre_flange_mm = {1, -2, 50.5},
                                         .output = -1});
  CHECK_EQUAL(9U, begin.path);
  CHECK_EQUAL(700U, begin.points);
  TRANSFORMS_EQUAL(somewhere(), begin.T_flange_tcp, k_tol_mm, k_tol_rad);
  DOUBLES_EQUAL(1.25, begin.mass_kg, 0);
  DOUBLES_EQUAL(50.5, begin.centre_flange_mm.z(), 0);
  CHECK_EQUAL(-1, begin.output);

  const PathPoint point = back(PathPoint{.path = 9,
                                         .index = 300,
                                         .move = PathPoint::Move::Joint,
                                         .tool_on = true,
                                         .T_base_tcp = somewhere(),
                                         .q_rad = posture(),
                                         .speed = 0.5,
                                         .acceleration = 1.4,
                                         .blend_mm = 2});
  CHECK_EQUAL(300U, point.index);
  CHECK(point.move == PathPoint::Move::Joint && point.tool_on);
  TRANSFORMS_EQUAL(somewhere(), point.T_base_tcp, k_tol_mm, k_tol_rad);
  DOUBLES_EQUAL(0, (point.q_rad - posture()).norm(), k_tol_rad);
  DOUBLES_EQUAL(0.5, point.speed, 0);
  DOUBLES_EQUAL(1.4, point.acceleration, k_tol_ratio);
  DOUBLES_EQUAL(2, point.blend_mm, 0);

  const State state = back(State{.stamp_us = 4'000'000'000'000,
                                 .T_base_tcp = somewhere(),
                                 .T_flange_tcp = somewhere().inverse(Eigen::Isometry),
                                 .q_rad = posture(),
                                 .phase = Phase::Running,
                                 .powered = true,
                                 .safe = true,
                                 .outputs = 0x81,
                                 .path = 9,
                                 .index = 1999,
                                 .fault = Fault::DeadMan,
                                 .speed_ratio = 0.25});
  CHECK(state.stamp_us == 4'000'000'000'000);
  TRANSFORMS_EQUAL(somewhere().inverse(Eigen::Isometry), state.T_flange_tcp, k_tol_mm, k_tol_rad);
  CHECK(state.phase == Phase::Running && state.powered && state.safe);
  CHECK_EQUAL(0x81, state.outputs);
  CHECK_EQUAL(1999, state.index);
  CHECK(state.fault == Fault::DeadMan);
  DOUBLES_EQUAL(0.25, state.speed_ratio, 0);

  const Robot robot =
      back(Robot{.make = "a name of more than twenty-four letters", .model = "m", .serial = "", .joints = 6});
  STRCMP_EQUAL("a name of more than twen", robot.make.c_str());
  STRCMP_EQUAL("m", robot.model.c_str());
  CHECK_EQUAL(0xFFFF0001U, back(Go{.path = 9, .sum = 0xFFFF0001U}).sum);
  CHECK_EQUAL(12U, back(PathSum{.path = 9, .points = 12, .sum = 3}).points);
  CHECK(back(Refusal{.of = 5, .reason = Reason::Stale}).reason == Reason::Stale);
  CHECK_EQUAL(9U, back(PathEnd{.path = 9}).path);
  static_cast<void>(back(Hello{}));
  static_cast<void>(back(Stop{}));
  static_cast<void>(back(Beat{}));
}

/// By the tables of docs/other-arms.md: mark "ALNK", version, kind, count, sum last.
TEST(ArmLinkMessages, StandInBytesAsTheTablesSay) {
  const Message go = encode(0x01020304, Go{.path = 0x0A0B0C0D, .sum = 0x11223344});
  const std::array<std::uint8_t, 24> expected{
      'A', 'L', 'N', 'K', 1, 5, 0, 0, 4, 3, 2, 1, 0, 0, 0, 0, 0x0D, 0x0C, 0x0B, 0x0A, 0x44, 0x33, 0x22, 0x11};
  MEMCMP_EQUAL(expected.data(), go.data(), expected.size());
  // RFC 1950's sum; of "Wikipedia" it is known.
  Sum sum;
  const std::string_view known = "Wikipedia";
  sum.add({reinterpret_cast<const std::uint8_t*>(known.data()), known.size()});
  CHECK_EQUAL(0x11E60398U, sum.value());
}

TEST(ArmLinkMessages, OneBitThatIsAnotherIsSeen) {
  const Message good = encode(1, PathPoint{.path = 1, .q_rad = posture(), .speed = 100, .acceleration = 500});
  for (std::size_t bit = 0; bit < 8 * k_message_bytes; ++bit) {
    Message bad = good;
    bad[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    CHECK_FALSE(decode(bad).has_value());
  }
}

TEST(ArmLinkMessages, WhatIsNoneIsRefusedInWords) {
  FAILS_NAMING(Errc::ProtocolError, "no message of it", decode(Message{}));
  Message message = encode(1, Beat{});
  message[4] = 2;
  FAILS_NAMING(Errc::ProtocolError, "version 2, 1 expected", decode(with_sum(message)));
  message = encode(1, Beat{});
  message[5] = 64;
  FAILS_NAMING(Errc::ProtocolError, "kind 64 is not known", decode(with_sum(message)));
  FAILS_NAMING(Errc::BadValue, "without sound numbers", decode(encode(1, PathPoint{.speed = -1})));
  FAILS_NAMING(Errc::BadValue, "without sound numbers",
               decode(encode(1, PathPoint{.speed = std::numeric_limits<double>::infinity()})));
  Message point = encode(1, PathPoint{});
  point[24] = 2;  // the kind of move
  FAILS_NAMING(Errc::BadValue, "without sound numbers", decode(with_sum(point)));
}

TEST(ArmLinkMessages, AStreamIsCutAndItsCountIsWatched) {
  Reader sut;
  CHECK_FALSE((*sut.next()).has_value());
  std::vector<std::uint8_t> stream;
  for (const std::uint32_t number : {5U, 6U, 8U}) {
    const Message message = encode(number, Beat{});
    stream.insert(stream.end(), message.begin(), message.end());
  }
  sut.add(std::span{stream}.first(200));
  CHECK_EQUAL(5U, (**sut.next()).number);
  CHECK_FALSE((*sut.next()).has_value());
  sut.add(std::span{stream}.subspan(200));
  CHECK_EQUAL(6U, (**sut.next()).number);
  FAILS_NAMING(Errc::ProtocolError, "message 8 after 6", sut.next());
}

/// Spoilt, with a sum that fits again: refused, or of sound numbers.
TEST(ArmLinkMessages, SpoiltOnesAreRefusedOrSound) {
  std::mt19937_64 random{5};
  const std::array<Body, 4> bodies{PathBegin{}, PathPoint{}, State{}, Refusal{}};
  int refused = 0, taken = 0;
  for (int i = 0; i < 20000 * test::fuzz_factor(); ++i) {
    Message message = encode(1, bodies[random() % bodies.size()]);
    for (std::uint64_t changes = 1 + random() % 4; changes > 0; --changes)
      message[random() % (k_message_bytes - k_sum_bytes)] = static_cast<std::uint8_t>(random());
    const Result<Received> received = decode(with_sum(message));
    ++(received ? taken : refused);
    if (!received) continue;
    if (const auto* point = std::get_if<PathPoint>(&received->body))
      CHECK(point->T_base_tcp.matrix().allFinite() && point->q_rad.allFinite() && point->speed >= 0);
  }
  CHECK(refused > 1000 && taken > 1000);
  std::feclearexcept(FE_UNDERFLOW);  // of numbers next to nothing
}

}  // namespace
}  // namespace biteline::arm_link
