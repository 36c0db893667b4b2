// SPDX-License-Identifier: MIT
#pragma once
/// \file The sweep: made shoes with designed soles, decoys, materials and faults, and things that are no
/// shoes; each is right, refused or wrong.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/sim/shoe/designed_shoe.hpp"
#include "hal/sim/shoe/made_shoe.hpp"
#include "hal/sim/shoe/true_line.hpp"
#include "host/bite_line/extraction.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/cloud/point_cloud.hpp"
#include "tests/support/cloud_faults.hpp"

namespace biteline::test {

/// One cell of the sweep, and the seed of the shoe that is drawn for it.
struct SweepCell {
  sim::DesignedShoe shoe;  ///< of a plain class: the class alone counts
  CloudFault fault{CloudFault::None};
  std::uint64_t seed{1};
  bool stripe{false};  ///< the cloud carries the stripe's amplitude and width: materials show
  double crease_ratio{
      1};  ///< of the step and the depth drawn: a sole may be nearly flush, its decoys are not

  /// Besides what is drawn.
  std::optional<sim::UpperShape::ParallelSeam> seam{};

  [[nodiscard]] bool is_shoe() const {
    return !sim::is_thing(shoe.shoe_class) && shoe.shoe_class != sim::ShoeClass::Bare;
  }
};

/// The `index`-th of the sweep of that seed: three of four have a designed sole, one in ten a plain one, the
/// rest are no shoes.
[[nodiscard]] SweepCell sweep_cell(std::uint64_t seed, std::uint64_t index);

/// As the definition has it: heights are means along the outline over some millimetres.  Where a line climbs
/// upright, round a guard, that is no mean along the line: there it is left out.
[[nodiscard]] std::vector<sim::TrueLinePoint> true_line_of(const sim::MadeShoe& shoe);

struct SweepScan {
  cloud::PointCloud cloud;
  cloud::ClosedLine truth;  ///< empty: there is no line
  /// The made crease turns by 10 degrees and more over 90 % of its length, and both its flanks are in the
  /// points there: such a shoe should not be refused.
  bool plain_to_see{false};
};
[[nodiscard]] SweepScan scan_of(const SweepCell& cell);
/// Truth of a scan whose cloud is in, of that shoe at that place.
void add_truth(SweepScan& scan, const sim::MadeShoe& shoe, const Eigen::Affine3d& T_base_shoe);

enum class Judged : std::uint8_t { Right, Refused, Wrong };

struct SweepVerdict {
  Judged judged{Judged::Right};
  double wrong_mm{0};  ///< length off by more than 1 mm outside flagged points
  double flagged_share{0};
  double mean_mm{0};  ///< of the points that are not flagged
  double max_mm{0};
};

/// A line is wrong with more than 5 mm off by more than 1 mm outside flagged points (confidence below 0.5, or
/// U95 above 1 mm), and wherever there is none to find.  A thing refused is right.
[[nodiscard]] SweepVerdict judge(const SweepScan& scan, const bite_line::Extraction& found);

/// Highest share that `count` among `of` still says with 95 % (Clopper and Pearson 1934, one-sided).
[[nodiscard]] double upper_bound_95(int count, int of);

}  // namespace biteline::test
