// SPDX-License-Identifier: MIT
#pragma once
/// \file Whether a shoe still stands as it was scanned, by a second look at it.

#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "host/cloud/point_cloud.hpp"

namespace biteline::transfer {

/// A shoe that has not moved farther is worked as it was scanned: half of what a point of a line may be off
/// to be right (0.3 mm), so a nudge by that is told with as much to spare.  An untouched shoe
/// seems to move by 0.1 mm at most where the arm repeats its way within 0.05 mm (`bench_moved`).
inline constexpr double k_most_moved_mm = 0.15;

struct MovedOptions {
  double limit_mm{k_most_moved_mm};
};

struct Moved {
  enum class Verdict {
    Unmoved,    ///< within the limit, with 95 %
    Moved,      ///< the same shoe, elsewhere
    OtherShoe,  ///< no small motion explains the look
    NotSeen,    ///< the look does not tell
  };
  Verdict verdict{Verdict::NotSeen};
  double shift_mm{0};        ///< of the place of the line that moved farthest
  double u95_mm{0};          ///< of that, at the least sure place; 0 where too little is seen
  double unexplained_mm{0};  ///< between the two surfaces once the motion is taken off, RMS of patches
  double limit_mm{0};        ///< that it was judged by
  std::string words{};       ///< one plain sentence
};

/// Both clouds and the closed line are in base, so nothing is searched for: a small rigid motion is estimated
/// from what stands at the line and above it.  Table and fixture do not move with the shoe and have no say.
/// The look may show a part of the shoe: where it leaves more than half of the line in one piece out, or
/// shows less than 225 mm of it, it is NotSeen.
[[nodiscard]] Moved moved_since(const cloud::PointCloud& held, const cloud::PointCloud& look,
                                const std::vector<Vec3>& line_base, const MovedOptions& options = {});

}  // namespace biteline::transfer
