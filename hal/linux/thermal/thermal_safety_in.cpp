// SPDX-License-Identifier: MIT
#include "hal/linux/thermal/thermal_safety_in.hpp"

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::hal {

Result<std::unique_ptr<SafetyIn>> ThermalSafetyIn::open(std::unique_ptr<SafetyIn> inner,
                                                        const Config& config) {
  BITELINE_TRY(read_integer(config.file.c_str()));
  return std::unique_ptr<SafetyIn>{new ThermalSafetyIn{std::move(inner), config}};
}

Result<SafetyInputs> ThermalSafetyIn::read() noexcept {
  BITELINE_ASSIGN(SafetyInputs inputs, inner_->read());
  if (looks_left_ == 0) {
    BITELINE_ASSIGN(const std::int64_t millidegrees, read_integer(config_.file.c_str()));
    too_hot_ = 1e-3 * static_cast<double>(millidegrees) > config_.max_degc;
    looks_left_ = k_looks;
  }
  --looks_left_;
  inputs.too_hot = inputs.too_hot || too_hot_;
  return inputs;
}

}  // namespace biteline::hal
