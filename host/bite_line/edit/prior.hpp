// SPDX-License-Identifier: MIT
#pragma once
/// \file A model's line that a person has mended, as a prior for a later scan of the same model.
///
/// The prior chooses among what the scan itself shows: candidates that pass every gate that looks at them
/// alone.  It saves none that fails, and moves no point.

#include <span>

#include "host/bite_line/edit/surface.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::edit {

/// Whether a person has put any part of it right.
[[nodiscard]] bool is_mended(const cloud::ClosedLine& line);

/// How far a line lies off the prior, seen from the prior's points; mm.
struct OffPrior {
  double mean_mm{0};
  double most_mm{0};
  Vec3 most_at{Vec3::Zero()};  ///< the place on the line
  double u95_mm{0};            ///< of the difference there
  double beyond_mm{0};         ///< length over which the difference is above its own U95
};

/// `prior` lies in the line's frame.  `placed_sigma_mm`: how well it was placed there, RMS.  The U95 of a
/// difference takes in both lines' own and that.  Pre: both have points.
[[nodiscard]] OffPrior off_prior(const cloud::ClosedLine& line, const cloud::ClosedLine& prior,
                                 double placed_sigma_mm);

/// The candidate nearest to the prior, counted from 1 as in report.json: by the mean height between the two
/// on the side.  1, the line as it was found, where no other one that passes is nearer.
[[nodiscard]] int nearest_candidate(const Surface& surface, const cloud::ClosedLine& prior);

}  // namespace biteline::edit
