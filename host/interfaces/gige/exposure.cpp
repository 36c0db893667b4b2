// SPDX-License-Identifier: MIT
#include "host/interfaces/gige/exposure.hpp"

#include <cmath>

#include "common/settings/settings.hpp"

namespace biteline::gige {

Nanoseconds exposure_of(const wire::SensorHello& hello) {
  return hello.model.exposure.value_or(Nanoseconds{0});
}

Nanoseconds exposure_of(const wire::Health& health, Nanoseconds otherwise) {
  if (health.devices.capture && health.devices.capture->exposure.count() > 0)
    return health.devices.capture->exposure;
  if (!health.settings) return otherwise;
  const auto set = settings::parse_settings(health.settings->text, "settings in use");
  if (!set) return otherwise;
  const std::optional<double> us = set->number(settings::Key::ExposureUs);
  return us ? Nanoseconds{std::llround(1e3 * *us)} : otherwise;
}

}  // namespace biteline::gige
