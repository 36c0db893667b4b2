// SPDX-License-Identifier: MIT
#pragma once
/// \file The layers of the side that the bite line could be: the best course, and what parts from it.

#include <functional>
#include <optional>
#include <vector>

#include "host/bite_line/layers/changes.hpp"
#include "host/bite_line/layers/course.hpp"
#include "host/bite_line/layers/evidence.hpp"
#include "host/bite_line/layers/material.hpp"
#include "host/bite_line/path/creases.hpp"

namespace biteline::bite_line {

struct LayersConfig {
  EvidenceConfig evidence{};
  CourseConfig course{};
  ChangeConfig change{};
  CreaseConfig crease{};
  /// A rival is as good as the course where it costs no more.  What tells them apart is the same all along a
  /// rival, so its margin is a mean per column, over `margin_cols` more than it has: what is that short is
  /// noise.  To leave a line and come back costs `kink`: the edge of a sole is smooth.
  double margin_cols{15};
  double kink{2};
  double margin{0.07};  ///< at which the course is one of two
  double margin_soft{0.012};
  int most{6};  ///< rivals described
  /// Where the material changes at the course and not at a rival that goes all the way round, or the other
  /// way round: a likelihood ratio of at most 10, for two colours are on many soles and one on many shoes. It
  /// moves how sure the course is, and never the course: shape alone says where that runs.
  double material_log_odds{2.3};
  double material_most_margin{0.2};  ///< beyond it nothing of that is left to be seen
  /// That a stretch between two changes of the crease is on the line's.  Of eight that were written four
  /// were: four of four on shoes made to mislead were not.
  float changed_hold{0.4F};
};

/// Another layer: it lies beside the line over a part of its length, or all the way round.
struct Rival {
  Crease crease;  ///< the line, but for the columns where this one parts from it
  int first_col{0};
  int cols{0};
  bool above{false};
  bool all_round{false};
  double margin{0};    ///< cost per column that the line is better by
  double material{0};  ///< Materials::favours() of the line; 0 where that was not asked
};

struct Layers {
  Crease line;
  std::vector<float> hold;      ///< per column: that the line is on its layer and on no other, 0 to 1
  std::vector<float> other_mm;  ///< per column: how far off the layer lies that the line holds least against
  std::vector<float> sharp;     ///< per column: how sharp a place the crease has, 1 but on flat weak ones
  std::vector<Rival> rivals;    ///< the nearest first
  std::vector<OtherCrease> others{};  ///< where it left its crease for another
};

/// Per column of a path: how sharp a place its crease has.
[[nodiscard]] std::vector<float> sharp_along(const SideField& field, const Crease& line);

/// How much each place looks like the bite line, and the best closed course through that.
struct FirstLook {
  Evidence evidence;
  Ways ways;  ///< through its cost
  ClosedPath best;
};
[[nodiscard]] FirstLook first_look(const SideField& field, const LayersConfig& config);

/// `materials`: of the side, asked for only where there is something to tell apart.
using MaterialsOfSide = std::function<std::optional<Materials>()>;
[[nodiscard]] Layers find_layers(const SideField& field, const FirstLook& look, const LayersConfig& config,
                                 const MaterialsOfSide& materials = {});

}  // namespace biteline::bite_line
