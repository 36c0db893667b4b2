// SPDX-License-Identifier: MIT
#pragma once
/// \file Shoes with a known line for the fit of the curve's data term, and for its judgement: made ones, and
/// shapes of public origin.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/bite_line/side/side.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"
#include "tests/support/line_sweep.hpp"

namespace biteline::bench {

struct CurveCase {
  std::string kind;   ///< ordinary, guard, heel, flush, sewn, shape, unlabelled, or thing
  std::string group;  ///< left out together: the class of made shoes, one shape alone
  std::string name;
  test::SweepScan scan;  ///< its truth is empty where the line is not known
  double truth_mm{0};    ///< the truth's own error
};

struct CaseOptions {
  std::uint64_t seed{8101};
  int ordinary{40}, guards{20}, heels{10}, flush{15}, sewn{15};
  double heel_ratio{0.35};
  bool shapes{true};
  bool unknown_shapes{false};  ///< also those without a known line, and things
};

/// One after the other, as they are made: all of them would take much memory.
void for_cases(const CaseOptions& options, const std::function<void(CurveCase&&)>& use);

/// The side as the finder reads it; none where the cloud holds no shoe.
[[nodiscard]] std::optional<bite_line::Side> side_of(const cloud::PointCloud& cloud);

/// The known line on the unrolled side (s, z), anticlockwise, a place each 0.75 mm.  Chords of a truth that
/// does not know are left out.
[[nodiscard]] std::vector<Vec2> truth_on_side(const bite_line::Side& side, const CurveCase& of);

}  // namespace biteline::bench
