// SPDX-License-Identifier: MIT
#pragma once
/// \file Files that the build puts into the program.

#include <string_view>

namespace biteline::results {

[[nodiscard]] std::string_view tracking_html();  ///< the page with its two marks, tracking.html
[[nodiscard]] std::string_view three_js();       ///< the 3-D library, MIT licence

}  // namespace biteline::results
