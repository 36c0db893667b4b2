// SPDX-License-Identifier: MIT
#pragma once
/// \file A made shoe before and after it was worked, as two quick scans, with the truth.

#include <cstdint>
#include <vector>

#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/true_line.hpp"
#include "host/second_look/second_look.hpp"

namespace biteline::bench {

struct WorkCase {
  sim::ShoeClass shoe_class{sim::ShoeClass::Deep};
  std::uint64_t seed{1};
  bool bare{false};  ///< an upper without its sole; its line is the sample's
  sim::Work work{sim::Work::WetGlue};
  sim::BandPlan plan{};
  double light_ratio{1};  ///< of the second scan
  double profile_step_mm{1.0};
};

/// The `index`-th of a bench: classes, uppers, works and faults in turn; every fourth is without a fault.
[[nodiscard]] WorkCase work_case(std::uint64_t first_seed, int index);

struct TrueFault {
  sim::WorkFault made;
  second_look::Arc along;  ///< on the line
};

struct MadeWork {
  cloud::PointCloud first, second;
  cloud::ClosedLine line;  ///< base; with normals and tangents
  second_look::PlannedBand plan;
  std::vector<TrueFault> faults;
  std::vector<Vec3> low_base, high_base;  ///< the true edges, a point for each of the line
  sim::MadeShoe shoe, worked;
  SE3 T_base_shoe;
  std::vector<sim::TrueLinePoint> true_line;
};

/// Scans as scan_quickly() makes them, the second one with its own noise and what an arm does not repeat of
/// its way: slow waves of 0.014 mm and 0.03 mrad, as uncertain_scan() has it.
[[nodiscard]] MadeWork make_work(const WorkCase& made);

}  // namespace biteline::bench
