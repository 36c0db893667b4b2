// SPDX-License-Identifier: MIT
#pragma once
/// \file Where else the line may run: the stretches over which another way is hardly worse.

#include <cstddef>
#include <optional>
#include <vector>

#include "host/bite_line/curve/curve_ground.hpp"
#include "host/bite_line/curve/curve_search.hpp"

namespace biteline::bite_line {

/// Another way over one stretch of a curve.
struct CurveRival {
  std::size_t first{0};              ///< the curve's state where the way leaves it
  std::size_t count{0};              ///< so many of its states stand beside the way; all of them: all round
  std::vector<CurveState> states{};  ///< of the way
  std::vector<Vec2> places{};        ///< of these: s, z; s goes on once round
  double length_mm{0};               ///< of the curve's stretch
  double above_mm{0};                ///< mean height of the way over that of the stretch
  double excess{0};                  ///< so much more the way costs than the stretch
  bool seen{false};                  ///< the surface is, under most of the way and of the stretch
  /// How much the upper one of the way and the stretch lies between two surfaces, 0 to 1.
  double two_surfaces{1};
  /// How much that one's looks change along it: the standard deviation of what it costs for each millimetre.
  double uneven{0};
  double own_per_mm{0};       ///< what the stretch costs, where it was seen
  double faintest_per_mm{0};  ///< and over those 3 mm that cost the most, 4.5 mm beyond its ends among them
  /// Log odds of a way all round by what it and the curve are as wholes; 0 where nobody looked.
  double as_whole{0};
};

struct RivalConfig {
  double same_mm{2.25};  ///< nearer to the curve is the same crease: placing the line looks so far
  /// A way is a rival while it costs no more than so much and once more what the curve costs, for each
  /// millimetre: the fainter the line, the farther one must look.
  double per_mm{0.6};
  /// So many searches at most: each also finds what leads over other stretches than the ones before.
  int searches{3};
  /// And of a way that leads all round above the curve: a sole that is nearly flush shows a faint crease.
  double above_per_mm{2.0};
};

/// The cheapest way all round above a curve, however much plainer the curve is.
[[nodiscard]] std::optional<CurveRival> way_above(const CurveGround& ground, const CurveConfig& search,
                                                  const ClosedCurve& curve, const RivalConfig& config);

/// The ways of the cheapest curve when all that lies beside `curve` costs so much more; then of the cheapest
/// one when what lies beside these ways does, too; and so on until there is no other.  And `above`, if that
/// is another way: what way_above() found of the curve.
/// What a stretch shows, its neighbours show, too: a mould line is as plain for a metre as for a centimetre.
/// Energies of long stretches are therefore no likelihoods, and what tells rivals is how much they cost for
/// each millimetre, and how they look.
[[nodiscard]] std::vector<CurveRival> rivals_of(const CurveGround& ground, const CurveConfig& search,
                                                const ClosedCurve& curve, std::optional<CurveRival> above,
                                                const RivalConfig& config);

}  // namespace biteline::bite_line
