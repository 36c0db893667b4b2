// SPDX-License-Identifier: MIT
#include "hal/sim/robot/rsi_exchange.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace biteline::sim {
namespace {

struct Angles {
  double a_deg, b_deg, c_deg;
};

/// About Z, then Y', then X''.
Angles angles_of(const Mat3& R) {
  constexpr double k_deg_per_rad = 180 / std::numbers::pi;
  const double across = std::hypot(R(0, 0), R(1, 0));
  const bool upright = across < 1e-9;  // A and C turn about the same line: A takes it all
  const double a_rad = upright ? std::atan2(-R(0, 1), R(1, 1)) : std::atan2(R(1, 0), R(0, 0));
  const double c_rad = upright ? 0 : std::atan2(R(2, 1), R(2, 2));
  return {.a_deg = k_deg_per_rad * a_rad,
          .b_deg = k_deg_per_rad * std::atan2(-R(2, 0), across),
          .c_deg = k_deg_per_rad * c_rad};
}

}  // namespace

Result<RsiExchange> RsiExchange::open(const Config& config) {
  BITELINE_ASSIGN(UdpSender sender, UdpSender::open(config.port));
  return RsiExchange{config, std::move(sender)};
}

std::string RsiExchange::message(std::int64_t ipoc_ms, const SE3& T_base_flange, int unanswered) {
  const Vec3 place_mm = T_base_flange.translation();
  const Angles angles = angles_of(T_base_flange.linear());
  std::array<char, 512> text{};
  const int size = std::snprintf(
      text.data(), text.size(),
      "<Rob Type=\"KUKA\"><RIst X=\"%.6f\" Y=\"%.6f\" Z=\"%.6f\" A=\"%.6f\" B=\"%.6f\" C=\"%.6f\"/>"
      "<Delay D=\"%d\"/><IPOC>%lld</IPOC></Rob>",
      place_mm.x(), place_mm.y(), place_mm.z(), angles.a_deg, angles.b_deg, angles.c_deg, unanswered,
      static_cast<long long>(ipoc_ms));
  return {text.data(), static_cast<std::size_t>(size)};
}

void RsiExchange::hear() {
  const std::string expected = "<Sen Type=\"ImFree\"><IPOC>" + std::to_string(ipoc_ms_) + "</IPOC></Sen>";
  bool answered = false;
  while (const std::optional<std::string> said = sender_.receive()) {
    const bool right = *said == expected;
    answered = answered || right;
    ++(right ? counts_.answered : counts_.wrong);
  }
  counts_.unanswered = answered ? 0 : counts_.unanswered + 1;
}

void RsiExchange::step(SensorClock::time_point instant, const SE3& T_base_flange) {
  if (counts_.ended) return;
  if (counts_.sent > 0 && !config_.only_sends) hear();
  counts_.ended = counts_.unanswered >= config_.unanswered_most;
  if (counts_.ended) return;
  ipoc_ms_ = (instant.time_since_epoch() + config_.clock_offset).count() / 1'000'000;
  const std::string text = message(ipoc_ms_, T_base_flange, counts_.unanswered);
  sender_.send({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  ++counts_.sent;
}

}  // namespace biteline::sim
