// SPDX-License-Identifier: MIT
#pragma once
/// \file Why the service itself gives a scan no result.

#include "host/report/refusal.hpp"

namespace biteline::service {

enum class Refused {
  ModelUnknown,        ///< no model of the library is sure enough to be worked without a person
  RerunFailed,         ///< a kept scan could not be worked out again
  CalibrationDrifted,  ///< since it was made, as its scans of some shoes show
  OtherProcess,        ///< a person took another process than the model's own
  PartWorkedBefore,    ///< a path was sent for a shoe of this part number
  LineOffMended,       ///< the line lies off the mended line of its model by more than both are known
  WorkNotLookedAt,     ///< it was worked, and the look at what was done did not come
  SequenceCut,         ///< the shoe was worked with some of its processes, and not with all
};

[[nodiscard]] std::span<const report::RefusalRow<Refused>> refusal_table(Refused);

using Refusal = report::Refusal<Refused>;

}  // namespace biteline::service
