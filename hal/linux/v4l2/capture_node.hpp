// SPDX-License-Identifier: MIT
#pragma once
/// \file A V4L2 node that captures, by whichever of the kernel's two interfaces its driver has.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"

namespace biteline::hal {

struct PictureSize {
  int width_px{0}, height_px{0};
  [[nodiscard]] bool operator==(const PictureSize&) const = default;
};

/// As the driver has it, or shall have it.
struct CaptureFormat {
  std::uint32_t fourcc{0};
  PictureSize size;
  std::size_t stride_bytes{0};
  std::size_t picture_bytes{0};  ///< of the buffer; may be more than is filled
  int planes{1};
};

/// Borrows the descriptor.
class CaptureNode {
 public:
  CaptureNode() = default;
  /// Errc::NotSupported: it does not capture, or does not stream.
  [[nodiscard]] static Result<CaptureNode> look(int device, const std::string& name);

  [[nodiscard]] int device() const { return device_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// The multi-planar interface (i.MX 8M Plus, Rockchip): one plane of it is read.
  [[nodiscard]] bool in_planes() const { return in_planes_; }
  [[nodiscard]] std::uint32_t buffer_type() const;
  /// Formats and sizes follow the media pipeline (media-ctl), not this node.
  [[nodiscard]] bool follows_pipeline() const { return follows_pipeline_; }

  [[nodiscard]] std::vector<std::uint32_t> formats() const;
  [[nodiscard]] Result<CaptureFormat> format() const;
  /// What the driver made of it; `try_only`: would make of it.
  [[nodiscard]] Result<CaptureFormat> set_format(std::uint32_t fourcc, PictureSize size,
                                                 bool try_only = false) const;
  /// The largest of those that it lists; nothing where it tells a range (a bridge's own) or none.
  [[nodiscard]] std::optional<PictureSize> largest(std::uint32_t fourcc) const;

 private:
  int device_{-1};
  std::string name_;
  bool in_planes_{false};
  bool follows_pipeline_{false};
};

/// "BA81"; bytes that are no letters or digits are left out.
[[nodiscard]] std::string fourcc_text(std::uint32_t fourcc);

/// Errc of a call on a camera that failed, with its cause and the step out of it where the errno tells one:
/// the pipeline's formats, bandwidth, another program.
[[nodiscard]] tl::unexpected<Error> capture_failure(int sys_errno, const std::string& device,
                                                    const char* call);

}  // namespace biteline::hal
