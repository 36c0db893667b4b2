// SPDX-License-Identifier: MIT
#include "hal/sim/gvcamera/gv_camera.hpp"

#include <arpa/inet.h>
#include <arv.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>

#include "common/gige/bootstrap.hpp"
#include "hal/sim/gvcamera/genicam_description.hpp"
#include "hal/sim/gvcamera/register_guard.hpp"

namespace biteline::sim {

namespace {

/// How often the fake camera looks for a trigger; its default of 25 Hz would be the highest frame rate.
/// Aravis sleeps whole milliseconds and spins for the rest: at 1000 Hz that is all the time, a processor for
/// itself.  Until it has sent a stream's first frame it looks every 100 ms, whatever it is told (0.8.26): the
/// first edges wait, and their frames come in a burst.
constexpr double k_trigger_poll_hz = 250;
/// Edges whose frames are still to be made on a busy machine: half a second at 100 a second.
constexpr std::size_t k_edges_kept = 50;
constexpr std::uint32_t k_temperature_millidegc = 41'500;
/// GVSP numbers frames in 16 bits and leaves out 0.
constexpr std::uint64_t k_frame_numbers = 65535;

SensorClock::time_point monotonic_now() {
  return SensorClock::time_point{
      std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())};
}

/// A file that exists only as long as somebody holds it: Aravis wants a path.
Result<int> memory_file(const std::string& content) {
  const int descriptor = memfd_create("genicam", 0);
  if (descriptor < 0) return fail_errno(Errc::DeviceError, errno, "simulated camera: memfd_create");
  if (write(descriptor, content.data(), content.size()) != static_cast<ssize_t>(content.size())) {
    const int number = errno;
    close(descriptor);
    return fail_errno(Errc::DeviceError, number, "simulated camera: GenICam description");
  }
  return descriptor;
}

/// A GVCP READREG command for the version register (address 0): answered at once, changes nothing.
constexpr std::array<std::uint8_t, 12> k_read_register{0x42, 0x01, 0x00, 0x80, 0x00, 0x04,
                                                       0xff, 0xff, 0,    0,    0,    0};

/// A UDP socket that `use` (connect or bind) has tied to the camera's address and port.
Result<int> socket_at_camera(const std::string& address, decltype(&connect) use) {
  sockaddr_in camera{};
  camera.sin_family = AF_INET;
  camera.sin_port = htons(gige::k_port);
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0 || inet_pton(AF_INET, address.c_str(), &camera.sin_addr) != 1 ||
      use(descriptor, reinterpret_cast<const sockaddr*>(&camera), sizeof camera) != 0) {
    const int number = errno;
    if (descriptor >= 0) close(descriptor);
    return fail_errno(Errc::ConnectFailed, number,
                      "simulated camera: %s port %d (the standard's: one camera to a network)",
                      address.c_str(), gige::k_port);
  }
  return descriptor;
}

/// Aravis shares its port with whoever else serves a camera there, and then each gets some of the other's
/// packets: only a socket that does not share finds out.
Result<void> expect_free_port(const std::string& address) {
  BITELINE_ASSIGN(const int descriptor, socket_at_camera(address, &bind));
  close(descriptor);
  return {};
}

}  // namespace

struct GvCamera::Device {
  ArvGvFakeCamera* server{nullptr};
  ArvFakeCamera* registers{nullptr};  ///< owned by the server
  int description{-1};
  int waker{-1};  ///< see wake()

  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() {
    end();
    if (description >= 0) close(description);
    if (waker >= 0) close(waker);
  }
  /// Aravis 0.8.26 computes the time to its next look for a trigger without a sign: when its thread comes
  /// back after that moment, as on a busy machine, it sleeps 100 ms on its socket instead.  A packet ends
  /// that sleep.
  void wake() const {
    std::array<std::uint8_t, 64> answer{};
    while (recv(waker, answer.data(), answer.size(), MSG_DONTWAIT) > 0) {
    }
    (void)send(waker, k_read_register.data(), k_read_register.size(),
               MSG_DONTWAIT);  // the next trigger tries again
  }
  /// Joins the server's thread and gives the port back.
  void end() {
    if (server != nullptr) g_object_unref(server);
    server = nullptr;
  }
  [[nodiscard]] std::uint32_t read(std::uint32_t address) const {
    guint32 value = 0;
    arv_fake_camera_read_register(registers, address, &value);
    return value;
  }
  [[nodiscard]] Nanoseconds exposure(std::uint32_t set) const {
    return Nanoseconds{static_cast<std::int64_t>(read(gv_register::k_exposure_us + set)) * 1000};
  }
  void write(std::uint32_t address, std::uint32_t value) const {
    const OwnAccess own;
    arv_fake_camera_write_register(registers, address, value);
  }
  /// A bootstrap register for text.
  void write_text(std::uint32_t address, std::string_view text) const {
    std::array<char, 32> bytes{};
    text.copy(bytes.data(), bytes.size() - 1);
    const OwnAccess own;
    arv_fake_camera_write_memory(registers, address, bytes.size(), bytes.data());
  }
};

GvCamera::GvCamera(const Config& config, Painter painter)
    : config_(config), painter_(std::move(painter)), device_(std::make_unique<Device>()) {}

GvCamera::~GvCamera() {
  device_->end();  // its thread paints with everything else in here
}

Result<std::unique_ptr<GvCamera>> GvCamera::open(const Config& config, Painter painter) {
  std::unique_ptr<GvCamera> camera(new GvCamera(config, std::move(painter)));
  Device& device = *camera->device_;
  BITELINE_TRY(expect_free_port(config.address));
  BITELINE_ASSIGN(device.description, memory_file(genicam_description()));
  const std::string path = "/proc/self/fd/" + std::to_string(device.description);
  {
    const OwnAccess own;
    device.server = arv_gv_fake_camera_new_full(config.address.c_str(), config.serial.c_str(), path.c_str());
  }
  if (device.server == nullptr || arv_gv_fake_camera_is_running(device.server) == FALSE) {
    return fail(Errc::ConnectFailed, "simulated camera: %s is no interface's address of this machine",
                config.address.c_str());
  }
  g_object_set(device.server, "gvsp-lost-ratio", config.lost_packet_ratio, nullptr);
  device.registers = arv_gv_fake_camera_get_fake_camera(device.server);
  BITELINE_ASSIGN(device.waker, socket_at_camera(config.address, &connect));
  using namespace gv_register;
  device.write(k_sensor_width, static_cast<std::uint32_t>(config.sensor_width_px));
  device.write(k_sensor_height, static_cast<std::uint32_t>(config.sensor_height_px));
  device.write(k_width, static_cast<std::uint32_t>(config.region.width_px));
  device.write(k_height, static_cast<std::uint32_t>(config.region.height_px));
  device.write(k_offset_x, static_cast<std::uint32_t>(config.region.offset_u_px));
  device.write(k_offset_y, static_cast<std::uint32_t>(config.region.offset_v_px));
  device.write(k_exposure_us, static_cast<std::uint32_t>(config.exposure.count() / 1000));
  device.write(k_frame_period_us, static_cast<std::uint32_t>(1e6 / config.rate_hz));
  device.write(k_trigger_source, 1);
  for (const std::uint32_t set : {0U, k_set_stride})
    device.write(k_line_source + 4 + set, k_line_exposure_active);
  device.write_text(k_vendor_name, k_gv_vendor);
  device.write_text(k_model_name, k_gv_model);
  device.write(k_temperature_millidegc_register, k_temperature_millidegc);
  for (const std::uint32_t factor : {k_binning_x, k_binning_y, k_decimation_x, k_decimation_y})
    device.write(factor, 1);
  if (config.resends) device.write(k_gvcp_capability, device.read(k_gvcp_capability) | k_can_resend);
  device.write(k_ptp_enable, config.ptp ? 1 : 0);
  device.write(k_ptp_status, config.ptp ? k_ptp_slave : k_ptp_disabled);
  arv_fake_camera_set_trigger_frequency(device.registers, k_trigger_poll_hz);
  arv_fake_camera_set_fill_pattern(
      device.registers,
      [](ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat) {
        static_cast<GvCamera*>(self)->paint(buffer);
      },
      camera.get());
  return camera;
}

bool GvCamera::acquiring() const {
  return arv_fake_camera_get_acquisition_status(device_->registers) != 0;
}

void GvCamera::trigger(SensorClock::time_point edge) {
  if (!acquiring() || device_->read(gv_register::k_trigger_mode) == 0) {
    ++triggers_missed_;
    return;
  }
  const std::lock_guard lock(edges_mutex_);
  // A new stream has a port of its own: edges that waited when the last one was stopped wait for nothing.
  const std::uint32_t port = device_->read(gv_register::k_stream_port);
  if (std::exchange(stream_port_, port) != port) {
    triggers_missed_ += edges_.size();
    edges_.clear();
    exposed_until_ = {};
  }
  if (edge < exposed_until_ || edges_.size() >= k_edges_kept) {
    ++triggers_missed_;
    device_->wake();  // it may sleep on those that wait: else no edge would ever end that sleep
    return;
  }
  edges_.push_back({.begin = edge, .exposure = device_->exposure(0)});
  exposed_until_ = edge + edges_.back().exposure;
  device_->write(gv_register::k_trigger_fire, 1);
  device_->wake();
}

void GvCamera::leave(std::uint32_t address, std::uint32_t value) {
  device_->write(address, value);
}

void GvCamera::lock_state() {
  device_->write(gv_register::k_state_locked, 1);
}

void GvCamera::paint_as_set(GvExposure& exposure, std::span<std::uint8_t> pixels) {
  using namespace gv_register;
  const auto set = [&](std::uint32_t address) { return static_cast<int>(device_->read(address)); };
  const int step_u = std::max(1, set(k_binning_x) * set(k_decimation_x)),
            step_v = std::max(1, set(k_binning_y) * set(k_decimation_y));
  const bool reverse_x = set(k_reverse_x) != 0, reverse_y = set(k_reverse_y) != 0;
  const int black_level = set(k_black_level);
  if (step_u == 1 && step_v == 1 && !reverse_x && !reverse_y && black_level == 0)
    return painter_(exposure, pixels);
  // Of the sensor's own pixels: a reversed picture's region is counted from its other end.
  const geometry::Region asked = exposure.region;
  geometry::Region& region = exposure.region;
  region = {.offset_u_px = asked.offset_u_px * step_u,
            .offset_v_px = asked.offset_v_px * step_v,
            .width_px = asked.width_px * step_u,
            .height_px = asked.height_px * step_v};
  if (reverse_x) region.offset_u_px = config_.sensor_width_px - region.offset_u_px - region.width_px;
  if (reverse_y) region.offset_v_px = config_.sensor_height_px - region.offset_v_px - region.height_px;
  unbinned_.resize(static_cast<std::size_t>(region.width_px) * static_cast<std::size_t>(region.height_px));
  painter_(exposure, unbinned_);
  const int binned_u = std::max(1, set(k_binning_x)), binned_v = std::max(1, set(k_binning_y));
  for (int v = 0; v < asked.height_px; ++v) {
    for (int u = 0; u < asked.width_px; ++u) {
      const int from_u = (reverse_x ? asked.width_px - 1 - u : u) * step_u,
                from_v = (reverse_y ? asked.height_px - 1 - v : v) * step_v;
      int sum = 0;
      for (int j = 0; j < binned_v; ++j) {
        for (int i = 0; i < binned_u; ++i) {
          sum += unbinned_[static_cast<std::size_t>(from_v + j) * static_cast<std::size_t>(region.width_px) +
                           static_cast<std::size_t>(from_u + i)];
        }
      }
      pixels[static_cast<std::size_t>(v) * static_cast<std::size_t>(asked.width_px) +
             static_cast<std::size_t>(u)] =
          static_cast<std::uint8_t>(std::min(255, sum / (binned_u * binned_v) + black_level));
    }
  }
}

void GvCamera::paint(void* buffer_pointer) {
  auto* buffer = static_cast<ArvBuffer*>(buffer_pointer);
  // A sequencer that was set up anew begins with set 0, and its frames are numbered from 1 again.
  if (device_->read(gv_register::k_sequencer_begun_anew) != 0) {
    device_->write(gv_register::k_sequencer_begun_anew, 0);
    frames_of_sequence_ = 0;
  }
  // This frame still goes out; the next one waits for another start.
  if (device_->read(gv_register::k_acquisition_mode) == k_single_frame)
    device_->write(gv_register::k_acquisition, 0);
  const bool sequenced = device_->read(gv_register::k_sequencer_mode) != 0;
  const std::uint32_t set = sequenced && frames_of_sequence_ % 2 == 1 ? gv_register::k_set_stride : 0;
  const std::uint64_t number = 1 + frames_of_sequence_++ % k_frame_numbers;
  GvExposure exposure{.region = {.offset_u_px = static_cast<int>(device_->read(gv_register::k_offset_x)),
                                 .offset_v_px = static_cast<int>(device_->read(gv_register::k_offset_y)),
                                 .width_px = arv_buffer_get_image_width(buffer),
                                 .height_px = arv_buffer_get_image_height(buffer)},
                      .exposure = device_->exposure(set),
                      .begin = {},
                      .triggered = false,
                      .strobe = device_->read(gv_register::k_line_source + 4 + set) == k_line_exposure_active,
                      .sequence = exposures_.fetch_add(1),
                      .gain_db = 0.01 * device_->read(gv_register::k_gain_centidb)};
  exposure.begin = monotonic_now() - exposure.exposure;  // free run: a frame comes when its exposure is over
  {
    const std::lock_guard lock(edges_mutex_);
    if (device_->read(gv_register::k_trigger_mode) == 0) {
      edges_.clear();
    } else if (!edges_.empty()) {
      exposure.begin = edges_.front().begin;
      if (set == 0) exposure.exposure = edges_.front().exposure;
      exposure.triggered = true;
      edges_.pop_front();
      if (!edges_.empty()) device_->write(gv_register::k_trigger_fire, 1);
    }
  }
  std::this_thread::sleep_until(
      std::chrono::steady_clock::time_point{exposure.begin.time_since_epoch() + exposure.exposure});
  // Aravis reports no size here: the buffer is as large as the picture by the payload's definition.
  std::size_t unused = 0;
  auto* pixels = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &unused)));
  paint_as_set(exposure, {pixels, static_cast<std::size_t>(exposure.region.width_px) *
                                      static_cast<std::size_t>(exposure.region.height_px)});
  const Nanoseconds stamp = exposure.begin.time_since_epoch() + config_.clock_offset;
  arv_buffer_set_timestamp(buffer, static_cast<guint64>(stamp.count()));
  arv_buffer_set_frame_id(buffer, number);
}

}  // namespace biteline::sim
