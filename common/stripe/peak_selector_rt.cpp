// SPDX-License-Identifier: MIT
#include "common/stripe/peak_selector.hpp"

#include <cmath>
#include <cstddef>

namespace biteline::stripe {
namespace {

std::int8_t choose_alone(const ColumnPeaks& column, PeakChoice choice) {
  if (column.kept_count == 0) return -1;
  if (column.kept_count == 1 || choice == PeakChoice::Strongest || choice == PeakChoice::Continuity) return 0;
  const bool second_is_lower = column.kept[1].row_px < column.kept[0].row_px;
  return static_cast<std::int8_t>((choice == PeakChoice::First) == second_is_lower ? 1 : 0);
}

}  // namespace

void PeakSelector::rt_select(const Peaks& peaks, Selection& out) noexcept BITELINE_RT {
  for (std::size_t i = 0; i < static_cast<std::size_t>(peaks.column_count); ++i) {
    out.columns[i] = {.kept_index = choose_alone(peaks.columns[i], config_.choice), .flags = 0};
  }
}

}  // namespace biteline::stripe
