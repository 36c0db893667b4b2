// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline capture scan`.

#include "host/apps/biteline/command.hpp"

namespace biteline::app {

void add_capture_scan(options::Command& capture, Context& context);

}  // namespace biteline::app
