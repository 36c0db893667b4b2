// SPDX-License-Identifier: MIT
#pragma once
/// \file Which corner is which: a picture's corners sorted into the rows and columns of chessboards.

#include "host/calibration/chess/corners.hpp"
#include "host/calibration/rings/grid.hpp"

namespace biteline::calibration {

/// As find_grids() of rings: up to `count` boards, best first, each corner as a ring without edges.
///
/// Four neighbours whose edges point to each other begin; the board grows corner by corner, each where those
/// around it foretell it, with its squares' colours as the board has them.  The colours also leave only the
/// readings that they allow: one where one side has an odd number of squares and the other an even one, two
/// where not.  A board with more squares than `target` says is none: a part of it would be taken for another
/// part in the next picture.
[[nodiscard]] std::vector<GridView> find_chessboards(const image::GreyImage& picture,
                                                     const RingTarget& target, int count);

}  // namespace biteline::calibration
