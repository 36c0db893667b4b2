// SPDX-License-Identifier: MIT
#pragma once
/// \file Which line of a board: data that board.yaml has and every backend for lines takes.

#include <string>

namespace biteline::hal {

/// A line by the chip's device ("/dev/gpiochip0") or label ("9030000.pl061", "gpio-sim"), and by its number
/// or name.
struct GpioLineAddress {
  std::string chip;
  std::string line;
  bool active_low{false};
  enum class Bias { AsIs, PullUp, PullDown, Disabled } bias{Bias::AsIs};
};

}  // namespace biteline::hal
