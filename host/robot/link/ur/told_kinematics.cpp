// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/told_kinematics.hpp"

#include <cmath>

#include "common/rtde/big_endian.hpp"
#include "host/robot/link/ur/hear_primary.hpp"
#include "host/robot/link/ur/primary_messages.hpp"

namespace biteline::robot::ur {
namespace {

constexpr std::uint8_t k_robot_state = 16, k_kinematics = 5;
constexpr double k_mm_per_m = 1000, k_most_rad = 7, k_most_m = 1e4;

Result<ToldKinematics> read(std::span<const std::uint8_t> body) {
  constexpr std::size_t k_bytes = 6 * 4 + 4 * 6 * 8 + 4;
  if (body.size() < k_bytes)
    return fail(Errc::BadFormat, "kinematics info of %zu bytes, %zu expected", body.size(), k_bytes);
  rtde::Reader reader{body};
  for (int joint = 0; joint < 6; ++joint) static_cast<void>(reader.get<std::uint32_t>());  // check sums
  ToldKinematics told;
  bool sane = true;
  const auto number = [&](double most) {
    const double value = reader.get<double>().value_or(NAN);
    sane = sane && std::isfinite(value) && std::abs(value) <= most;
    return value;
  };
  for (kinematics::DhRow& row : told.rows) row.theta_rad = number(k_most_rad);
  for (kinematics::DhRow& row : told.rows) row.a_mm = k_mm_per_m * number(k_most_m);
  for (kinematics::DhRow& row : told.rows) row.d_mm = k_mm_per_m * number(k_most_m);
  for (kinematics::DhRow& row : told.rows) row.alpha_rad = number(k_most_rad);
  told.status = reader.get<std::uint32_t>().value_or(0);
  if (!sane) return fail(Errc::BadFormat, "kinematics info with numbers that no arm has");
  return told;
}

}  // namespace

Result<std::optional<ToldKinematics>> kinematics_in(std::span<const std::uint8_t> heard) {
  for (;;) {
    BITELINE_ASSIGN(const std::optional<Part> message, take_part(heard));
    if (!message) return std::optional<ToldKinematics>{};
    if (message->type != k_robot_state) continue;
    std::span<const std::uint8_t> parts = message->body;
    for (;;) {
      BITELINE_ASSIGN(const std::optional<Part> part, take_part(parts));
      if (!part) break;
      if (part->type != k_kinematics) continue;
      BITELINE_ASSIGN(const ToldKinematics told, read(part->body));
      return std::optional{told};
    }
  }
}

Result<ToldKinematics> ask_kinematics(const Endpoint& script, Nanoseconds patience) {
  return hear_primary<ToldKinematics>(script, patience, "its arm's kinematics", &kinematics_in);
}

}  // namespace biteline::robot::ur
