// SPDX-License-Identifier: MIT
#pragma once
/// \file SafetyIn on one or two lines of libgpiod.

#include <memory>
#include <optional>
#include <utility>

#include "hal/api/safety_in.hpp"
#include "hal/linux/gpiod/gpiod_line.hpp"

namespace biteline::hal {

/// Wire the interlock so that a cut cable reads open: closed loop = active, bias towards inactive.
class GpiodSafetyIn final : public SafetyIn {
 public:
  struct Config {
    GpioLineAddress interlock;
    std::optional<GpioLineAddress> key;  ///< nothing: a head without key switch
  };
  [[nodiscard]] static Result<std::unique_ptr<GpiodSafetyIn>> open(const Config& config);

  [[nodiscard]] Result<SafetyInputs> read() noexcept override;

 private:
  GpiodSafetyIn(GpiodLine interlock, std::optional<GpiodLine> key)
      : interlock_{std::move(interlock)}, key_{std::move(key)} {}

  GpiodLine interlock_;
  std::optional<GpiodLine> key_;  ///< nothing: a head without key switch
};

}  // namespace biteline::hal
