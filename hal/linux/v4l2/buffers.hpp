// SPDX-License-Identifier: MIT
#pragma once
/// \file The memory that a V4L2 driver fills: its own, mapped here, or a DMA-BUF heap's, given to it.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/linux/posix/descriptor.hpp"
#include "hal/linux/v4l2/capture_node.hpp"

struct v4l2_buffer;

namespace biteline::hal {

enum class BufferMemory {
  Mapped,  ///< the driver's own (V4L2_MEMORY_MMAP)
  DmaBuf,  ///< from a heap, so that a GPU or NPU may read it without a copy (V4L2_MEMORY_DMABUF)
};

struct BufferRequest {
  BufferMemory memory{BufferMemory::Mapped};
  std::string heap;  ///< "/dev/dma_heap/system"; of DmaBuf only
  std::uint32_t count{6};
  std::size_t size_bytes{0};  ///< of one picture, from the format; of DmaBuf only
};

/// Asked for, mapped and known by index.  Unmapped and given back with the object.
class BufferSet {
 public:
  BufferSet() = default;
  BufferSet(BufferSet&&) noexcept = default;
  BufferSet& operator=(BufferSet&& other) noexcept;
  ~BufferSet() { release(); }

  /// The node's device must outlive the set.
  [[nodiscard]] static Result<BufferSet> create(const CaptureNode& node, const BufferRequest& request);

  [[nodiscard]] std::size_t count() const { return buffers_.size(); }
  [[nodiscard]] std::span<const std::uint8_t> bytes(std::size_t index) const { return buffers_[index].bytes; }
  /// Hands the buffer to the driver.
  [[nodiscard]] Result<void> queue(std::size_t index) const;
  /// A filled one, with the plain interface's fields whatever the driver's; `begin_bytes`: where the picture
  /// begins in it.  Errc::Timeout: none is filled.
  [[nodiscard]] Result<v4l2_buffer> dequeue(std::size_t& begin_bytes) const;
  /// Around reading by the processor: caches, on boards whose DMA is not coherent.
  void begin_reading(std::size_t index) const;
  void end_reading(std::size_t index) const;

 private:
  [[nodiscard]] std::uint32_t v4l2_memory() const;
  struct Buffer {
    std::span<std::uint8_t> bytes;
    Descriptor dma_buf;
  };
  Result<void> map_drivers_own(std::uint32_t index);
  Result<void> take_from_heap(const Descriptor& heap, const BufferRequest& request);
  void release() noexcept;

  CaptureNode node_;
  BufferMemory memory_{BufferMemory::Mapped};
  std::vector<Buffer> buffers_;
};

}  // namespace biteline::hal
