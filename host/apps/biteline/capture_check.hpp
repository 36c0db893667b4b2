// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline capture check`.

#include "host/apps/biteline/command.hpp"

namespace biteline::app {

void add_capture_check(options::Command& capture, Context& context);

}  // namespace biteline::app
