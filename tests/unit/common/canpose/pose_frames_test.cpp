// SPDX-License-Identifier: MIT
#include "common/canpose/pose_frames.hpp"

#include <CppUTest/TestHarness.h>

#include <numbers>
#include <random>
#include <string_view>

#include "tests/support/transforms.hpp"

namespace biteline::canpose {
namespace {

// Half a step per axis, three axes (POSE_FRAMES.md), and the rounding of the arithmetic.
constexpr double k_tol_mm = 0.5e-4 * 1.7321 + 1e-9;
constexpr double k_tol_classic_rad = 0.5 / (1 << 21) * 1.7321 + 1e-9;
constexpr double k_tol_fd_rad = 2 * 0.5 / (1 << 30) * 2 + 1e-8;

PoseMessage random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> mm{-1500, 1500};
  std::normal_distribution<double> part;
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond{part(random), part(random), part(random), part(random)}.normalized();
  PoseMessage pose{.sync_counter = static_cast<std::uint8_t>(1 + random() % k_sync_counter_last),
                   .status = static_cast<std::uint8_t>(random()),
                   .stamp_us = random()};
  pose.T_base_flange = geometry::make_se3(rotation, {mm(random), mm(random), mm(random)});
  return pose;
}

TEST_GROUP(PoseFrames){};

TEST(PoseFrames, CheckSumIsTheCataloguedOne) {
  constexpr std::string_view digits = "123456789";
  CHECK_EQUAL(0x29B1, crc16({reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size()}));
}

TEST(PoseFrames, ClassicFormKeepsThePoseToItsStep) {
  std::mt19937 random{1};
  for (int i = 0; i < 500; ++i) {
    const PoseMessage pose = random_pose(random);
    const Result<PoseMessage> back = decode_classic(encode_classic(pose).value());
    CHECK(back.has_value());
    TRANSFORMS_EQUAL(pose.T_base_flange, back->T_base_flange, k_tol_mm, k_tol_classic_rad);
    CHECK_EQUAL(pose.status, back->status);
    CHECK_EQUAL(pose.sync_counter, back->sync_counter);
    CHECK(pose.stamp_us == back->stamp_us);
  }
}

TEST(PoseFrames, FdFormKeepsThePoseToItsStep) {
  std::mt19937 random{2};
  for (int i = 0; i < 500; ++i) {
    PoseMessage pose = random_pose(random);
    pose.stamp_us |= std::uint64_t{5} << 40U;
    const Result<PoseMessage> back = decode_fd(encode_fd(pose).value());
    CHECK(back.has_value());
    TRANSFORMS_EQUAL(pose.T_base_flange, back->T_base_flange, k_tol_mm, k_tol_fd_rad);
    CHECK(pose.stamp_us == back->stamp_us);
  }
}

TEST(PoseFrames, HalfATurnSurvivesTheClassicForm) {
  PoseMessage pose{.sync_counter = 1};
  pose.T_base_flange.linear() = geometry::exp_so3({std::numbers::pi, 0, 0});
  const Result<PoseMessage> back = decode_classic(encode_classic(pose).value());
  CHECK(back.has_value());
  TRANSFORMS_EQUAL(pose.T_base_flange, back->T_base_flange, k_tol_mm, k_tol_classic_rad);
}

TEST(PoseFrames, BytesStandWhereTheDocumentSays) {
  PoseMessage pose{.sync_counter = 7, .status = k_program_running, .stamp_us = 0x0A0B0C0D};
  pose.T_base_flange.translation() = Vec3{0.1, -0.1, 100};  // 1000, -1000, 1000000 steps
  const ClassicFrames frames = encode_classic(pose).value();
  CHECK(frames[0] == (ClassicData{7, 0xE8, 0x03, 0, 0, 0x18, 0xFC, 0xFF}));
  CHECK(frames[1] == (ClassicData{7, 0xFF, 0x40, 0x42, 0x0F, 0, 0, 0}));
  CHECK(frames[2] == (ClassicData{7, 0, 0, 0, 0, 0, 0, 0}));
  CHECK_EQUAL(0x0D, frames[3][2]);
  const FdFrame fd = encode_fd(pose).value();
  CHECK_EQUAL(1, fd[0]);
  CHECK_EQUAL(7, fd[1]);
  CHECK_EQUAL(0x40, fd[27]);  // w = 1: 2^30
}

TEST(PoseFrames, EverySingleBitFlipIsNoticed) {
  std::mt19937 random{3};
  const PoseMessage pose = random_pose(random);
  for (std::size_t bit = 0; bit < 8 * k_classic_size_bytes * k_classic_frames; ++bit) {
    ClassicFrames frames = encode_classic(pose).value();
    frames[bit / 64][bit % 64 / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    CHECK_FALSE(decode_classic(frames).has_value());
  }
  for (std::size_t bit = 0; bit < 8 * k_fd_size_bytes; ++bit) {
    FdFrame frame = encode_fd(pose).value();
    frame[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    CHECK_FALSE(decode_fd(frame).has_value());
  }
}

TEST(PoseFrames, WellSummedNonsenseIsRefused) {
  PoseMessage pose{.sync_counter = 3};
  FdFrame frame = encode_fd(pose).value();
  const auto resum = [&] {
    const std::uint16_t crc = crc16(std::span{frame}.first(46));
    frame[46] = static_cast<std::uint8_t>(crc);
    frame[47] = static_cast<std::uint8_t>(crc >> 8U);
  };
  frame[27] = 0x20;  // w = 0.5 alone is no rotation
  resum();
  CHECK_FALSE(decode_fd(frame).has_value());
  frame = encode_fd(pose).value();
  frame[11] = 0xFF;  // a stamp beyond any clock
  resum();
  CHECK_FALSE(decode_fd(frame).has_value());
  for (const std::uint8_t counter : {std::uint8_t{0}, std::uint8_t{241}}) {
    pose.sync_counter = counter;
    CHECK_FALSE(decode_classic(encode_classic(pose).value()).has_value());
    CHECK_FALSE(decode_fd(encode_fd(pose).value()).has_value());
  }
}

TEST(PoseFrames, AnyLengthOfFdDataIsReadWithinItsBounds) {
  std::mt19937 random{4};
  for (std::size_t size = 0; size <= 64; ++size) {
    std::vector<std::uint8_t> data(size);
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
    CHECK_FALSE(decode_fd(data).has_value());
  }
}

TEST(PoseFrames, TranslationBeyondTheFieldIsRefusedNotWrapped) {
  PoseMessage pose{.sync_counter = 1};
  pose.T_base_flange.translation().x() = 3e5;
  CHECK_FALSE(encode_classic(pose).has_value());
  CHECK_FALSE(encode_fd(pose).has_value());
}

}  // namespace
}  // namespace biteline::canpose
