// SPDX-License-Identifier: MIT
#pragma once
/// \file SafetyIn round another one, with the head's temperature as a further word.

#include <memory>
#include <string>

#include "hal/api/safety_in.hpp"

namespace biteline::hal {

/// Reads the kernel's file (thermal zone or hwmon: thousandths of a degree) at every k_looks-th look, since a
/// sensor on I2C takes a millisecond and a head some minutes to warm up.  A file that cannot be read is an
/// Error: unknown means off. Thread: one owner.
class ThermalSafetyIn final : public SafetyIn {
 public:
  struct Config {
    std::string file;
    double max_degc{0};
  };
  [[nodiscard]] static Result<std::unique_ptr<SafetyIn>> open(std::unique_ptr<SafetyIn> inner,
                                                              const Config& config);

  [[nodiscard]] Result<SafetyInputs> read() noexcept override;

 private:
  /// Of 10 ms each: well within the limit from fault to darkness.
  static constexpr int k_looks = 5;

  ThermalSafetyIn(std::unique_ptr<SafetyIn> inner, Config config)
      : inner_{std::move(inner)}, config_{std::move(config)} {}

  std::unique_ptr<SafetyIn> inner_;
  Config config_;
  int looks_left_{0};
  bool too_hot_{true};
};

}  // namespace biteline::hal
