// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/controller_door.hpp"

#include <cerrno>

#include "host/robot/link/ur/dashboard.hpp"
#include "host/robot/link/ur/robot_api.hpp"

namespace biteline::robot::ur {

Result<std::unique_ptr<ControllerDoor>> ControllerDoor::open(const DoorPlaces& places, Nanoseconds patience) {
  if (places.dashboard.port == 0) return RobotApi::open(places, patience);
  Result<std::unique_ptr<ControllerDoor>> dashboard = Dashboard::connect(places.dashboard, patience);
  if (dashboard) return dashboard;
  const bool refused = dashboard.error().sys_errno == ECONNREFUSED;  // the machine is there and says no
  const char* none =
      refused ? ": no dashboard server there: PolyScope 3 and 5 have one, PolyScope X has none" : "";
  Error error = dashboard.error();
  if (places.robot_api.port == 0) {
    if (refused) error.where = FixedText<256>::format("%.100s%s", dashboard.error().where.c_str(), none);
    return tl::unexpected<Error>{error};
  }
  Result<std::unique_ptr<ControllerDoor>> api = RobotApi::open(places, patience);
  if (api) return api;
  error.where = FixedText<256>::format("%.60s%s; Robot API: %.100s", dashboard.error().where.c_str(), none,
                                       api.error().where.c_str());
  return tl::unexpected<Error>{error};
}

std::unique_ptr<ControllerDoor> ControllerDoor::closed(const DoorPlaces& places) {
  if (places.dashboard.port != 0) return std::make_unique<Dashboard>(places.dashboard);
  return std::make_unique<RobotApi>(places);
}

Result<ControllerWords> ask_controller(const DoorPlaces& places, Nanoseconds patience) {
  BITELINE_ASSIGN(const std::unique_ptr<ControllerDoor> door, ControllerDoor::open(places, patience));
  return door->words(patience);
}

}  // namespace biteline::robot::ur
