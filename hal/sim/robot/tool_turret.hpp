// SPDX-License-Identifier: MIT
#pragma once
/// \file A simulated tool changer at the flange: it turns to the tool whose output is on, and tells by an
/// input which one stands.

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace biteline::sim {

struct TurretFacts {
  /// Standard digital lines of the controller, 0 to 7.
  struct Place {
    int ask_output{0};
    int there_input{0};
  };
  std::vector<Place> places;
  std::size_t stands{0};  ///< at first
  double turn_s{1.5};     ///< from one place to any other
  bool stuck{false};      ///< once it turns it never comes to stand
};

/// Call step() once for each cycle, in order.
class ToolTurret {
 public:
  /// Pre: at least one place.
  explicit ToolTurret(TurretFacts facts) : facts_{std::move(facts)}, asked_{facts_.stands} {}

  /// The standard inputs that are on, as bits.  Asked for none or for several it stays where it is.
  [[nodiscard]] std::uint64_t step(double time_s, std::uint64_t outputs);
  [[nodiscard]] std::size_t stands() const { return facts_.stands; }

 private:
  TurretFacts facts_;
  std::size_t asked_;
  double begin_s_{0};
  bool turns_{false};
};

}  // namespace biteline::sim
