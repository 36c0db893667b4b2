// SPDX-License-Identifier: MIT
#include "host/transfer/refused.hpp"

#include <array>

namespace biteline::transfer {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  using enum Refused;
  using Row = report::RefusalRow<Refused>;
  static constexpr std::array k_rows{
      Row{SampleUnusable, "sample_unusable", "scan the sample again, with its upper above the sole"},
      Row{UpperWithoutShoe, "upper_without_shoe", "put the upper into the sensor's sight and scan again"},
      Row{DoesNotClose, "does_not_close", "scan the upper again; it must stand still meanwhile"},
      Row{TooLittleOverlap, "too_little_overlap", "scan the upper again, all the way round"},
      Row{DirectionNotFixed, "direction_not_fixed", "scan the upper again, with its collar, toe and heel"},
      Row{OtherFoot, "other_foot", "use the sample of this foot, or pass --mirror"},
      Row{OtherSize, "other_size", "use the sample of this size, or pass --grade"},
      Row{UpsideDown, "upside_down", "turn the upper over and scan again"},
      Row{OtherModel, "other_model", "use the sample of this model"},
      Row{AlignmentNotConverged, "alignment_not_converged", "scan the upper again"},
      Row{LineNotMet, "line_not_met", "scan the upper again, down to its lower edge"},
      Row{LineHardlySeen, "line_hardly_seen", "scan the upper again, all the way round"},
      Row{ScanHasGap, "scan_has_gap", "scan the upper again; the gap's place is in the reason"},
      Row{TooMuchUnsure, "too_much_unsure",
          "scan the upper again, all the way round; if that does not help, scan a new sample"},
      Row{SeveralModelsFit, "several_models_fit", "name the model with --sample"},
      Row{ModelNotSure, "model_not_sure", "name the model with --sample"},
      Row{NoModelFits, "no_model_fits", "save a sample of this model with biteline model save"},
      Row{OrderDisagrees, "order_disagrees",
          "look whether this is the shoe that was ordered; then name its model"},
  };
  return k_rows;
}

std::optional<Refusal> why_moved(const std::optional<bite_line::SeamStep>& seam) {
  if (!seam || seam->moved_mm <= bite_line::k_most_moved_mm) return std::nullopt;
  return Refusal{.code = Refused::DoesNotClose, .reason = bite_line::does_not_close(*seam).c_str()};
}

}  // namespace biteline::transfer
