// SPDX-License-Identifier: MIT
#pragma once
/// \file The kernel's test video driver, its output looped to its input, with hands on its fault controls.
///
/// Documentation/admin-guide/media/vivid.rst.  Loaded with: n_devs=1 node_types=0x101 num_inputs=2
/// input_types=0x3 num_outputs=1 output_types=0x1 (one HDMI capture looped from one HDMI output).

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "hal/linux/posix/descriptor.hpp"

namespace biteline::test {

/// Where vivid's nodes are; nothing when it is not loaded.
struct VividNodes {
  std::string capture;
  std::string output;
};
[[nodiscard]] std::optional<VividNodes> find_vivid();

/// Sets a driver's control by the name the kernel shows; false: no such control.
bool set_control(const std::string& node, const std::string& name, int value);

/// One of the standard video timings on both nodes, and the loop on.
void loop_vivid(const VividNodes& nodes, int width_px, int height_px);

/// Feeds the output node: picture after picture, as fast as the driver takes them, until the object goes.
class PictureFeeder {
 public:
  using Painter = std::function<void(std::uint32_t number, std::span<std::uint8_t> pixels)>;
  /// `on_frame` is told when the driver has shown a picture: its frame clock, in step with the capturing
  /// side's.
  PictureFeeder(
      const VividNodes& nodes, int width_px, int height_px, Painter painter,
      std::function<void()> on_frame = [] {});
  ~PictureFeeder();

 private:
  void run();
  void queue(std::uint32_t index);

  hal::Descriptor device_;
  Painter painter_;
  std::function<void()> on_frame_;
  std::vector<std::span<std::uint8_t>> buffers_;
  std::uint32_t next_number_{0};
  std::jthread thread_;
  std::atomic<bool> stop_{false};
};

}  // namespace biteline::test
