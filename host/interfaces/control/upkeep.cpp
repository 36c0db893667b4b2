// SPDX-License-Identifier: MIT
#include "host/interfaces/control/upkeep.hpp"

namespace biteline::control {

Json to_json(const wire::UpkeepState& upkeep) {
  const auto degc = [](const std::optional<float>& told) { return told ? Json(*told) : Json{}; };
  return {{"starts", upkeep.starts},
          {"boots", upkeep.boots},
          {"run_s", upkeep.run_s},
          {"laser_s", upkeep.laser_s},
          {"lightings", upkeep.lightings},
          {"frames", upkeep.frames},
          {"coldest_degc", degc(upkeep.coldest_degc)},
          {"hottest_degc", degc(upkeep.hottest_degc)}};
}

}  // namespace biteline::control
