// SPDX-License-Identifier: MIT
#pragma once
/// \file The formats' texts, one file each.  All numbers in mm, base.

#include <string>

#include "host/cloud/closed_line.hpp"

namespace biteline::line_files {

[[nodiscard]] std::string dxf_text(const cloud::ClosedLine& line);
[[nodiscard]] std::string json_text(const cloud::ClosedLine& line);
[[nodiscard]] std::string ply_text(const cloud::ClosedLine& line);
[[nodiscard]] std::string step_text(const cloud::ClosedLine& line);

}  // namespace biteline::line_files
