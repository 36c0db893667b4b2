// SPDX-License-Identifier: MIT
#include "firmware/app/cell_source.hpp"

#include <string_view>
#include <utility>

#include "firmware/app/live_head.hpp"
#include "firmware/runtime/thread_table.hpp"
#include "hal/linux/aravis/aravis_camera.hpp"
#include "hal/linux/socketcan/can_pose_source.hpp"
#include "hal/sim/bus/bus_devices.hpp"
#include "hal/timing/triggered_camera.hpp"

namespace biteline::sensor {
namespace {

/// Loopback takes packets of this size (its MTU is 65536); the camera's default would cost ten times the
/// interrupts.
constexpr int k_loopback_packet_bytes = 16000;

/// The cell's camera stamps the edge itself (its clock is this machine's): edge to mid-exposure is half an
/// exposure, of at most 10 ms.
constexpr hal::TriggeredCamera::Config k_pairing{.pairing = {.latency_min = std::chrono::microseconds{-100},
                                                             .latency_max = std::chrono::microseconds{5100}}};

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
    BITELINE_ASSIGN(
        std::unique_ptr<hal::LineCamera> camera,
        hal::AravisCamera::open({.address = camera_address_,
                                 .packet_bytes = k_loopback_packet_bytes,
                                 .receive_priority = realtime ? runtime::threads::k_receive.priority : 0}));
    BITELINE_ASSIGN(std::unique_ptr<hal::EdgeIn> strobe_echo,
                    sim::SimEdgeIn::open(wires_, sim::Line::StrobeEcho));
    source.camera =
        std::make_unique<hal::TriggeredCamera>(std::move(camera), std::move(strobe_echo), k_pairing);
    BITELINE_TRY(configure_as_head(*source.camera, model, capture, hal::Trigger::Hardware));
    BITELINE_ASSIGN(std::unique_ptr<hal::CanBus> bus, sim::SimCanBus::open(wires_));
    source.poses = std::make_unique<hal::CanPoseSource>(std::move(bus), clock_, hal::CanPoseSource::Config{});
    BITELINE_ASSIGN(source.trigger, sim::SimPwmOut::open(wires_));
    BITELINE_TRY(source.trigger->configure(train_of(model, capture)));
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
  std::string wires_;
  std::string camera_address_;
  hal::MonotonicClock clock_;
};

}  // namespace

Result<std::unique_ptr<SourceKind>> open_cell(const std::string& address,
                                              const std::filesystem::path& sensor_file) {
  constexpr std::string_view k_camera = ",camera=";
  const std::size_t comma = address.find(k_camera);
  const std::string wires = address.substr(0, comma);
  const std::string camera =
      comma == std::string::npos ? "127.0.0.1" : address.substr(comma + k_camera.size());
  BITELINE_ASSIGN(geometry::SensorModel head, read_live_head(sensor_file));
  return std::make_unique<Cell>(wires, camera, std::move(head));
}

}  // namespace biteline::sensor
