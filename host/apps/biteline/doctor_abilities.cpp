// SPDX-License-Identifier: MIT
#include "host/apps/biteline/doctor_abilities.hpp"

#include <array>
#include <string_view>

namespace biteline::app {
namespace {

/// What must be ready; an entry stands for all findings that begin with it.
struct Rule {
  std::string_view what;
  std::array<std::string_view, 5> needs;
  bool only_where_looked_at{false};
};

constexpr std::array k_rules{
    Rule{"work out recordings and plan paths", {}},
    Rule{"run the simulated cell (./run demo)",
         {"program biteline-sensor", "program biteline-host", "program biteline-cell", "processors",
          "clock source"}},
    Rule{"serve a cell whose sensor is on the network", {"program biteline-host", "processors"}},
    Rule{"scan with a V4L2 camera on this machine",
         {"program biteline-sensor", "V4L2 camera", "GPIO", "clock source"}},
    Rule{"scan with a GigE camera on this machine",
         {"program biteline-sensor", "network receive buffer", "GPIO", "clock source"}},
    Rule{"trigger camera and laser by hardware", {"PWM"}},
    Rule{"take poses over CAN", {"CAN interface"}},
    Rule{"keep the frames' deadlines beside other work",
         {"real-time kernel", "real-time priority", "locked memory"}},
    Rule{"scan with this board", {"board: "}, true},
    Rule{"send paths to this robot", {"robot at "}, true},
};

}  // namespace

std::string Ability::because() const {
  std::string all;
  for (const std::string& one : missing) all += (all.empty() ? "" : "; ") + one;
  return all;
}

std::vector<Ability> abilities_of(const std::vector<Finding>& findings) {
  std::vector<Ability> abilities;
  for (const Rule& rule : k_rules) {
    Ability ability{.what = std::string{rule.what}, .missing = {}};
    bool looked_at = !rule.only_where_looked_at;
    for (const Finding& finding : findings) {
      bool needed = false;
      for (const std::string_view need : rule.needs)
        needed = needed || (!need.empty() && finding.what.starts_with(need));
      if (!needed) continue;
      looked_at = true;
      if (!finding.ready) ability.missing.push_back(finding.what + ": " + finding.seen);
    }
    if (looked_at) abilities.push_back(std::move(ability));
  }
  return abilities;
}

}  // namespace biteline::app
