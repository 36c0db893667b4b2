// SPDX-License-Identifier: MIT
#pragma once
/// \file First guesses of how a sample lies on an upper, each tried coarsely.

#include <vector>

#include "host/transfer/align/alignment.hpp"

namespace biteline::transfer {

/// Best first, no two alike (5 mm, 5 degrees).  At least one.
[[nodiscard]] std::vector<IcpResult> coarse_fits(const Sample& sample, const Upper& upper, Freedom freedom);

}  // namespace biteline::transfer
