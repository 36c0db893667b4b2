// SPDX-License-Identifier: MIT
#pragma once
/// \file How much each place of the side looks like the bite line, and what a course through it costs.

#include "host/bite_line/large.hpp"
#include "host/bite_line/layers/chains.hpp"
#include "host/bite_line/side/side_field.hpp"

namespace biteline::bite_line {

struct EvidenceConfig {
  /// Turns below this are noise: a scan of 0.02 mm noise at 5 points on 1 mm^2 turns by so much.
  double noise_rad{0.026};
  double rough_ratio{0.7};  ///< of the median turn of a rough column is noise, too
  /// A crease this much above the noise is there with 63 %.  It saturates soon: a deep groove is no better a
  /// bite line than a plain one.
  double crease_rad{0.12};
  double run_mm{6.0};    ///< to both sides: over so much a crease is straight
  double crest_mm{1.5};  ///< within so much the surface turns most at the line
  /// What a crease within one surface counts against one between two.
  double one_surface_ratio{0.45};
  /// Two surfaces meet with this turn between them, a millimetre of step counting as `rad_per_step_mm`.
  double flank_soft_rad{0.05};
  double rad_per_step_mm{0.35};
  /// A crease that would lie on the upper costs this share of its likeness.  Soles have many creases, uppers
  /// few, so a line that leaves one above it needs a reason.
  double above_ratio{0.4};
  double unseen_cost{1.1};  ///< a little more than surface without a crease
  double above_from_mm{2.5};
  double above_to_mm{25.0};
  /// What a crease that goes round by `part_share` and less counts against one that goes round by
  /// `whole_share` and more: a cap's or a counter's edge is a crease of a shoe, but not the bite line.
  double part_ratio{0.6};
  double part_share{0.35};
  double whole_share{0.65};
  bool thin_soles{false};  ///< a sole may end at a rim close below the line
  ChainConfig chain{};
};

struct Evidence {
  Large<float> likeness;  ///< 0 to 1: a crease is here, and between two surfaces
  Large<float> round;     ///< 0 to 1: how far round that crease goes on
  Large<float> cost;      ///< of a course per column: about 0 on a plain line, 1 where nothing is
};

[[nodiscard]] Evidence find_evidence(const SideField& field, const EvidenceConfig& config);

}  // namespace biteline::bite_line
