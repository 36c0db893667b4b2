// SPDX-License-Identifier: MIT
#pragma once
/// \file LineCamera by Aravis: GigE Vision and USB3 Vision cameras, by their SFNC feature names.

#include <memory>
#include <string>

#include "hal/api/line_camera.hpp"

namespace biteline::hal {

/// A camera on the network is opened by its address.  Set up by SFNC names (Width, OffsetY, ExposureTime,
/// AcquisitionFrameRate, TriggerMode, ...); what the camera lacks is said by configure(), not guessed.
///
/// Frames are handed on without a copy.  Missing packets: asked for again where the camera can resend; a
/// frame that stays incomplete is given out as damaged.  Losses are counted by layer: packets resent and
/// missing (the stream), frames missing (gaps in the camera's own count), frames without a free buffer.
///
/// Stamps are the middle of the exposure: the camera's stamp of its begin plus half the exposure time.  With
/// a camera that follows PTP, `ptp_clock` maps it, measured anew several times a second; without, the stamp
/// is mapped by arrival (ArrivalClock, then a line through the least delays) and flagged
/// k_frame_stamp_uncertain.
///
/// Bracketing and laser-off frames are SFNC's sequencer with two sets; which set a frame is of follows from
/// its number since the acquisition began.  The sets stand while frames come: adjust_exposure() is refused
/// then. Otherwise it knows the exposure of each frame from the stamps, and flags the frame whose exposure
/// began in mid change.
///
/// A camera that is gone stays gone for this object (see LineCamera); opening it again makes a new one.
/// Thread: as LineCamera; Aravis has a receiving thread of its own.  Memory: all buffers made by start().
class AravisCamera final : public LineCamera {
 public:
  struct Config {
    std::string address{"127.0.0.1"};  ///< network address, or Aravis' name of a USB camera
    int packet_bytes{
        0};  ///< 0: leave what the camera has; jumbo frames need it set (9000 for an MTU of 9000)
    bool packet_socket{false};  ///< receive below the IP stack; needs rights, and gives nothing on loopback
    int buffers{24};            ///< frames that may wait
    int receive_priority{0};    ///< SCHED_FIFO of Aravis' receiving thread; 0: as any other
    std::string trigger_line{"Line0"};  ///< of Trigger::Hardware
    std::string strobe_line{
        "Line1"};  ///< output that follows the exposure: the laser's modulation hangs on it
    /// The PTP time as it can be read here (hal/linux/ptp); none: it is this machine's own monotonic clock.
    std::shared_ptr<const ReferenceClock> ptp_clock{};
  };

  [[nodiscard]] static Result<std::unique_ptr<AravisCamera>> open(const Config& config);
  ~AravisCamera() override;

  [[nodiscard]] Result<CameraLimits> limits() override;
  [[nodiscard]] Result<double> rate_max_hz() override;
  [[nodiscard]] Result<geometry::CameraState> set_state(const geometry::CameraState& wanted) override;
  [[nodiscard]] Result<geometry::CameraState> state() override;
  [[nodiscard]] Result<CameraSettings> configure(const CameraSettings& wanted) override;
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<FrameView> next_frame(Nanoseconds timeout) override;
  void release(const FrameView& frame) noexcept override;
  [[nodiscard]] Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override;
  [[nodiscard]] Result<RowRange> adjust_rows(const RowRange& rows) override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] CameraHealth health() const noexcept override;

  /// The camera says that its clock follows PTP.
  [[nodiscard]] bool clock_follows_ptp() const noexcept;

 private:
  struct Device;
  [[nodiscard]] Result<void> begin_stream();
  explicit AravisCamera(std::unique_ptr<Device> device);
  std::unique_ptr<Device> device_;
};

}  // namespace biteline::hal
