// SPDX-License-Identifier: MIT
#pragma once
/// \file Why an upper is not the next one of the sample's model, in words an operator can act on.

#include <string>

#include "host/transfer/align/alignment.hpp"

namespace biteline::transfer {

struct Diagnosis {
  Verdict verdict{Verdict::OtherModel};
  std::string reason{};
};

/// The other foot, another size, both, upside down, or another model.  Up to four more alignments, each as
/// long as the first.  `refused`: what align() found with the same options, verdict OtherModel.
[[nodiscard]] Diagnosis diagnose(const Sample& sample, const Upper& upper, const AlignOptions& options,
                                 const Alignment& refused);

}  // namespace biteline::transfer
