// SPDX-License-Identifier: MIT
#pragma once
/// \file The film that a program lays in the simulated cell.

#include <memory>
#include <vector>

#include "hal/sim/glue/glue_gun.hpp"
#include "hal/sim/robot/program.hpp"

namespace biteline::sim {

/// The tool and the outputs that it hangs on.
struct FilmTool {
  double standoff_mm{0};  ///< of the place where it lands, from the tip along its axis
  int digital_output{0};
  int analog_output{0};
  double full_mm_s{100};  ///< the place's speed at which full flow gives the nominal film
  GunFacts gun{};
};

/// One cycle of the controller.
struct FilmStep {
  double time_s{0};
  Vec3 spot_base{Vec3::Zero()};  ///< mm
  double way_mm{0};              ///< of the spot, in this cycle
  double film_mm{0};             ///< of nominal film that came out, in length
  bool gun_wanted{false};        ///< by the program itself, which knows nothing of the thread's early word
};

/// Cycle by cycle, by the program's time: targets, threads and outputs as the controller has them, in made
/// time.  What lands between two cycles lies between their two spots.
[[nodiscard]] std::vector<FilmStep> lay_film(const std::shared_ptr<const Program>& program,
                                             const FilmTool& tool, double step_s = 0.002);

}  // namespace biteline::sim
