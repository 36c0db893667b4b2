// SPDX-License-Identifier: MIT
#pragma once
/// \file SafetyIn on one or two GPIO lines.

#include <memory>
#include <optional>

#include "hal/api/safety_in.hpp"
#include "hal/linux/gpiod/line_request.hpp"

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
  GpiodSafetyIn(Descriptor interlock, Descriptor key)
      : interlock_{std::move(interlock)}, key_{std::move(key)} {}

  Descriptor interlock_;
  Descriptor key_;  ///< closed on a head without key switch
};

}  // namespace biteline::hal
