// SPDX-License-Identifier: MIT
#pragma once
/// \file A simulated gun and its pump: what comes out, by the controller's two outputs.

#include <deque>
#include <limits>

namespace biteline::sim {

/// What a maker's data sheet and a test line tell of a gun.
struct GunFacts {
  double opens_s{0.040};     ///< from its output's switching on
  double closes_s{0.025};    ///< from its switching off
  double pump_lag_s{0.030};  ///< first-order, of the flow behind the analog output
  bool metered{true};        ///< the pump follows the analog output; else it gives full flow
  /// After so much of full flow it gives `then_ratio` of it for ever: 0 for an empty one, less than 1 for a
  /// clogged one.
  double good_for_s{std::numeric_limits<double>::infinity()};
  double then_ratio{0};
};

/// Its needle opens and closes at once, so long after its output.  A closed needle lets nothing through, and
/// the pump's flow behind it goes on as it was asked for (it runs back to its tank).
class GlueGun {
 public:
  explicit GlueGun(const GunFacts& facts) : facts_{facts} {}

  /// `gun` and `analog_ratio` from now on, for `step_s`.  What comes out in that time, of full flow.
  [[nodiscard]] double step(double step_s, bool gun, double analog_ratio);

 private:
  struct Edge {
    double at_s;
    bool open;
  };
  GunFacts facts_;
  double time_s_{0};
  bool told_{false}, open_{false};
  std::deque<Edge> edges_;
  double flow_ratio_{0};
  double given_s_{0};  ///< of full flow
};

}  // namespace biteline::sim
