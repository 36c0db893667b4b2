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
  /// Row difference of neighbouring columns on one surface beyond what the stripe's own slope explains. Three
  /// standard deviations of the widest ordinary stripe's speckle are below one; a groove's rim bends by two.
  float max_step_px{4.0F};
  /// Columns a stretch may miss (a dark thread, a scratch) and still be one.
  int max_gap_columns{2};
  /// A stretch of fewer columns is no surface: at 0.13 mm a column, half a millimetre.
  int min_stretch_columns{4};
  /// A stretch with less than this share of the longest one's light, in another place than the last profile
  /// and than the well supported stretches beside it, is taken for a reflection.
  float min_light_ratio{0.05F};
  /// Beside: within so many columns (a hole in the upper), and no more rows away per column than this.
  int beside_columns{60};
  float beside_slope_px{0.75F};
};

enum SelectionFlag : std::uint8_t {
  k_selection_reflection = 1U << 0U,     ///< not on a plausible stretch of stripe
  k_selection_discontinuous = 1U << 1U,  ///< far from both neighbours
  /// At the end of a stretch, and not of its brightness or width; or a poor fit off its neighbours' line.
  k_selection_edge_mixed = 1U << 2U,
  k_selection_brightness_step = 1U << 3U,  ///< cut on one side by print or another step of brightness
};

/// The choice of one column.
struct Selected {
  std::int8_t kept_index{-1};  ///< into ColumnPeaks::kept; -1: no peak
  std::uint8_t flags{0};       ///< SelectionFlag, of the chosen peak
  bool joined{false};          ///< on one stretch with the previous column's chosen peak
  /// Standard deviation that the shape's skew adds to the row's, common to neighbours; 0: not skewed.
  float skew_sigma_px{0};
};

struct Selection {
  std::array<Selected, k_max_columns> columns;
};

/// Chooses one peak per column.
///
/// Peaks of neighbouring columns are linked to stretches; a stretch's support is the number of its columns
/// (less for doubtful peaks; brightness beyond that says nothing: mirror images are bright), half as much
/// again where it lies where the previous profile was.  Each column takes the peak of its best supported
/// stretch.  What is on no stretch worth the name is chosen too, where there is nothing better, but flagged;
/// so is what an edge of the surface, or of print on it, has cut. Thread: one at a time (keeps the previous
/// profile).  RT: rt_select.  Memory: inside the object (100 kB).
class PeakSelector {
 public:
  explicit PeakSelector(const SelectorConfig& config) : config_{config} {}

  void rt_select(const Peaks& peaks, Selection& out) noexcept BITELINE_RT;
  /// From the next frame on.
  void rt_choose_by(PeakChoice choice) noexcept BITELINE_RT { config_.choice = choice; }

 private:
  struct Stretch {
    float support{0};  ///< columns, those with little light less
    float light{0};    ///< sum of the amplitudes
    float first_row_px{0};
    float last_row_px{0};
    float slope_px{0};  ///< rows per column at its end
    int first_column{0};
    int last_column{0};
    int columns{0};
    int seen_before{0};  ///< columns in which it lies where the previous profile was
  };
  using Index = std::int16_t;
  static constexpr Index k_none = -1;

  void rt_link(const Peaks& peaks) noexcept BITELINE_RT;
  void rt_close_ended(std::size_t column) noexcept BITELINE_RT;
  [[nodiscard]] Index rt_open(const Peak& peak, int column) noexcept BITELINE_RT;
  [[nodiscard]] Index rt_continue(std::size_t column, const Peak& peak,
                                  Index taken) const noexcept BITELINE_RT;
  void rt_choose(const Peaks& peaks, Selection& out) noexcept BITELINE_RT;
  void rt_judge(const Peaks& peaks, Selection& out) noexcept BITELINE_RT;
  [[nodiscard]] bool rt_goes_on(const Stretch& stretch, const Peaks& peaks, const Selection& chosen,
                                float least_light) const noexcept BITELINE_RT;
  void rt_flag_ends(const Peaks& peaks, Selection& out) noexcept BITELINE_RT;
  static void rt_judge_skew(const Peaks& peaks, Selection& out) noexcept BITELINE_RT;
  static void rt_flag_poor_fits(const Peaks& peaks, Selection& out) noexcept BITELINE_RT;
  [[nodiscard]] float rt_same_place_ratio(Index stretch) const noexcept BITELINE_RT;
  [[nodiscard]] float rt_support(Index stretch) const noexcept BITELINE_RT;
  [[nodiscard]] float rt_light(Index stretch) const noexcept BITELINE_RT;

  SelectorConfig config_;
  std::array<Stretch, k_max_columns * k_kept_peaks> stretches_;
  int stretch_count_{0};
  /// Stretches that a next column may go on with.  Few: a column has two peaks, and a stretch stays open for
  /// a gap.
  static constexpr std::size_t k_max_open = 16;
  std::array<Index, k_max_open> open_;
  std::size_t open_count_{0};
  std::array<std::array<Index, k_kept_peaks>, k_max_columns> stretch_of_;
  std::array<float, k_max_columns> previous_row_px_;  ///< of the previous profile; below 0: none
  int previous_columns_{0};
};

}  // namespace biteline::stripe
