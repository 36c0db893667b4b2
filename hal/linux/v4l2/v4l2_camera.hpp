// SPDX-License-Identifier: MIT
#pragma once
/// \file LineCamera on Video4Linux2: MIPI sensors behind a plain bridge, USB cameras, and the kernel's test
/// driver.

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/api/line_camera.hpp"
#include "hal/linux/v4l2/buffers.hpp"
#include "hal/linux/v4l2/capture_node.hpp"
#include "hal/linux/v4l2/controls.hpp"
#include "hal/linux/v4l2/pixel_format.hpp"

struct v4l2_buffer;

namespace biteline::hal {

/// The full picture, in which regions are counted: the driver's default crop; else the size that a
/// calibration tells; else the one that the driver has, or, where the region does not fit into that (an
/// earlier program left it), the largest that it lists.
///
/// A region is set in the driver where it can crop and cut out here where it cannot.  GREY frames that need
/// no cutting are lent as the driver wrote them; all others are brought to 8 bits in buffers made at start().
///
/// Mid-exposure: with a start-of-exposure stamp, stamp + exposure / 2; with the usual end-of-frame stamp,
/// stamp - readout - exposure / 2 when the readout is known (Config), else flagged k_frame_stamp_uncertain.
class V4l2Camera final : public LineCamera {
 public:
  struct Config {
    std::string device{};          ///< "/dev/video0"
    std::string control_device{};  ///< the sensor's sub-device where its controls are; empty: the same
    BufferMemory memory{BufferMemory::Mapped};
    std::string heap{"/dev/dma_heap/system"};
    std::uint32_t buffers{6};
    std::optional<PixelFormat> format{};  ///< nothing: the first of k_pixel_formats that the driver has
    std::optional<std::int32_t> gain{};
    std::optional<Nanoseconds> readout{};  ///< end of exposure to the end of frame, from the data sheet
    bool hardware_trigger{false};          ///< the sensor is wired and set up (device tree) to wait for edges
  };

  [[nodiscard]] static Result<std::unique_ptr<V4l2Camera>> open(const Config& config);
  ~V4l2Camera() override;

  [[nodiscard]] Result<CameraLimits> limits() override;
  [[nodiscard]] Result<geometry::CameraState> set_state(const geometry::CameraState& wanted) override;
  [[nodiscard]] Result<geometry::CameraState> state() override;
  [[nodiscard]] Result<CameraSettings> configure(const CameraSettings& wanted) override;
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<FrameView> next_frame(Nanoseconds timeout) override;
  void release(const FrameView& frame) noexcept override;
  [[nodiscard]] Result<Nanoseconds> adjust_exposure(Nanoseconds exposure) override;
  [[nodiscard]] Result<void> stop() override;
  [[nodiscard]] CameraHealth health() const noexcept override;

  [[nodiscard]] PixelFormat format() const { return format_; }

 private:
  enum class State { Open, Configured, Running };
  struct Counters {
    std::atomic<std::uint64_t> frames{0}, frames_lost{0}, frames_damaged{0}, underruns{0};
    std::atomic<bool> connected{true};
  };

  V4l2Camera(Config config, Descriptor device, Descriptor control);

  /// Where controls are: the sensor's sub-device first, where there is one.
  [[nodiscard]] std::vector<int> control_devices() const;
  [[nodiscard]] int controls() const { return control_.is_open() ? control_.number() : device_.number(); }
  Result<void> choose_format();
  Result<void> read_full_size();
  void adopt_size(const geometry::CameraState& wanted);
  Result<void> set_format(PictureSize size);
  /// true: the driver crops.
  [[nodiscard]] bool crop_in_driver(const geometry::Region& region);
  // `target`: crop (what of the sensor) or compose (where in the picture).
  [[nodiscard]] bool has(std::uint32_t target) const;
  [[nodiscard]] bool rectangle_is(std::uint32_t target, const geometry::Region& region) const;
  void set_rectangle(std::uint32_t target, const geometry::Region& region);
  double set_rate(double rate_hz);
  Result<FrameView> to_frame(const v4l2_buffer& buffer, std::size_t begin_bytes);
  void place_in_time(const v4l2_buffer& buffer, FrameView& frame) const;
  tl::unexpected<Error> lost(const Error& error);

  Config config_;
  Descriptor device_;
  Descriptor control_;
  CaptureNode node_;
  State state_{State::Open};
  PixelFormat format_{PixelFormat::Grey8};
  PictureSize full_;                    ///< in which regions are counted
  std::optional<PictureSize> largest_;  ///< to be taken for a region that does not fit into full_
  PictureSize picture_;                 ///< as the driver delivers it
  std::size_t stride_bytes_{0};
  std::size_t picture_bytes_{0};  ///< of a buffer
  std::size_t filled_bytes_{0};   ///< of a whole picture: buffers may have more room
  PictureWindow window_;          ///< of the delivered picture
  bool copies_{false};
  CameraSettings settings_;
  std::optional<ExposureRegister> exposure_control_;
  BufferSet buffers_;
  std::vector<std::vector<std::uint8_t>> narrowed_;  ///< one for each buffer, when copies_
  std::size_t lent_{0};
  std::optional<std::uint32_t> last_sequence_;
  std::uint64_t sequence_{0};
  Counters counters_;
};

}  // namespace biteline::hal
