// SPDX-License-Identifier: MIT
// A datagram of a robot controller, EGM or RSI: it is refused in clean words, or is a pose.
#include "hal/linux/udp_poses/egm_message.hpp"
#include "hal/linux/udp_poses/rsi_message.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case bytes{data, size};
  const bool egm = bytes.take<std::uint8_t>() % 2 == 0;
  const std::vector<std::uint8_t> message = bytes.rest();
  const Result<hal::ToldPose> told = egm ? hal::read_egm(message) : hal::read_rsi(message);
  if (!told) {
    fuzz::demand_clean(told.error());
    return 0;
  }
  const SE3& T = told->T_base_flange;
  fuzz::demand(T.matrix().allFinite(), "a pose is finite");
  fuzz::demand((T.linear() * T.linear().transpose() - Mat3::Identity()).norm() < 1e-9, "a pose turns");
  fuzz::demand(told->stamp.time_since_epoch().count() >= 0, "a stamp is not before the clock's beginning");
  return 0;
}
