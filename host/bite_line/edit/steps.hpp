// SPDX-License-Identifier: MIT
#pragma once
/// \file What a person can do to a line.

#include <vector>

#include "common/geometry/se3.hpp"

namespace biteline::edit {

/// A stretch of the version that is mended, in the order of its points; it may lie across the first one.
struct Stretch {
  double from_mm{0};
  double to_mm{0};
};

/// One operation.
struct Step {
  enum class Kind {
    Candidate,  ///< take a candidate, all of it or over the stretch; the first one is the line as found
    Through,    ///< lead the stretch through the points
    Cut,        ///< bridge the stretch
    BackTo,     ///< take an older version
  };
  Kind kind{Kind::Through};
  int candidate{0};            ///< counted from 1
  Stretch stretch{};           ///< of Through and Cut; of Candidate, both ends 0: all of it
  std::vector<Vec3> points{};  ///< of Through, base, mm, in any order
  int line_version{0};         ///< of BackTo
};

}  // namespace biteline::edit
