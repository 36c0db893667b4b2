// SPDX-License-Identifier: MIT
#pragma once
/// \file `biteline capture accept`.

#include "host/apps/biteline/command.hpp"

namespace biteline::app {

void add_capture_accept(options::Command& capture, Context& context);

}  // namespace biteline::app
