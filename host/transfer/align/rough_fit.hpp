// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether a sample can lie on an upper at all, in a hundredth of the work that align() takes.

#include "host/transfer/align/grade.hpp"
#include "host/transfer/align/nearest_table.hpp"
#include "host/transfer/align/prepared.hpp"

namespace biteline::transfer {

/// Some hundred places of a sample's surface above its line, evenly drawn, in its shoe frame.
struct RoughShape {
  Surfels coarse{};  ///< at the coarse pitch: for the search
  Surfels few{};     ///< of those at the fine pitch: for the judgement
  double length_mm{0};
};

[[nodiscard]] RoughShape rough_shape_of(const Sample& sample);
/// Of the other foot.
[[nodiscard]] RoughShape mirrored(const RoughShape& shape);

/// An upper and its tables, made once for all models.  Keeps a reference to the upper.
struct RoughTarget {
  const Upper& upper;
  NearestTable coarse, fine;

  explicit RoughTarget(const Upper& upper_ready);
};

/// A model whose rough fit is above this is not compared further.  align() takes none whose residual is
/// 0.2 mm or more over the surface; a single place is off by as much again through noise and texture, and the
/// better half by less than all.  `bench_identify 60` has the right models below 0.1 mm.
inline constexpr double k_most_rough_mm = 0.2;
/// The same where it is graded: align() takes none at 0.3 mm or more, and few places tell a grade less well.
inline constexpr double k_most_rough_graded_mm = 0.5;

struct RoughFit {
  double off_mm{0};  ///< RMS of the better half of the places; infinite where less than half meet the upper
  double length{1};  ///< of the upper to that of the sample; 1 where it is not graded
};

/// After a short search from all starts.  `law`: of another size; null: of the sample's own.  align() wants
/// 60 % of the sample on the upper.
[[nodiscard]] RoughFit rough_fit(const RoughShape& shape, const RoughTarget& target,
                                 const GradingLaw* law = nullptr);

}  // namespace biteline::transfer
