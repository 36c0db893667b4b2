// SPDX-License-Identifier: MIT
#pragma once
/// \file What to show the scanner so that the height is fixed.

#include <string>

#include "host/transfer/align/prepared.hpp"

namespace biteline::transfer {

/// Of the sample alone, before an upper is scanned: empty when its collar's edge is in view.
[[nodiscard]] std::string advice_for_sample(const Sample& sample);

/// Of both, once the sample lies on the upper: empty when the two edges are one and in view.
[[nodiscard]] std::string advice_for_upper(const Sample& sample, const Upper& upper,
                                           const SE3& T_upper_sample_shoe, bool same_edge);

}  // namespace biteline::transfer
