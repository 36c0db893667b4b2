// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline line edit` and `biteline line show`.

#include "host/apps/biteline/command.hpp"

namespace biteline::app {

void add_line_edit(options::Command& line, Context& context);

}  // namespace biteline::app
