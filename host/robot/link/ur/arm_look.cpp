// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/arm_look.hpp"

#include "host/robot/link/follow.hpp"
#include "host/robot/link/ur/ur_link.hpp"

namespace biteline::robot::ur {

Result<ArmLook> look_at_arm(const std::string& host, std::uint16_t rtde_port) {
  UrLink::Config config;
  config.host = host;
  config.rtde_port = rtde_port;
  config.ask_payload = true;
  Result<std::unique_ptr<UrLink>> link = UrLink::open(config);
  if (!link && link.error().code != Errc::ConnectFailed) {
    // An older controller says everything but its payload.
    config.ask_payload = false;
    link = UrLink::open(config);
  }
  if (!link) return tl::unexpected<Error>{link.error()};
  return look_at_arm(**link);
}

Result<ArmLook> look_at_arm(const RobotLink& link) {
  const Result<RobotState> state = wait_until_still(link, {.patience_s = 1});
  if (!state && state.error().code == Errc::Timeout)
    return fail(Errc::WrongState, "%.200s; touch when it stands", state.error().where.c_str());
  if (!state) return tl::unexpected<Error>{state.error()};
  return ArmLook{.T_base_flange = state->T_base_tcp * state->T_flange_tcp.inverse(),
                 .tip_flange = state->T_flange_tcp.translation(),
                 .payload = state->payload};
}

}  // namespace biteline::robot::ur
