// SPDX-License-Identifier: MIT
#pragma once
/// \file A simulated GigE Vision camera: Aravis' own fake camera on the network, with pictures of ours.

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "common/geometry/sensor_model.hpp"

namespace biteline::sim {

/// One exposure that the camera is about to make.
struct GvExposure {
  geometry::Region region;
  Nanoseconds exposure{0};
  SensorClock::time_point begin;  ///< start of the exposure, on this machine's monotonic clock
  bool triggered{false};          ///< by an edge on Line0
  bool strobe{true};              ///< Line1 follows the exposure
  std::uint64_t sequence{0};      ///< since open()
  double gain_db{0};
};

/// Real GVCP and GVSP packets on `address`, port 3956 (fixed by the standard); a GenICam description of our
/// own with SFNC names.  It lacks what Aravis' fake camera lacks: packet resend, chunk data.  A missed
/// heartbeat ends the stream with the next packet that comes from anybody. Stamps are the start of the
/// exposure on the camera's clock.
///
/// Thread: the painter is called on the camera's own thread, one exposure at a time; trigger() from any
/// thread.
class GvCamera {
 public:
  struct Config {
    std::string address{"127.0.0.1"};  ///< of a network interface of this machine
    std::string serial{"BITELINE-SIM"};
    int sensor_width_px{1626};
    int sensor_height_px{1236};
    geometry::Region region;  ///< at power-up
    Nanoseconds exposure{400'000};
    double rate_hz{20};
    Nanoseconds clock_offset{0};  ///< camera clock minus this machine's monotonic clock
    bool ptp{true};  ///< says that its clock follows PTP (clock_offset is then that of the PTP time)
    double lost_packet_ratio{0};  ///< of the packets of the stream, thrown away before sending
    bool resends{false};  ///< says that it can send packets again: a LossyLine stands before it, which does
  };
  /// Registers of genicam_description.hpp as another program left them, before anybody opens the camera, or
  /// while one has it; a real camera would not let two.
  void leave(std::uint32_t address, std::uint32_t value);
  /// From now on clients write ReverseX to BlackLevel without effect, as with a camera whose set-up is
  /// locked.
  void lock_state();

  /// Fills region.width * region.height pixels.
  using Painter = std::function<void(const GvExposure&, std::span<std::uint8_t>)>;

  /// Errc::ConnectFailed: no such interface, or another camera has its port.
  [[nodiscard]] static Result<std::unique_ptr<GvCamera>> open(const Config& config, Painter painter);
  ~GvCamera();
  GvCamera(const GvCamera&) = delete;
  GvCamera& operator=(const GvCamera&) = delete;

  /// An edge on Line0.  As on a real camera, one that comes while TriggerMode is off or within the exposure
  /// before it is lost.  The edges' own times decide that: a machine that is late with its pictures makes
  /// them later, and loses none.
  void trigger(SensorClock::time_point edge);

  [[nodiscard]] bool acquiring() const;
  [[nodiscard]] std::uint64_t exposures() const { return exposures_.load(); }
  [[nodiscard]] std::uint64_t triggers_missed() const { return triggers_missed_.load(); }

 private:
  struct Device;
  struct Edge {
    SensorClock::time_point begin;
    Nanoseconds exposure{0};  ///< as set when the edge came
  };
  explicit GvCamera(const Config& config, Painter painter);
  void paint(void* buffer);
  /// By the painter, of the whole sensor's own pixels: then binned, reversed and raised as the registers say.
  void paint_as_set(GvExposure& exposure, std::span<std::uint8_t> pixels);

  Config config_;
  Painter painter_;
  std::unique_ptr<Device> device_;
  std::mutex edges_mutex_;
  std::deque<Edge> edges_;
  SensorClock::time_point exposed_until_{};  ///< of the last edge that was taken up
  std::uint32_t stream_port_{0};
  std::uint64_t frames_of_sequence_{
      0};                               ///< since power-up, or since the sequencer began; camera's own thread
  std::vector<std::uint8_t> unbinned_;  ///< camera's own thread
  std::atomic<std::uint64_t> exposures_{0};
  std::atomic<std::uint64_t> triggers_missed_{0};
};

}  // namespace biteline::sim
