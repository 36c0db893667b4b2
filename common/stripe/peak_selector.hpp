// SPDX-License-Identifier: MIT
#pragma once
/// \file Which of a column's peaks is the surface, and which is a mirror image of the stripe.

#include <array>
#include <cstdint>

#include "common/rt/annotations.hpp"
#include "common/stripe/peaks.hpp"

namespace biteline::stripe {

enum class PeakChoice : std::uint8_t {
  Strongest,
  First,       ///< lowest row number
  Last,        ///< highest row number
  Continuity,  ///< the one that goes on from the neighbouring columns and the previous profile; the default
};

struct SelectorConfig {
  PeakChoice choice{PeakChoice::Continuity};
  float max_step_px{3.0F};  ///< row difference of neighbouring columns on one surface
};

enum SelectionFlag : std::uint8_t {
  k_selection_reflection = 1U << 0U,     ///< not on a plausible stretch of stripe
  k_selection_discontinuous = 1U << 1U,  ///< far from both neighbours
  k_selection_edge_mixed = 1U << 2U,     ///< at the end of a stretch: the peak mixes two surfaces
};

/// The choice of one column.
struct Selected {
  std::int8_t kept_index{-1};  ///< into ColumnPeaks::kept; -1: no peak
  std::uint8_t flags{0};       ///< SelectionFlag, of the chosen peak
};

struct Selection {
  std::array<Selected, k_max_columns> columns;
};

/// Chooses one peak per column.
///
/// Thread: one at a time (keeps the previous profile).  RT: rt_select.  Memory: inside the object.
class PeakSelector {
 public:
  explicit PeakSelector(const SelectorConfig& config) : config_{config} {}

  void rt_select(const Peaks& peaks, Selection& out) noexcept BITELINE_RT;

 private:
  SelectorConfig config_;
};

}  // namespace biteline::stripe
