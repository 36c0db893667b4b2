// SPDX-License-Identifier: MIT
#pragma once
/// \file The same work on many things, some of them at a time.

#include <cstddef>
#include <functional>

#include "common/core/result.hpp"

namespace biteline::batch {

/// Calls `work` once for each index below `count`, in rising order, at most `jobs` at a time on threads that
/// live until the end.  The first failure ends the work: what has begun is finished, and it is returned.
[[nodiscard]] Result<void> for_each_index(std::size_t count, int jobs,
                                          const std::function<Result<void>(std::size_t)>& work);

}  // namespace biteline::batch
