// SPDX-License-Identifier: MIT
#include "host/apps/biteline/cloud_option.hpp"

#include <map>
#include <string>

namespace biteline::app {

void add_unit_option(options::Command& command, std::optional<cloud::Unit>& unit) {
  const std::map<std::string, cloud::Unit> units{
      {"mm", cloud::Unit::Millimetre}, {"m", cloud::Unit::Metre}, {"in", cloud::Unit::Inch}};
  command.add_choice("--unit", unit, units, "The cloud's unit of length; mm unless told")
      ->type_name("mm|m|in");
}

}  // namespace biteline::app
