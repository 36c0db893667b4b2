// SPDX-License-Identifier: MIT
#include "firmware/app/cell_source.hpp"

#include <string_view>
#include <utility>

#include "common/config/sensor_yaml.hpp"
#include "hal/linux/aravis/aravis_camera.hpp"
#include "hal/linux/socketcan/can_pose_source.hpp"
#include "hal/sim/bus/bus_devices.hpp"

namespace biteline::sensor {
namespace {

/// Loopback takes packets of this size (its MTU is 65536); the camera's default would cost ten times the interrupts.
constexpr int k_loopback_packet_bytes = 16000;

class Cell final : public SourceKind {
 public:
  Cell(std::string wires, std::string camera_address, geometry::SensorModel head)
      : wires_{std::move(wires)}, camera_address_{std::move(camera_address)} {
    model = std::move(head);
    simulated = true;
  }

  Result<Source> open() override {
    Source source;
    source.scan_name = "cell";
    BITELINE_ASSIGN(source.camera, hal::AravisCamera::open({.address = camera_address_, .packet_bytes = k_loopback_packet_bytes}));
    BITELINE_TRY(configure(*source.camera));
    BITELINE_ASSIGN(std::unique_ptr<hal::CanBus> bus, sim::SimCanBus::open(wires_));
    source.poses = std::make_unique<hal::CanPoseSource>(std::move(bus), clock_, hal::CanPoseSource::Config{});
    BITELINE_ASSIGN(source.trigger, sim::SimPwmOut::open(wires_));
    BITELINE_TRY(source.trigger->configure({.period = period(), .pulse = *model.exposure}));
    BITELINE_ASSIGN(source.scan_active, sim::SimEdgeIn::open(wires_, sim::Line::ScanActive));
    return source;
  }

  Result<std::optional<LaserDevices>> open_laser() override {
    LaserDevices devices;
    BITELINE_ASSIGN(devices.laser, sim::SimGpioOut::open(wires_, sim::Line::LaserEnable));
    BITELINE_ASSIGN(devices.safety, sim::SimSafetyIn::open(wires_));
    return std::optional<LaserDevices>{std::move(devices)};
  }

 private:
  [[nodiscard]] Nanoseconds period() const {
    return Nanoseconds{static_cast<std::int64_t>(1e9 / *model.rate_hz)};
  }

  Result<void> configure(hal::LineCamera& camera) const {
    const hal::CameraSettings wanted{.region = model.region,
                                     .exposure = *model.exposure,
                                     .rate_hz = *model.rate_hz,
                                     .trigger = hal::Trigger::Hardware};
    BITELINE_ASSIGN(const hal::CameraSettings got, camera.configure(wanted));
    const geometry::Region& region = got.region;
    if (region.offset_u_px == model.region.offset_u_px && region.offset_v_px == model.region.offset_v_px &&
        region.width_px == model.region.width_px && region.height_px == model.region.height_px) {
      return {};
    }
    return fail(Errc::DeviceError, "camera %s: its region is %d x %d at %d, %d instead of the head's",
                camera_address_.c_str(), region.width_px, region.height_px, region.offset_u_px, region.offset_v_px);
  }

  std::string wires_;
  std::string camera_address_;
  hal::MonotonicClock clock_;
};

}  // namespace

Result<std::unique_ptr<SourceKind>> open_cell(const std::string& address, const std::filesystem::path& sensor_file) {
  constexpr std::string_view k_camera = ",camera=";
  const std::size_t comma = address.find(k_camera);
  const std::string wires = address.substr(0, comma);
  const std::string camera = comma == std::string::npos ? "127.0.0.1" : address.substr(comma + k_camera.size());
  BITELINE_ASSIGN(geometry::SensorModel head, config::read_sensor_yaml(sensor_file));
  if (!head.rate_hz || !head.exposure || *head.rate_hz <= 0) {
    return fail(Errc::BadValue, "%s: rate_hz and exposure_ns are needed to run a camera", sensor_file.c_str());
  }
  return std::make_unique<Cell>(wires, camera, std::move(head));
}

}  // namespace biteline::sensor
