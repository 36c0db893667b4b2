// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/refused.hpp"

#include <array>

namespace biteline::service {

std::span<const report::RefusalRow<Refused>> refusal_table(Refused) {
  static constexpr std::array k_rows{
      report::RefusalRow<Refused>{Refused::ModelUnknown, "model_unknown",
                                  "choose the model and scan again, or save this scan as a model"},
      report::RefusalRow<Refused>{Refused::RerunFailed, "rerun_failed",
                                  "mend what the reason names, then work the scan out again"},
      report::RefusalRow<Refused>{Refused::CalibrationDrifted, "calibration_drifted",
                                  "look at the part that is named, then calibrate the head again"},
      report::RefusalRow<Refused>{Refused::OtherProcess, "other_process",
                                  "accept it as it is planned, or choose the model's process"},
      report::RefusalRow<Refused>{Refused::PartWorkedBefore, "part_worked_before",
                                  "look at the shoe: accept it where it is another one, else reject it"},
      report::RefusalRow<Refused>{Refused::LineOffMended, "line_off_mended",
                                  "look at the line there; mend it, or save this scan as the model"},
      report::RefusalRow<Refused>{Refused::WorkNotLookedAt, "work_not_looked_at",
                                  "look at the shoe by eye, then start"},
      report::RefusalRow<Refused>{Refused::SequenceCut, "sequence_cut",
                                  "take the shoe out, or start what is missing of it by its process"},
  };
  return k_rows;
}

}  // namespace biteline::service
