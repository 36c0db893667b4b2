// SPDX-License-Identifier: MIT
/// \file geometry::CameraState by SFNC's features: a camera keeps them until power goes, and from its user
/// set.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "hal/linux/aravis/aravis_device.hpp"

namespace biteline::hal {
namespace {

using geometry::StateKey;

enum class Kind { Boolean, Integer, Float };

struct Feature {
  StateKey key;
  const char* name;
  Kind kind;
};

/// In this order: skipped pixels are counted in binned ones.
constexpr std::array k_features{
    Feature{StateKey::MirrorX, "ReverseX", Kind::Boolean},
    Feature{StateKey::MirrorY, "ReverseY", Kind::Boolean},
    Feature{StateKey::BinningX, "BinningHorizontal", Kind::Integer},
    Feature{StateKey::BinningY, "BinningVertical", Kind::Integer},
    Feature{StateKey::DecimationX, "DecimationHorizontal", Kind::Integer},
    Feature{StateKey::DecimationY, "DecimationVertical", Kind::Integer},
    Feature{StateKey::BlackLevel, "BlackLevel", Kind::Float},
    Feature{StateKey::Focus, "FocalPower", Kind::Float},
    Feature{StateKey::Aperture, "Aperture", Kind::Float},
};

/// What the camera says; nothing where it cannot, unless it is gone.
std::optional<double> read(ArvCamera* camera, const Feature& feature, GError** error) {
  double value = 0;
  switch (feature.kind) {
    case Kind::Boolean:
      value = arv_camera_get_boolean(camera, feature.name, error) != FALSE ? 1 : 0;
      break;
    case Kind::Integer:
      value = static_cast<double>(arv_camera_get_integer(camera, feature.name, error));
      break;
    case Kind::Float:
      value = arv_camera_get_float(camera, feature.name, error);
      if (*error == nullptr || !g_error_matches(*error, ARV_DEVICE_ERROR, ARV_DEVICE_ERROR_WRONG_FEATURE))
        break;
      // Cameras of before SFNC 2 count it in steps.
      g_clear_error(error);
      value = static_cast<double>(arv_camera_get_integer(camera, feature.name, error));
      break;
  }
  if (*error != nullptr || !std::isfinite(value)) return std::nullopt;
  return value;
}

void write(ArvCamera* camera, const Feature& feature, double value, GError** error) {
  switch (feature.kind) {
    case Kind::Boolean:
      arv_camera_set_boolean(camera, feature.name, value != 0 ? TRUE : FALSE, error);
      return;
    case Kind::Integer:
      arv_camera_set_integer(camera, feature.name, std::llround(value), error);
      return;
    case Kind::Float:
      arv_camera_set_float(camera, feature.name, value, error);
      if (*error == nullptr || !g_error_matches(*error, ARV_DEVICE_ERROR, ARV_DEVICE_ERROR_WRONG_FEATURE))
        return;
      g_clear_error(error);
      arv_camera_set_integer(camera, feature.name, std::llround(value), error);
      return;
  }
}

}  // namespace

Result<geometry::CameraState> AravisCamera::set_state(const geometry::CameraState& wanted) {
  if (device_->state == Device::State::Running)
    return fail(Errc::WrongState, "camera %s: set while running", device_->config.address.c_str());
  for (const Feature& feature : k_features) {
    if (!wanted[feature.key] || !device_->has(feature.name)) continue;
    Call call(device_->config.address, feature.name);
    if (feature.key == StateKey::BlackLevel && device_->has("BlackLevelAuto"))
      arv_camera_set_string(device_->camera, "BlackLevelAuto", "Off", nullptr);
    // One that refuses stays as it is, and state() shows that; one that is gone fails there.
    write(device_->camera, feature, *wanted[feature.key], call);
  }
  return state();
}

Result<geometry::CameraState> AravisCamera::state() {
  geometry::CameraState state;
  for (const Feature& feature : k_features) {
    if (!device_->has(feature.name)) continue;
    Call call(device_->config.address, feature.name);
    state[feature.key] = read(device_->camera, feature, call);
    if (!call.failed()) continue;
    const tl::unexpected<Error> failure = call.failure();
    if (failure.value().code == Errc::DeviceLost) return failure;
  }
  int width_px = 0, height_px = 0;
  BITELINE_TRY(device_->full_size(width_px, height_px));
  state[StateKey::SensorWidth] = width_px;
  state[StateKey::SensorHeight] = height_px;
  Call call(device_->config.address, "PixelFormat");
  const char* const format = arv_camera_get_pixel_format_as_string(device_->camera, call);
  if (call.failed()) return call.failure();
  state.pixel_format = format != nullptr ? format : "";
  return state;
}

Result<void> AravisCamera::Device::full_size(int& width_px, int& height_px) const {
  Call call(config.address, "size");
  arv_camera_get_sensor_size(camera, &width_px, &height_px, call);
  if (call.failed()) return call.failure();
  const auto bounded = [&](const char* feature, int& size_px) {
    if (!has(feature) || call.failed()) return;
    const gint64 most = arv_camera_get_integer(camera, feature, call);
    if (!call.failed() && most > 0) size_px = static_cast<int>(std::min<gint64>(size_px, most));
  };
  bounded("WidthMax", width_px);
  bounded("HeightMax", height_px);
  if (call.failed()) return call.failure();
  return {};
}

}  // namespace biteline::hal
