// SPDX-License-Identifier: MIT
// Where print, or another step of the surface's brightness, cuts the stripe's light on one side: its shape is
// skewed there, narrower than elsewhere, and its place shifted towards the brighter side.  The surface's own
// shape leaves it symmetric: on recorded shoes no four columns together have a skew of
// more than 0.05.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/stripe/peak_selector.hpp"

namespace biteline::stripe {
namespace {

constexpr float k_fwhm_per_sigma = 2.3548F;  // 2 sqrt(2 ln 2)
/// Neighbours on either side that are looked at together: speckle skews a single column as much as print
/// does.
constexpr std::size_t k_side_columns = 3;
/// Least mean skew of neighbours: of a black edge two standard deviations from the centre, which shifts it by
/// 0.06.
constexpr float k_least_skew = 0.04F;
/// Skew counts from so many of its own standard deviations on.
constexpr float k_skew_noise = 3.0F;
/// Standard deviation of one column's skew over sigma_row / sigma of the stripe: 0.4 in speckle shared by
/// several rows, as in photographs and the sessions; 0.8 (sqrt(2/3)) in white noise, which k_least_skew
/// covers from 20 grey levels of amplitude on.
constexpr float k_skew_per_row_noise = 0.4F;
/// Variance of the mean of n neighbours, over one column's, times n: of errors that correlate as in the
/// sessions, or as Speckle::neighbour_correlation says where that is more.
float correlated_columns(float r) {
  constexpr float k_usual = 2.45F;
  const float twice = r * r * r * r;
  return std::max(k_usual, 1 + 2 * (r + twice + twice * twice * r));
}
/// Shifted: off the straight line through the columns from k_near_columns to k_far_columns away by so many of
/// the stripe's standard deviations, and by so many of the row's (that line's own error is two).
constexpr float k_shift_ratio = 0.5F, k_shift_noise = 3.0F;
constexpr std::size_t k_near_columns = 6, k_far_columns = 14, k_least_columns = 5;
/// Width over the line's usual one at which a skewed stripe is cut (black to within 1.2 standard deviations
/// of the centre), and at which what is left of it goes on to be cut where the rest has no clear skew.
constexpr float k_cut_width_ratio = 0.85F, k_rest_width_ratio = 0.75F;
/// Light scattered to one side, as in foam, skews the stripe too, but makes it wider by half: measured,
/// with the doubt in its standard deviation.
constexpr float k_scattered_width_ratio = 1.25F;
/// Standard deviations of the stripe by which a skew of 1 shifts it: 1 to 2 on photographs, 2 to 5 at made
/// edges.
constexpr float k_shift_per_skew = 2.0F;

/// Median to a bin's width; values beyond the ends count as the end, and what is no number as the first.
class Median {
 public:
  Median(float first, float bin) : first_{first}, bin_{bin} {}
  void add(float value) {
    const float bin = (value - first_) / bin_;
    ++counts_[bin > 0 ? static_cast<std::size_t>(std::min(bin, static_cast<float>(k_bins - 1))) : 0];
    ++total_;
  }
  [[nodiscard]] float value() const {
    std::size_t bin = 0;
    for (int seen = counts_[0]; 2 * seen < total_; seen += counts_[++bin]) {
    }
    return first_ + bin_ * (static_cast<float>(bin) + 0.5F);
  }

 private:
  static constexpr std::size_t k_bins = 128;
  float first_, bin_;
  std::array<int, k_bins> counts_{};
  int total_{0};
};

struct Skew {
  std::int8_t direction{0};  ///< of the shift: -1 to lower rows, +1 to higher ones; 0: none to speak of
  bool is_cut{false};        ///< shifted or narrow as well
  float sigma_px{0};         ///< Selected::skew_sigma_px
};

constexpr auto skew_of = [](const Peak& peak) { return peak.skew; };
constexpr auto row_of = [](const Peak& peak) { return peak.row_px; };
constexpr auto sigma_row_of = [](const Peak& peak) { return peak.sigma_row_px; };
constexpr auto width_of = [](const Peak& peak) { return peak.width_px; };

/// The sound columns of one stretch.
struct Piece {
  const Peaks& peaks;
  const Selection& selection;
  float usual_skew, usual_width_px;  ///< of all of the line
  std::size_t size{0};
  std::array<std::uint16_t, k_max_columns> column{};

  [[nodiscard]] const Peak& peak(std::size_t i) const {
    return peaks.columns[column[i]].kept[static_cast<std::size_t>(selection.columns[column[i]].kept_index)];
  }
  template <class Value>
  [[nodiscard]] float mean(std::size_t from, std::size_t to, Value value) const {
    float sum = 0;
    for (std::size_t i = from; i < to; ++i) sum += value(peak(i));
    return sum / static_cast<float>(to - from);
  }

  /// Looked at together with the i-th: [before(i), after(i)).
  [[nodiscard]] std::size_t before(std::size_t i) const {
    return std::max(k_side_columns, i) - k_side_columns;
  }
  [[nodiscard]] std::size_t after(std::size_t i) const { return std::min(i + k_side_columns + 1, size); }

  /// About the i-th the stripe is as narrow as what print leaves of it.
  [[nodiscard]] bool is_rest(std::size_t i) const {
    return mean(before(i), after(i), width_of) < k_rest_width_ratio * usual_width_px;
  }

  /// Rows by which those about the i-th lie off the line through those [from, to); 0 where these are too few.
  [[nodiscard]] float off_line_px(std::size_t i, std::size_t from, std::size_t to) const {
    if (to < from + k_least_columns) return 0;
    const auto at = [&](std::size_t k) {
      return static_cast<float>(column[k]) - static_cast<float>(column[i]);
    };
    const float row_px = mean(from, to, row_of);
    float middle = 0, moment = 0, square = 0;
    for (std::size_t k = from; k < to; ++k) middle += at(k) / static_cast<float>(to - from);
    for (std::size_t k = from; k < to; ++k) {
      moment += (at(k) - middle) * (peak(k).row_px - row_px);
      square += (at(k) - middle) * (at(k) - middle);
    }
    return mean(std::max<std::size_t>(1, i) - 1, std::min(i + 2, size), row_of) -
           (row_px - middle * moment / square);
  }

  /// The same of the better of both sides, in the direction that the skew shifts it.
  [[nodiscard]] float shift_px(std::size_t i, float skew) const {
    float left = 0, right = 0;
    if (i >= k_near_columns)
      left = off_line_px(i, std::max(k_far_columns, i) - k_far_columns, i + 1 - k_near_columns);
    if (i + k_near_columns < size)
      right = off_line_px(i, i + k_near_columns, std::min(size, i + k_far_columns + 1));
    return skew < 0 ? -std::min(left, right) : std::max(left, right);
  }

  [[nodiscard]] Skew skew_at(std::size_t i) const {
    const std::size_t from = before(i), to = after(i);
    const float width_px = mean(from, to, width_of), sigma_px = width_px / k_fwhm_per_sigma,
                sigma_row_px = mean(from, to, sigma_row_of);
    const float together = correlated_columns(peaks.speckle.neighbour_correlation);
    Skew result;
    const auto look = [&](std::size_t window_from, std::size_t window_to) {
      const float skew = mean(window_from, window_to, skew_of);
      // What is skewed as all of the line is the head's own.
      const float excess = std::min(std::fabs(skew), std::fabs(skew - usual_skew));
      const float noise = k_skew_per_row_noise * peaks.speckle.doubt_ratio * sigma_row_px / sigma_px *
                          std::min(1.0F, std::sqrt(together / static_cast<float>(window_to - window_from)));
      if (excess < std::max(k_least_skew, k_skew_noise * noise)) return;
      if (k_shift_per_skew * excess * sigma_px > result.sigma_px) {
        result.sigma_px = k_shift_per_skew * excess * sigma_px;
        result.direction = skew < 0 ? -1 : 1;
      }
      result.is_cut = result.is_cut ||
                      (width_px < k_scattered_width_ratio * usual_width_px &&
                       shift_px(i, skew) > std::max(k_shift_ratio * sigma_px, k_shift_noise * sigma_row_px));
    };
    look(from, to);
    // To one side alone, where a cut begins and ends.
    if (i >= k_side_columns) look(from, i + 1);
    if (i + k_side_columns < size) look(i, to);
    result.is_cut = result.is_cut || (result.direction != 0 && width_px < k_cut_width_ratio * usual_width_px);
    return result;
  }
};

/// A peak of the stripe's own shape, and not flagged.
bool is_sound(const ColumnPeaks& peaks, const Selected& selected) {
  return selected.kept_index >= 0 && selected.flags == 0 &&
         (peaks.kept[static_cast<std::size_t>(selected.kept_index)].flags &
          (k_peak_clipped | k_peak_poor_fit)) == 0;
}

/// Flags what is cut in one piece, and tells the doubt of what is skewed.
void rt_judge_piece(const Piece& piece, Selection& out) noexcept BITELINE_RT {
  std::array<std::int8_t, k_max_columns> direction;
  std::array<bool, k_max_columns> is_cut;
  std::size_t judged = 0;
  const auto judge_to = [&](std::size_t end, bool upright) {
    for (; judged < end; ++judged) {
      const Skew skew = upright ? Skew{} : piece.skew_at(judged);
      direction[judged] = skew.direction;
      is_cut[judged] = skew.is_cut;
      out.columns[piece.column[judged]].skew_sigma_px = skew.sigma_px;
    }
  };
  // Most of a line is upright: looked at closely is only what lies about four neighbours that are skewed
  // together.
  float sum = 0;
  for (std::size_t i = 0; i < piece.size; ++i) {
    sum += piece.peak(i).skew;
    if (i > k_side_columns) sum -= piece.peak(i - k_side_columns - 1).skew;
    if (std::fabs(sum) < k_least_skew * static_cast<float>(std::min(i, k_side_columns))) continue;
    judge_to(std::max(i, 2 * k_side_columns) - 2 * k_side_columns, true);
    judge_to(piece.after(i), false);
  }
  judge_to(piece.size, true);

  // One cut: what is skewed one way, with no more columns between than are looked at together, and the rest
  // beside.
  std::size_t free = 0;
  for (std::size_t i = 0; i < piece.size;) {
    std::size_t begin = i, last = i++;
    if (direction[begin] == 0) continue;
    bool found = is_cut[begin];
    for (; i < piece.after(last) && direction[i] != -direction[begin]; ++i) {
      if (direction[i] == 0 && !piece.is_rest(i)) continue;
      found = found || is_cut[i];
      last = i;
    }
    if (found) {
      while (begin > free && piece.is_rest(begin - 1)) --begin;
      for (std::size_t k = begin; k <= last; ++k)
        out.columns[piece.column[k]].flags |= k_selection_brightness_step;
    }
    free = i = last + 1;
  }
}

}  // namespace

void PeakSelector::rt_judge_skew(const Peaks& peaks, Selection& out) noexcept BITELINE_RT {
  const auto columns = static_cast<std::size_t>(peaks.column_count);
  Median skew{-0.32F, 0.005F}, width_px{0, 0.25F};
  std::array<bool, k_max_columns> sound;
  for (std::size_t i = 0; i < columns; ++i) {
    const Selected& selected = out.columns[i];
    sound[i] = is_sound(peaks.columns[i], selected);
    if (!sound[i]) continue;
    const Peak& peak = peaks.columns[i].kept[static_cast<std::size_t>(selected.kept_index)];
    skew.add(peak.skew);
    width_px.add(peak.width_px);
  }
  Piece piece{
      .peaks = peaks, .selection = out, .usual_skew = skew.value(), .usual_width_px = width_px.value()};
  for (std::size_t i = 0; i < columns; ++i) {
    if (!out.columns[i].joined) {
      rt_judge_piece(piece, out);
      piece.size = 0;
    }
    if (sound[i]) piece.column[piece.size++] = static_cast<std::uint16_t>(i);
  }
  rt_judge_piece(piece, out);
}

}  // namespace biteline::stripe
