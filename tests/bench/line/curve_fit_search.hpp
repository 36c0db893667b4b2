// SPDX-License-Identifier: MIT
#pragma once
/// \file The curve on a side whose line is known, judged, and so are its rivals.

#include <string>
#include <vector>

#include "host/bite_line/curve/crease_looks.hpp"
#include "host/bite_line/curve/curve_posterior.hpp"
#include "host/bite_line/curve/curve_rivals.hpp"
#include "host/bite_line/curve/curve_search.hpp"
#include "tests/bench/line/curve_fit_held.hpp"

namespace biteline::bench {

/// A rival, and how much of both ways is on the known line, where that is known.
struct JudgedRival {
  bite_line::CurveRival rival;
  double more_per_mm, right_share, rival_right_share;
  bool all_round;
  double log_odds;
};

/// A place of the curve that is on the known line, or is well off it.
struct JudgedPlace {
  bite_line::PlaceSigns signs;
  bool wrong;
};

struct SearchVerdict {
  double wrong_mm{0};
  double energy{0};
  double known_energy{0};  ///< of the cheapest curve along the known line, where another one was found
  std::vector<JudgedRival> rivals{};
  std::vector<JudgedPlace> places{};  ///< every fourth one of a shoe whose line is plain to see
};

/// The product's search with these weights.  Rivals and the known line's energy only if `scored`; pictures
/// only where there is a folder for them.
[[nodiscard]] SearchVerdict searched(const Held& held, const bite_line::CurveWeights& weights,
                                     const bite_line::CurveConfig& config, bool scored = false,
                                     const std::string& pictures = {});

}  // namespace biteline::bench
