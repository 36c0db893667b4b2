// SPDX-License-Identifier: MIT
#pragma once
/// \file index.html of a demo: all shoes side by side, then each with its pictures and the moving arm.

#include <vector>

#include "host/apps/biteline-demo/cell_run.hpp"

namespace biteline::demo {

[[nodiscard]] Result<void> write_demo_page(const CellOptions& options, const std::vector<ShoeResult>& results,
                                           const std::string& verdict, bool good);

}  // namespace biteline::demo
